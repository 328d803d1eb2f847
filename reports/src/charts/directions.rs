//! Search directions: iterations over (κ_l, κ_d), and the derived directions among them.

mod against_size;
mod field;
mod heat;
mod table;
#[cfg(test)]
mod tests;
mod words;

use crate::read::{Problems, RunRow, counted, file_name, median, number, problems, span};
use crate::text::Part;
use field::{Field, fields};

/// `directions-<problem>` where runs span κ_l and κ_d, `derived-direction` where they span κ_l with κ_d = κ_l, each with
/// its table.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = &study.runs;
    let fields = fields(runs);
    let found = [found(&fields, "derived", |f| f.derived), found(&fields, "adapted", |f| f.adaptive)];
    let found = found.into_iter().flatten().collect::<Vec<_>>().join("\n");
    let (planes, lines): (Vec<Field>, Vec<Field>) = fields.into_iter().partition(Field::is_plane);
    let mut parts = Vec::new();
    for problem in problems(runs) {
        let fields: Vec<&Field> = planes.iter().filter(|field| field.problem == problem).collect();
        for (page, svg) in heat::pages(problem, &fields).into_iter().enumerate() {
            let number = if page == 0 { String::new() } else { format!("-{}", page + 1) };
            parts.push(Part::figure(format!("directions-{}{number}", file_name(problem)), svg));
        }
    }
    if !planes.is_empty() || lines.is_empty() {
        parts.push(Part::table("directions", table::table(&planes), table::NOTE));
    }
    if !lines.is_empty() {
        let figure = Part::figure("derived-direction", against_size::figure(&lines));
        parts.push(figure.captioned(
            "The best and the derived κ_l, and what the derived one costs, against the number of grains.",
        ));
        parts.push(Part::table("derived-direction", table::table(&lines), table::NOTE));
    }
    parts.extend((!found.is_empty()).then(|| Part::text("directions-found", found)));
    parts
}

/// States the iterations of some runs over those of the best of their grids, and how many do not converge where one of the grid does.
fn found<'r>(
    fields: &[Field<'r>],
    which: &str,
    run: impl Fn(&Field<'r>) -> Option<&'r RunRow>,
) -> Option<String> {
    let asked = || fields.iter().filter(|field| run(field).is_some() && field.best().is_some());
    let ratios: Vec<f64> = asked().filter_map(|field| field.ratio(run(field))).collect();
    let failed = asked().count() - ratios.len();
    let range = span(ratios.iter().copied()).zip(median(ratios.clone()));
    let takes = range.map(|((least, most), median)| {
        let [least, most, median] = [least, most, median].map(|ratio| number(ratio, 2));
        let (of, on) = (if least == most { least } else { format!("{least} to {most}") }, ratios.len());
        let middle = if on > 2 { format!(", {median} in the median") } else { String::new() };
        format!("take {of} times the iterations of the best of their grid{middle} ({})", counted(on, "grid"))
    });
    let fails = (failed > 0).then(|| format!("do not converge on {}", counted(failed, "grid")));
    let said: Vec<String> = takes.into_iter().chain(fails).collect();
    (!said.is_empty()).then(|| format!("The {which} directions {}.", said.join(", and ")))
}
