//! Values of runs over subdomains: values of a run beside the one with the fewest, and a table of them with a row per run.

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::Series;
use crate::read::{Ending, Problems, RunRow};
use crate::text::chosen;

/// Multiply-adds of the longest subdomain in all iterations.
pub(crate) fn path(run: &RunRow) -> Option<f64> {
    Some(run.iterations as f64 * path_per_iteration(run)?)
}

pub(crate) fn path_per_iteration(run: &RunRow) -> Option<f64> {
    run.derived.get("critical_path")?.as_f64()
}

/// The runs that were not skipped and count their longest subdomain.
pub(crate) fn with_path(study: &Problems) -> Vec<&RunRow> {
    study.runs.iter().filter(|run| run.ending != Ending::Skipped && path(run).is_some()).collect()
}

pub(crate) fn grains_per_subdomain(run: &RunRow) -> f64 {
    f64::from(run.grains) / f64::from(run.subdomains)
}

/// The run with the fewest subdomains among those of a series that are the `same` as this one.
pub(crate) fn fewest<'r>(series: &Series<'r>, run: &RunRow, same: Same) -> Option<&'r RunRow> {
    series.runs.iter().copied().filter(|other| same(run, other)).min_by_key(|other| other.subdomains)
}

/// Returns that run if both converged.
fn fewest_converged<'r>(series: &Series<'r>, run: &RunRow, same: Same) -> Option<&'r RunRow> {
    fewest(series, run, same).filter(|fewest| fewest.has_converged() && run.has_converged())
}

/// A relation of two runs of a series that differ in their subdomains alone.
pub(crate) type Same = fn(&RunRow, &RunRow) -> bool;

pub(crate) fn same_problem(run: &RunRow, other: &RunRow) -> bool {
    run.problem == other.problem
}

/// Returns how many times longer the critical path of the run with the fewest subdomains is.
pub(crate) fn counted_speed_up(series: &Series, run: &RunRow) -> Option<f64> {
    Some(path(fewest_converged(series, run, same_problem)?)? / path(run)?)
}

/// Returns how many times more seconds it takes.
pub(crate) fn measured_speed_up(series: &Series, run: &RunRow) -> Option<f64> {
    Some(fewest_converged(series, run, same_problem)?.iterating_s? / run.iterating_s?)
}

/// One row per run, with the columns `names`; growth is over the iterations of the run with the fewest subdomains.
pub(crate) fn table(all: &[Series], names: &str, same: Same) -> DataFrame {
    let rows: Vec<(&Series, &RunRow)> =
        all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run))).collect();
    let of = |value: &dyn Fn(&Series, &RunRow) -> Option<f64>| {
        rows.iter().map(|(series, run)| value(series, run)).collect::<Vec<_>>()
    };
    let growth = |series: &Series, run: &RunRow| {
        let fewest = fewest_converged(series, run, same)?.iterations;
        (fewest > 0).then(|| run.iterations as f64 / fewest as f64)
    };
    let ns_per_contact = |_: &Series, run: &RunRow| {
        let visits = f64::from(run.contacts) * run.iterations as f64;
        Some(1e9 * run.iterating_s? / visits).filter(|ns| ns.is_finite())
    };
    let own = df!(
        "method" => rows.iter().map(|(series, _)| series.label()).collect::<Vec<_>>(),
        "status" => rows.iter().map(|(_, run)| run.ending.text()).collect::<Vec<_>>(),
        "grains_per_subdomain" => of(&|_, run| Some(grains_per_subdomain(run))),
        "to_natural_map_1e_2" => rows.iter().map(|(_, run)| run.iterations_to_natural_map_1e_2).collect::<Vec<_>>(),
        "growth" => of(&growth),
        "path_per_iteration" => of(&|_, run| path_per_iteration(run)),
        "longest_subdomain" => of(&|_, run| path(run)),
        "counted_speed_up" => of(&counted_speed_up),
        "measured_speed_up" => of(&measured_speed_up),
        "ns_per_contact" => of(&ns_per_contact),
        "seconds_per_iteration" => of(&|_, run| run.seconds_per_iteration()),
        "seconds" => of(&|_, run| run.seconds()),
    );
    chosen(rows.iter().map(|(_, run)| *run), names, own)
}
