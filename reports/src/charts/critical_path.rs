//! How much faster subdomains make a method: counted on the longest of them, as if each had a machine of its own, and
//! measured on the threads that there were.

use super::scaling::{counted_speed_up, measured_speed_up, table_of, with_path};
use crate::charts::subdomains::{Panel, on_problem};
use crate::draw::{Series, series};
use crate::read::{Problems, RunRow, file_name, problems, threads};
use crate::text::Part;

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
    let names = "problem method contacts subdomains status iterations path_per_iteration counted_speed_up \
                 measured_speed_up ns_per_contact";
    parts.push(Part::table("critical-path", table_of(runs, names), NOTE));
    parts
}
