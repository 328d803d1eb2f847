//! The answer to what a study asks, in sentences whose words no row can make false.

use std::collections::BTreeMap;

use results::name::Name;

use crate::read::{Ending, RunRow, Study, Verdicts, count, counted, ending_text, problems, unique};

/// Counts the runs of a study by their endings, and names the methods that are right in all of theirs.
pub(crate) fn answer(study: &Study) -> Vec<String> {
    match study {
        Study::Problems(study) => of_runs(&study.runs),
        Study::Simulations(all) => {
            let endings = endings(all.iter().map(|one| (one.status.name(), one.status.name().to_owned())));
            vec![format!("{}{endings}.", counted(all.len(), "simulation"))]
        }
    }
}

fn of_runs(runs: &[RunRow]) -> Vec<String> {
    let verdicts = Verdicts::of(runs);
    let methods = unique(runs.iter().map(|run| run.method.as_str()));
    let [all, of, on] = [(runs.len(), "run"), (methods.len(), "method"), (problems(runs).len(), "problem")]
        .map(|(number, noun)| counted(number, noun));
    let endings = endings(runs.iter().map(|run| (run.status, how(run, &verdicts))));
    let mut answer = vec![format!("{all} of {of} on {on}{endings}.")];
    answer.extend((methods.len() > 1).then(|| right(&methods, runs, &verdicts)));
    answer
}

/// Describes the ending of a run; a claim that there is no solution is a proof unless a run or the reference refutes it.
fn how(run: &RunRow, verdicts: &Verdicts) -> String {
    match run.status {
        Ending::Infeasible if verdicts.is_proof(run) => "proved that there is no solution".to_owned(),
        Ending::Infeasible => "claimed wrongly that there is no solution".to_owned(),
        ending => ending_text(ending),
    }
}

/// Counts endings in words, each by its place among the others.
fn endings<K: Ord>(all: impl Iterator<Item = (K, String)>) -> String {
    let mut counts: BTreeMap<(K, String), usize> = BTreeMap::new();
    for ending in all {
        *counts.entry(ending).or_default() += 1;
    }
    let counts: Vec<String> = counts.iter().map(|((_, how), n)| format!("{} {how}", count(*n))).collect();
    if counts.is_empty() { String::new() } else { format!(": {}", counts.join(", ")) }
}

/// Names the methods of which every run converged or proved that there is no solution.
fn right(methods: &[&str], runs: &[RunRow], verdicts: &Verdicts) -> String {
    let named = |method: &&str| {
        let (skipped, made): (Vec<&RunRow>, Vec<&RunRow>) =
            runs.iter().filter(|run| run.method == *method).partition(|run| run.status == Ending::Skipped);
        let skips = if skipped.is_empty() { String::new() } else { format!("; {} skipped", skipped.len()) };
        let is_right = !made.is_empty() && made.iter().all(|run| verdicts.is_right(run));
        is_right.then(|| format!("{method} ({}{skips})", made.len()))
    };
    match methods.iter().filter_map(named).collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => {
            "No method converged, or proved that there is no solution, in all of its runs.".to_owned()
        }
        right => format!("Converged, or proved that there is no solution, in all of their runs: {right}."),
    }
}

#[cfg(test)]
mod tests;
