//! How much faster subdomains make a method: counted on the longest of them, as if each had a machine of its own, and
//! measured on the threads that there were.

use polars::df;
use polars::prelude::DataFrame;

use crate::charts::subdomains::{Panel, on_problem};
use crate::draw::{Series, series};
use crate::read::{Ending, Problems, RunRow, file_name, problems, threads};
use crate::text::{Part, frame};

/// Both on the same axes.
fn panels(threads: &str) -> [Panel; 2] {
    let measured = format!("measured speed-up of the iterations, {threads} (–)");
    [
        Panel::new("counted speed-up, a machine per subdomain (–)", counted_speed_up),
        Panel::new(measured, measured_speed_up),
    ]
    .map(|panel| Panel { ideal: true, ..panel })
}

const NOTE: &str = "\nThe critical path of an iteration is the multiply-adds of the longest subdomain, exchange with its \
                    neighbours included; messages between machines cost nothing in it. A speed-up is over the run of the same \
                    method and settings on the same problem with the fewest subdomains, both to the same tolerance. It passes \
                    the ideal where the factors of smaller subdomains have fewer entries per contact, or iterations are fewer.\n";

/// Multiply-adds of the longest subdomain in all iterations.
pub(crate) fn path(run: &RunRow) -> Option<f64> {
    Some(run.iterations as f64 * run.derived.get("critical_path")?.as_f64()?)
}

/// The runs that were not skipped and count their longest subdomain.
pub(crate) fn with_path(study: &Problems) -> Vec<&RunRow> {
    study.runs.iter().filter(|run| run.ending != Ending::Skipped && path(run).is_some()).collect()
}

/// `critical-path-<problem>` for each problem, and the table `critical-path`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = with_path(study);
    let panels = panels(&threads(&study.runs));
    let mut parts = Vec::new();
    for problem in problems(runs.iter().copied()) {
        let mut notes =
            vec!["Counted: multiply-adds of the longest subdomain, no communication cost.".to_owned()];
        let beyond = |series: &Series, run: &RunRow| {
            counted_speed_up(series, run).is_some_and(|times| times > f64::from(run.subdomains))
        };
        let all = series(runs.iter().copied(), &["subdomains"]);
        if all.iter().any(|s| s.runs.iter().any(|run| run.problem == problem && beyond(s, run))) {
            notes.push(
                "Above the ideal: fewer iterations, or factors with fewer entries per contact.".to_owned(),
            );
        }
        let name = format!("critical-path-{}", file_name(problem));
        parts.push(on_problem(name, &runs, problem, &panels, notes));
    }
    parts.push(Part::table("critical-path", table(&series(runs.iter().copied(), &["subdomains"])), NOTE));
    parts
}

fn counted_speed_up(series: &Series, run: &RunRow) -> Option<f64> {
    speed_up(series, run, path)
}

fn measured_speed_up(series: &Series, run: &RunRow) -> Option<f64> {
    speed_up(series, run, |run| run.iterating_s)
}

/// How many times more the run with the fewest subdomains costs; of runs that converged.
fn speed_up(series: &Series, run: &RunRow, cost: fn(&RunRow) -> Option<f64>) -> Option<f64> {
    let converged = |run: &&&RunRow| run.ending == Ending::Converged;
    let same = series.runs.iter().filter(|other| other.problem == run.problem);
    let fewest = same.min_by_key(|other| other.subdomains).filter(converged)?;
    Some(cost(fewest)? / cost(run)?).filter(|_| converged(&&run))
}

/// One row per run.
fn table(all: &[Series]) -> DataFrame {
    let rows: Vec<(&Series, &RunRow)> =
        all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run))).collect();
    let of = |value: &dyn Fn(&Series, &RunRow) -> Option<f64>| {
        rows.iter().map(|(series, run)| value(series, run)).collect::<Vec<_>>()
    };
    let visits = |run: &RunRow| f64::from(run.contacts) * run.iterations as f64;
    frame(df!(
        "problem" => rows.iter().map(|(_, run)| run.problem.as_str()).collect::<Vec<_>>(),
        "method" => rows.iter().map(|(series, _)| series.label()).collect::<Vec<_>>(),
        "contacts" => rows.iter().map(|(_, run)| run.contacts).collect::<Vec<_>>(),
        "subdomains" => rows.iter().map(|(_, run)| run.subdomains).collect::<Vec<_>>(),
        "status" => rows.iter().map(|(_, run)| run.ending.text()).collect::<Vec<_>>(),
        "iterations" => rows.iter().map(|(_, run)| run.iterations).collect::<Vec<_>>(),
        "path_per_iteration" => of(&|_, run| run.derived.get("critical_path")?.as_f64()),
        "counted_speed_up" => of(&counted_speed_up),
        "measured_speed_up" => of(&measured_speed_up),
        "ns_per_contact" => of(&|_, run| Some(1e9 * run.iterating_s? / visits(run)).filter(|ns| ns.is_finite())),
    ))
}
