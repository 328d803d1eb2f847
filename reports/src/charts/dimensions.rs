//! The plane against space: each problem of discs beside one of spheres, with or without friction both.

use polars::df;
use serde_json::Value;

use crate::read::{Ending, Problems, RunRow, counted, median, number, problems, unique};
use crate::text::{Part, frame};

const NOTE: &str = "\nThe problems of the plane and those of space, without friction and with it, are compared in the order of the study. Work: counted, in sweeps. \
                    Entries: those of the triangular factors of all subdomains, per grain; of factors that are made anew the mean. \
                    Boundary: of the grains of all subdomains, copies counted each, the share that others hold too. Where several \
                    grids have as many subdomains, that with most axes counts. The sentences are of runs that converged.\n";

/// Begin of the names of columns, and the value of a run there.
type Compared = (&'static str, fn(&RunRow) -> Option<f64>);

/// Quantities of a run that are compared, by the begin of their columns.
const COMPARED: [Compared; 5] = [
    ("iterations", |run| Some(run.iterations as f64)),
    ("work", |run| run.end.work(run)),
    ("entries_per_grain", entries_per_grain),
    ("boundary_share", |run| of_spectrum(run, "boundary_share")),
    ("neighbours", |run| of_spectrum(run, "neighbours")),
];

fn of_spectrum(run: &RunRow, key: &str) -> Option<f64> {
    run.spectrum.get(key)?.as_f64()
}

/// Returns the entries per grain of the factors that the run solved with: LATIN-DD goes through those of all subdomains in each
/// iteration, the active set through a new one.
fn entries_per_grain(run: &RunRow) -> Option<f64> {
    let solves = match run.method.as_str() {
        "latin-dd" => run.iterations,
        "active-set" => run.end.work.factorisations,
        _ => 0,
    };
    let entries = run.end.work.triangular_solve_entries as f64 / 2.0;
    (solves > 0).then(|| entries / solves as f64 / f64::from(run.grains))
}

/// Two runs of a method on as many subdomains: one in the plane, one in space.
struct Pair<'r> {
    plane: &'r RunRow,
    space: &'r RunRow,
}

impl Pair<'_> {
    fn ratio(&self, of: fn(&RunRow) -> Option<f64>) -> Option<f64> {
        let (plane, space) = (of(self.plane)?, of(self.space)?);
        (self.have_converged() && plane > 0.0).then_some(space / plane)
    }

    fn have_converged(&self) -> bool {
        self.plane.has_converged() && self.space.has_converged()
    }
}

/// One of the two.
type Side = for<'p, 'r> fn(&'p Pair<'r>) -> &'r RunRow;

/// The table `dimensions`, and the sentences `dimensions-found`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let pairs = pairs(&study.runs);
    let found = found(&pairs);
    let found = (!found.is_empty()).then(|| Part::text("dimensions-found", found));
    found.into_iter().chain([table(&pairs)]).collect()
}

/// By problems, then as the study has the methods.
fn pairs(runs: &[RunRow]) -> Vec<Pair<'_>> {
    let of_problem = |problem: &str| runs.iter().filter(|run| run.problem == problem).collect::<Vec<_>>();
    let all: Vec<Vec<&RunRow>> = problems(runs).into_iter().map(of_problem).collect();
    let mut pairs = Vec::new();
    for rough in [false, true] {
        let are = |dimensions: f64| {
            all.iter().filter(move |runs| {
                let is = |key: &str| runs.first().and_then(|run| of_spectrum(run, key));
                is("dimensions") == Some(dimensions) && is("unknowns").is_some_and(|n| (n > 1.0) == rough)
            })
        };
        for (plane, space) in are(2.0).zip(are(3.0)) {
            for run in chosen(plane) {
                let same =
                    |other: &&&RunRow| other.method == run.method && other.subdomains == run.subdomains;
                if let Some(other) = chosen(space).iter().find(same) {
                    pairs.push(Pair { plane: run, space: other });
                }
            }
        }
    }
    pairs
}

/// Returns one run on a problem for each method and number of subdomains: that with most axes of those not skipped.
fn chosen<'r>(runs: &[&'r RunRow]) -> Vec<&'r RunRow> {
    let mut chosen: Vec<&RunRow> = Vec::new();
    let axes = |run: &RunRow| {
        let grid = run.settings.get("subdomains").and_then(Value::as_str).unwrap_or_default();
        grid.split('x').filter(|count| *count != "1").count()
    };
    for run in runs.iter().filter(|run| run.ending != Ending::Skipped) {
        let same = |other: &&mut &RunRow| other.method == run.method && other.subdomains == run.subdomains;
        match chosen.iter_mut().find(same) {
            Some(known) if axes(run) > axes(known) => *known = run,
            Some(_) => {}
            None => chosen.push(run),
        }
    }
    chosen
}

fn table(pairs: &[Pair]) -> Part {
    let text = |of: fn(&Pair) -> String| pairs.iter().map(of).collect::<Vec<_>>();
    let mut columns = frame(df!(
        "plane" => text(|pair| pair.plane.problem.clone()),
        "space" => text(|pair| pair.space.problem.clone()),
        "method" => text(|pair| pair.plane.method.clone()),
        "subdomains" => pairs.iter().map(|pair| pair.plane.subdomains).collect::<Vec<_>>(),
        "status" => text(|pair| {
            let [plane, space] = [pair.plane, pair.space].map(|run| run.ending.text());
            if plane == space { plane.to_owned() } else { format!("{plane}, {space}") }
        }),
    ));
    for (name, of) in COMPARED {
        let both: [(&str, Side); 2] = [("plane", |pair| pair.plane), ("space", |pair| pair.space)];
        for (place, run) in both {
            let values: Vec<Option<f64>> = pairs.iter().map(|pair| of(run(pair))).collect();
            let column = polars::prelude::Column::new(format!("{name}_in_{place}").into(), values);
            columns = frame(columns.with_column(column).cloned());
        }
    }
    Part::table("dimensions", columns, NOTE)
}

/// For each method how many times more it takes in space, and what more subdomains cost it on either side; then factors and boundaries.
fn found(pairs: &[Pair]) -> String {
    let mut lines = Vec::new();
    let methods = unique(pairs.iter().map(|pair| pair.plane.method.as_str()));
    for (method, rough) in methods.iter().flat_map(|method| [(*method, false), (*method, true)]) {
        let is_rough = |pair: &&Pair| of_spectrum(pair.plane, "unknowns").is_some_and(|n| n > 1.0);
        let of_method = pairs.iter().filter(|pair| pair.plane.method == method);
        let of: Vec<&Pair> = of_method.filter(|pair| is_rough(pair) == rough).collect();
        let method = format!("{method} {} friction", if rough { "with" } else { "without" });
        let ratio = |what: fn(&RunRow) -> Option<f64>| {
            median(of.iter().filter_map(|pair| pair.ratio(what)).collect())
        };
        let [iterations, work, entries] = [COMPARED[0].1, COMPARED[1].1, COMPARED[2].1].map(ratio);
        let Some(iterations) = iterations else {
            if !of.is_empty() {
                lines.push(format!(
                    "{method}: none of {} converged on both sides.",
                    counted(of.len(), "pair")
                ));
            }
            continue;
        };
        let both = of.iter().filter(|pair| pair.have_converged()).count();
        let work = work.map(|work| format!(", {} times the work", number(work, 2)));
        let entries =
            entries.map(|entries| format!(", {} times the entries of factors per grain", number(entries, 2)));
        lines.push(format!(
            "{method}: in space {} times the iterations of the plane{}{} ({both} of {} converged on both sides; medians).",
            number(iterations, 2),
            work.unwrap_or_default(),
            entries.unwrap_or_default(),
            counted(of.len(), "pair")
        ));
        let most = of.iter().map(|pair| pair.plane.subdomains).max().unwrap_or(1);
        let growth = |side: Side| {
            let on = |subdomains: u32, problem: &str| {
                of.iter()
                    .map(|pair| side(pair))
                    .find(|run| run.subdomains == subdomains && run.problem == problem)
            };
            let all =
                of.iter().map(|pair| side(pair)).filter(|run| run.subdomains == most && run.has_converged());
            median(
                all.filter_map(|run| {
                    let one = on(1, &run.problem).filter(|one| one.has_converged())?;
                    Some(run.iterations as f64 / one.iterations as f64)
                })
                .collect(),
            )
        };
        if let (true, Some(plane), Some(space)) =
            (most > 1, growth(|pair| pair.plane), growth(|pair| pair.space))
        {
            lines.push(format!(
                "{method} on {most} subdomains beside one: {} times the iterations in the plane, {} in space.",
                number(plane, 3),
                number(space, 3)
            ));
        }
    }
    let most = pairs.iter().map(|pair| pair.plane.subdomains).max().unwrap_or(1);
    let share = |side: Side| {
        let of = pairs.iter().filter(|pair| pair.plane.subdomains == most).map(side);
        median(of.filter_map(|run| of_spectrum(run, "boundary_share")).collect())
    };
    if let (true, Some(plane), Some(space)) = (most > 1, share(|pair| pair.plane), share(|pair| pair.space)) {
        lines.push(format!(
            "On {most} subdomains {} % of their grains are on boundaries in the plane, {} % in space.",
            number(100.0 * plane, 2),
            number(100.0 * space, 2)
        ));
    }
    lines.push(String::new());
    lines.join("\n")
}

#[cfg(test)]
mod tests;
