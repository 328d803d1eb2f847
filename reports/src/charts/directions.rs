//! Search directions: iterations over (κ_l, κ_d), and the derived directions among them.

mod field;
mod heat;
#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    BLACK, Curve, DASHES, DERIVED, Look, Mark, Panel, Pen, Plot, Scale, Side, Sign, Through, medians,
};
use crate::read::{Ending, Problems, counted, ending_text, file_name, number, problems};
use crate::text::{Part, frame};
use field::{Field, fields, iterations, kappa};

/// Meaning of the columns of the table.
const NOTE: &str = "\nIterations are those to the stop rule of the plan. Best: the fewest among the converged runs with given \
                    directions; `at_edge` says which of them is the least or greatest of the grid, which may then hold \
                    no best at all. Derived: the run of the same method that derives its own; none where it did not \
                    converge. Adaptive: the run that begins with them and adapts them; its κ_l is the last.\n";

/// `directions-<problem>` where runs span κ_l and κ_d, `derived-direction` where they span κ_l with κ_d = κ_l, each with
/// its table.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let (planes, lines): (Vec<Field>, Vec<Field>) =
        fields(&study.runs).into_iter().partition(Field::is_plane);
    let mut parts = Vec::new();
    for problem in problems(&study.runs) {
        let fields: Vec<&Field> = planes.iter().filter(|field| field.problem == problem).collect();
        for (page, svg) in heat::pages(problem, &fields).into_iter().enumerate() {
            let number = if page == 0 { String::new() } else { format!("-{}", page + 1) };
            parts.push(Part::figure(format!("directions-{}{number}", file_name(problem)), svg));
        }
    }
    if !planes.is_empty() || lines.is_empty() {
        parts.push(Part::table("directions", table(&planes), NOTE));
    }
    if !lines.is_empty() {
        let figure = Part::figure("derived-direction", against_size(&lines));
        parts.push(figure.captioned(
            "The best and the derived κ_l, and what the derived one costs, against the number of grains.",
        ));
        parts.push(Part::table("derived-direction", table(&lines), NOTE));
    }
    parts
}

/// Left: best and derived κ_l, one point per problem and group. Right: iterations of the derived and adapted over the best.
fn against_size(fields: &[Field]) -> String {
    let look = |mark, pen: Pen, n: usize| Look { pen: Pen { dash: DASHES[n], ..pen }, mark };
    let thin = Pen::solid(BLACK, 0.25);
    let curve = |label: &str, look, of: &dyn Fn(&Field) -> Option<f64>| {
        let point = |field: &Field| Some((f64::from(field.grains.max(1)).log10(), of(field)?.log10()));
        Curve::of(label, look, fields.iter().filter_map(point), Through::Medians)
    };
    let (best, derived) = (look(Mark::Ring, thin, 0), look(Mark::Diamond, DERIVED, 1));
    let costs = vec![
        curve("derived", derived, &|field| field.ratio(field.derived)),
        curve("derived, then adapted", look(Mark::Cross, thin, 4), &|field| field.ratio(field.adaptive)),
    ];
    let directions = vec![
        curve("best of the grid, one per problem", best, &|field| field.best().map(|cell| cell.kappa_l)),
        curve("derived", derived, &|field| field.kappa.map(|(l, _)| l)),
    ];
    let mut signs = vec![(Sign::Word, "Lines join medians.".to_owned())];
    for (what, curve) in ["derived", "adapted"].into_iter().zip(&costs) {
        let points: Vec<(f64, f64)> = curve.points.iter().map(|(_, point)| *point).collect();
        let text =
            |(x, y): (f64, f64)| format!("{} at {:.0} grains", number(10f64.powf(y), 3), 10f64.powf(x));
        let texts: Vec<String> = medians(&points).into_iter().map(text).collect();
        signs.extend(
            (!texts.is_empty()).then(|| (Sign::Word, format!("Median ratio, {what}: {}.", texts.join(", ")))),
        );
    }
    let panel = |name: &str, curves, holds: &[f64]| {
        let y = Side::new(Scale::Ten, name).holding(holds.iter().copied());
        Panel::new(Side::new(Scale::Ten, "grains"), y, curves)
    };
    let panels = vec![
        panel("κ_l, at contacts (–)", directions, &[]),
        panel("iterations over those of the best (–)", costs, &[0.0]),
    ];
    let runs = fields.iter().map(|field| field.cells.len()).sum();
    let rule = fields[0].cells.first().and_then(|cell| cell.run.rule());
    let stop = rule.map_or(String::new(), |rule| format!(", iterations to {rule}"));
    let (problems, runs) = (counted(fields.len(), "problem"), counted(runs, "run"));
    let title = vec![format!("{}: {problems}, {runs}{stop}", fields[0].method)];
    Plot { title, panels, signs, ..Plot::default() }.svg()
}

/// One row per problem, μ and group: the best of a field beside the derived ones.
fn table(fields: &[Field]) -> DataFrame {
    let number = |of: &dyn Fn(&Field) -> Option<f64>| fields.iter().map(of).collect::<Vec<Option<f64>>>();
    let iterations = |of: &dyn Fn(&Field) -> Option<u64>| fields.iter().map(of).collect::<Vec<Option<u64>>>();
    let named = [Ending::Diverged, Ending::IterationLimit, Ending::Skipped];
    let count = |ending| fields.iter().map(|f| f.count(ending) as u64).collect::<Vec<_>>();
    let others = |f: &Field| {
        let counted: usize = named.into_iter().chain([Ending::Converged]).map(|ending| f.count(ending)).sum();
        (f.cells.len() - counted) as u64
    };
    frame(df!(
        "problem" => fields.iter().map(|f| f.problem).collect::<Vec<_>>(),
        "grains" => fields.iter().map(|f| f.grains).collect::<Vec<_>>(),
        "method" => fields.iter().map(|f| f.method).collect::<Vec<_>>(),
        "relaxation" => fields.iter().map(|f| f.relaxation).collect::<Vec<_>>(),
        "group" => fields.iter().map(|f| f.group.as_str()).collect::<Vec<_>>(),
        "subdomains" => fields.iter().map(|f| f.subdomains).collect::<Vec<_>>(),
        "best_kappa_l" => number(&|f| Some(f.best()?.kappa_l)),
        "best_kappa_d" => number(&|f| Some(f.best()?.kappa_d)),
        "at_edge" => fields.iter().map(Field::edge).collect::<Vec<_>>(),
        "best_iterations" => iterations(&|f| Some(f.best()?.run.iterations)),
        "derived_kappa_l" => number(&|f| Some(f.kappa?.0)),
        "derived_kappa_d" => number(&|f| Some(f.kappa?.1)),
        "derived_status" => fields.iter().map(|f| f.derived.map(|run| ending_text(run.status))).collect::<Vec<_>>(),
        "derived_iterations" => iterations(&|f| self::iterations(f.derived)),
        "derived_over_best" => number(&|f| f.ratio(f.derived)),
        "adaptive_kappa_l" => number(&|f| kappa(f.adaptive?, "kappa_l_minus")),
        "adaptive_iterations" => iterations(&|f| self::iterations(f.adaptive)),
        "adaptive_over_best" => number(&|f| f.ratio(f.adaptive)),
        "runs" => fields.iter().map(|f| f.cells.len() as u64).collect::<Vec<_>>(),
        "diverged" => count(Ending::Diverged),
        "iteration_limit" => count(Ending::IterationLimit),
        "skipped" => count(Ending::Skipped),
        "other_failures" => fields.iter().map(others).collect::<Vec<_>>(),
    ))
}
