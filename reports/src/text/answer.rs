//! The answer to what a study asks, in sentences with its numbers.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::read::{Ending, Problems, RunRow, Verdicts, count, counted, number, problems, span};
use crate::text::found::comparable;

/// States the cost of more subdomains in iterations, if asked and varied; else which methods are right in every run. Then the
/// first in time. Of a single method, the cost of subdomains alone. Where all runs go on to their limit, the time of an iteration.
pub(crate) fn answer(study: &Problems, of_subdomains: bool) -> Vec<String> {
    if study.runs.iter().all(|run| run.tolerance == Some(0.0)) {
        return an_iteration(&study.runs).into_iter().collect();
    }
    let mut methods: Vec<&str> = Vec::new();
    for run in &study.runs {
        if !methods.contains(&run.method.as_str()) {
            methods.push(&run.method);
        }
    }
    let mut sentences = Vec::new();
    if of_subdomains {
        sentences.extend(methods.iter().filter_map(|method| more_subdomains(&study.runs, method)));
    }
    if methods.len() > 1 {
        if sentences.is_empty() {
            sentences.extend(who_is_right(&study.runs, &methods));
        }
        sentences.extend(first_in_time(&study.runs));
    }
    sentences
}

/// States the time of an iteration on the largest problem, by each kind of run.
fn an_iteration(runs: &[RunRow]) -> Option<String> {
    let largest = runs.iter().max_by_key(|run| run.contacts)?;
    let on_it = runs.iter().filter(|run| run.problem == largest.problem);
    let taken = on_it.filter_map(|run| {
        let on = match run.exchange.ranks {
            1 => counted(run.provenance.threads as usize, "thread"),
            ranks => counted(ranks as usize, "rank"),
        };
        Some(format!("{} s with {} on {on}", number(run.seconds_per_iteration()?, 2), run.label()))
    });
    let taken: Vec<String> = taken.collect();
    (!taken.is_empty()).then(|| format!("An iteration on {}: {}.", largest.problem, taken.join(", ")))
}

/// The methods of which every run converged or proved that there is no solution, and the one that fails most often. A run that was
/// skipped is none.
fn who_is_right(runs: &[RunRow], methods: &[&str]) -> Vec<String> {
    let verdicts = Verdicts::of(runs);
    let made = |method: &str| {
        let of_method = runs.iter().filter(|run| run.method == method);
        let (skipped, made): (Vec<_>, Vec<_>) = of_method.partition(|run| run.ending == Ending::Skipped);
        (made.iter().filter(|run| !verdicts.is_right(run)).count(), made.len(), skipped.len())
    };
    let all: Vec<(&str, (usize, usize, usize))> =
        methods.iter().map(|method| (*method, made(method))).filter(|(_, (_, made, _))| *made > 0).collect();
    let named = |(method, (_, runs, skipped)): &(&str, (usize, usize, usize))| match skipped {
        0 => format!("{method} ({runs})"),
        skipped => format!("{method} ({runs}; {skipped} skipped)"),
    };
    let right: Vec<String> = all.iter().filter(|(_, (failed, ..))| *failed == 0).map(named).collect();
    let mut sentences = vec![match right.as_slice() {
        [] => "No method converged, or proved that there is no solution, in all of its runs.".to_owned(),
        right => format!(
            "Converged, or proved that there is no solution, in all of their runs: {}.",
            right.join(", ")
        ),
    }];
    let share = |(_, (failed, all, _)): &(&str, (usize, usize, usize))| *failed as f64 / *all as f64;
    let most = all.iter().max_by(|a, b| share(a).total_cmp(&share(b))).filter(|most| share(most) > 0.0);
    sentences.extend(most.map(|(method, (failed, all, _))| {
        format!("Most often not: {method}, in {} of {}.", count(*failed), counted(*all, "run"))
    }));
    sentences
}

/// States how many more iterations a method takes with the most subdomains than with the fewest, all else being equal.
fn more_subdomains(runs: &[RunRow], method: &str) -> Option<String> {
    let of_method = || runs.iter().filter(|run| run.method == method);
    let (fewest, most) = span(of_method().map(|run| f64::from(run.subdomains)))?;
    if fewest == most {
        return None;
    }
    let (mut ratios, mut to_zeta, mut failed, mut on) = (Vec::new(), Vec::new(), 0, Vec::new());
    let mut between = 0;
    let mut rule = None;
    for few in of_method().filter(|run| f64::from(run.subdomains) == fewest && run.has_converged()) {
        let same = |run: &&RunRow| run.problem == few.problem && others(run) == others(few);
        let is_between = |run: &&RunRow| (fewest..most).contains(&f64::from(run.subdomains));
        between += of_method().filter(same).filter(is_between).filter(|run| !run.has_converged()).count();
        match of_method().filter(same).find(|run| f64::from(run.subdomains) == most) {
            Some(many) if many.has_converged() && few.iterations > 0 => {
                ratios.push(many.iterations as f64 / few.iterations as f64);
                let both = many.iterations_to_zeta_1e_4.zip(few.iterations_to_zeta_1e_4);
                to_zeta.extend(both.filter(|(_, few)| *few > 0).map(|(many, few)| many as f64 / few as f64));
                on.push(few.problem.as_str());
                rule = rule.or(few.rule());
            }
            Some(many) if !many.has_converged() => failed += 1,
            _ => {}
        }
    }
    let (pairs, rule) = (ratios.len(), rule?);
    on.dedup();
    let mut sentence = format!(
        "From {fewest} to {most} subdomains {method} needs {} to {rule}",
        more(span(ratios.iter().copied())?)
    );
    // Where it was reached with both numbers of subdomains.
    if let Some(zeta) = span(to_zeta.iter().copied()).filter(|_| to_zeta.len() == pairs) {
        sentence.extend([", and ", &more(zeta), " to ζ ≤ 10⁻⁴"]);
    }
    sentence.extend([" (", &counted(on.len(), "problem"), ")"]);
    if failed > 0 {
        sentence.extend([format!("; {} more did not converge with {most}", counted(failed, "run"))]);
    }
    if between > 0 {
        sentence.extend([format!("; {} in between did not converge", counted(between, "run"))]);
    }
    Some(sentence + ".")
}

/// The settings of a run apart from its subdomains, with all else that may set it apart on its problem.
fn others(run: &RunRow) -> (Vec<(&String, &Value)>, bool, &str, Option<u64>) {
    let settings = run.settings.iter().filter(|(key, _)| *key != "subdomains").collect();
    (settings, run.warm_start, &run.stop_on, run.tolerance.map(f64::to_bits))
}

/// A range of ratios in words: `12 to 28 % more iterations`.
fn more((low, high): (f64, f64)) -> String {
    if high >= 3.0 {
        let (low, high) = (number(low, 2), number(high, 2));
        let range = if low == high { low } else { format!("{low} to {high}") };
        return format!("{range} times the iterations");
    }
    let percent = |ratio: f64| (100.0 * (ratio - 1.0)).round() as i64;
    match (percent(low), percent(high)) {
        (0, 0) => "as many iterations".to_owned(),
        (low, high) if low == high && low > 0 => format!("{low}\u{a0}% more iterations"),
        (low, high) if low == high => format!("{}\u{a0}% fewer iterations", -low),
        (low, high) if low >= 0 => format!("{low} to {high}\u{a0}% more iterations"),
        (low, high) if high <= 0 => format!("{} to {}\u{a0}% fewer iterations", -high, -low),
        (low, high) => format!("between {}\u{a0}% fewer and {high}\u{a0}% more iterations", -low),
    }
}

/// Which kinds of run took the least time, on how many problems.
fn first_in_time(runs: &[RunRow]) -> Option<String> {
    let problems = problems(runs);
    let mut firsts: BTreeMap<String, usize> = BTreeMap::new();
    for problem in &problems {
        // With one method alone nobody is first; where others did not converge, one is.
        let mut on_it = runs.iter().filter(|run| run.problem == **problem && run.ending != Ending::Skipped);
        let method = on_it.next().map(|run| &run.method);
        if on_it.any(|run| Some(&run.method) != method) {
            let compared = comparable(runs, problem);
            let timed = compared.iter().filter_map(|run| Some((run.seconds()?, run)));
            if let Some((_, first)) = timed.min_by(|a, b| a.0.total_cmp(&b.0)) {
                *firsts.entry(first.label()).or_default() += 1;
            }
        }
    }
    let mut firsts: Vec<(String, usize)> = firsts.into_iter().collect();
    firsts.sort_by_key(|(_, problems)| std::cmp::Reverse(*problems));
    let of = problems.len();
    let words =
        firsts.iter().take(3).map(|(label, n)| format!("{label} on {n} of {}", counted(of, "problem")));
    let words = words.collect::<Vec<_>>().join("; ");
    (!words.is_empty()).then(|| format!("Fastest to the tolerance: {words}."))
}

#[cfg(test)]
mod tests;
