//! The answer to what a study asks, and what failed, in sentences whose words no row can make false.

use std::collections::BTreeMap;

use results::name::Name;

use crate::draw::series;
use crate::read::{
    Ending, RunRow, Simulation, Study, Verdicts, count, counted, ending_text, find_or_push, number, problems,
    span, unique,
};

/// Returns the answer, which is also of what subdomains cost if that is asked for, and then what was found beside it.
pub(crate) fn found(study: &Study, of_subdomains: bool) -> [Vec<String>; 2] {
    match study {
        Study::Problems(study) if study.runs.is_empty() => {
            [Vec::new(), vec!["No run of this study is stored.".to_owned()]]
        }
        Study::Problems(study) => of_runs(&study.runs, of_subdomains),
        Study::Simulations(all) => [Vec::new(), of_simulations(all)],
    }
}

/// Endings of the runs of a method that were neither skipped nor right, with the numbers of skipped and of all runs.
struct Ended<'r> {
    method: &'r str,
    failed: BTreeMap<(Ending, String), usize>,
    skipped: usize,
    all: usize,
}

fn of_runs(runs: &[RunRow], of_subdomains: bool) -> [Vec<String>; 2] {
    let verdicts = Verdicts::of(runs);
    let mut methods: Vec<Ended> = Vec::new();
    let mut ended: BTreeMap<_, usize> = BTreeMap::new();
    for run in runs {
        let new = || Ended { method: &run.method, failed: BTreeMap::new(), skipped: 0, all: 0 };
        let of_method = find_or_push(&mut methods, |ended| ended.method == run.method, new);
        of_method.all += 1;
        let how = (run.status, how(run, &verdicts));
        *ended.entry(how.clone()).or_default() += 1;
        if run.status == Ending::Skipped {
            of_method.skipped += 1;
        } else if !verdicts.is_right(run) {
            *of_method.failed.entry(how).or_default() += 1;
        }
    }
    let mut found = vec![format!(
        "{} of {} on {}: {}.",
        counted(runs.len(), "run"),
        counted(methods.len(), "method"),
        counted(problems(runs).len(), "problem"),
        kinds(&ended)
    )];
    found.extend(methods.iter().filter_map(failures));
    let mut answer = Vec::new();
    if of_subdomains {
        answer.extend(methods.iter().filter_map(|ended| more_subdomains(runs, ended.method)));
    }
    answer.extend((methods.len() > 1).then(|| right(&methods)));
    [answer, found]
}

/// Describes the ending of a run; a claim that there is no solution is a proof unless a run or the reference refutes it.
fn how(run: &RunRow, verdicts: &Verdicts) -> String {
    match run.status {
        Ending::Infeasible if verdicts.is_proof(run) => "proved that there is no solution".to_owned(),
        Ending::Infeasible => "claimed wrongly that there is no solution".to_owned(),
        ending => ending_text(ending),
    }
}

fn kinds(ended: &BTreeMap<(Ending, String), usize>) -> String {
    ended.iter().map(|((_, how), n)| format!("{} {how}", count(*n))).collect::<Vec<_>>().join(", ")
}

/// Names the methods of which every run converged or proved that there is no solution.
fn right(methods: &[Ended]) -> String {
    let right = methods.iter().filter(|ended| ended.failed.is_empty() && ended.skipped < ended.all);
    let named = |ended: &Ended| match ended.skipped {
        0 => format!("{} ({})", ended.method, ended.all),
        skipped => format!("{} ({}; {skipped} skipped)", ended.method, ended.all - skipped),
    };
    match right.map(named).collect::<Vec<_>>().as_slice() {
        [] => "No method converged, or proved that there is no solution, in all of its runs.".to_owned(),
        right => {
            format!(
                "Converged, or proved that there is no solution, in all of their runs: {}.",
                right.join(", ")
            )
        }
    }
}

/// Counts the runs of a method that failed, and those that were skipped; `None` if there are none.
fn failures(Ended { method, failed, skipped, all }: &Ended) -> Option<String> {
    let (number, all) = (count(failed.values().sum()), counted(*all, "run"));
    let skipped = (*skipped > 0).then(|| count(*skipped));
    match (failed.is_empty(), skipped) {
        (true, None) => None,
        (true, Some(skipped)) => Some(format!("{method}: {skipped} of {all} skipped.")),
        (false, None) => Some(format!("{method}: {number} of {all} failed ({}).", kinds(failed))),
        (false, Some(skipped)) => {
            Some(format!("{method}: {number} of {all} failed ({}), {skipped} skipped.", kinds(failed)))
        }
    }
}

/// States how many times as many iterations a method takes with the most subdomains as with the fewest, all else being equal.
fn more_subdomains(runs: &[RunRow], method: &str) -> Option<String> {
    let of_method = || runs.iter().filter(|run| run.method == method);
    let (fewest, most) = span(of_method().map(|run| f64::from(run.subdomains)))?;
    let of_most = |run: &&RunRow| f64::from(run.subdomains) == most;
    let all = series(of_method(), &["subdomains"]);
    let grown = all.iter().flat_map(|series| {
        let of_most = series.runs.iter().copied().filter(of_most);
        of_most.filter_map(|run| Some((run, series.growth(run)?)))
    });
    let grown: Vec<(&RunRow, f64)> = grown.collect();
    let (least, greatest) = span(grown.iter().map(|(_, growth)| *growth)).filter(|_| fewest < most)?;
    let [least, greatest] = [least, greatest].map(|growth| number(growth, 3));
    let times = if least == greatest { least } else { format!("{least} to {greatest}") };
    let (on, rule) = (unique(grown.iter().map(|(run, _)| &run.problem)).len(), grown[0].0.rule()?);
    let failed = of_method().filter(|run| !run.has_converged() && run.status != Ending::Skipped).count();
    let failed = match failed {
        0 => String::new(),
        failed => format!("; {} did not converge", counted(failed, "run")),
    };
    Some(format!(
        "From {fewest} to {most} subdomains {method} needs {times} times the iterations to {rule} ({}{failed}).",
        counted(on, "problem")
    ))
}

/// Counts the simulations by their endings.
fn of_simulations(all: &[Simulation]) -> Vec<String> {
    let mut ended: BTreeMap<&str, usize> = BTreeMap::new();
    for simulation in all {
        *ended.entry(simulation.status.name()).or_default() += 1;
    }
    if ended.is_empty() {
        return vec!["No simulation of this study is stored.".to_owned()];
    }
    let ended: Vec<String> = ended.iter().map(|(status, n)| format!("{} {status}", count(*n))).collect();
    vec![format!("{}: {}.", counted(all.len(), "simulation"), ended.join(", "))]
}

#[cfg(test)]
mod tests;
