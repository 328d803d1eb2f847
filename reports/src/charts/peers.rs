//! Peers: every method on every problem, ours and other codes, by what it reaches and by both clocks.

use contact::Measure;
use polars::df;
use polars::prelude::DataFrame;
use serde_json::Value;

use crate::read::{
    ACCURACIES, COSTS, Ending, Problems, RunRow, accuracy_text, ending_text, median, problems, repeats, span,
    unique,
};
use crate::text::{Part, chosen, frame};

/// Returns the accuracy at which seconds are compared: the strictest at which some run was to stop.
fn accuracy(runs: &[RunRow]) -> f64 {
    let asked = span(runs.iter().filter_map(|run| run.tolerance)).map_or(0.0, |(least, _)| least);
    ACCURACIES.into_iter().filter(|accuracy| *accuracy >= asked).fold(ACCURACIES[0], f64::min)
}

/// Returns `peers`: a row for each run; `peers-ratios`: the median ratio of each method; and each other code beside the best of ours at each
/// accuracy, problem by problem in `peers-problems`, over all of them in `peers-codes`; and `peers-tolerances`: what a code's own tolerance
/// is worth.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = &study.runs;
    let accuracy = accuracy(runs);
    let rows: Vec<Row> =
        problems(runs).iter().flat_map(|problem| of_problem(runs, problem, accuracy)).collect();
    let there = there(runs, accuracy);
    let note = format!(
        "\nEnding, velocity error, with friction that from the nearest solution that is known, and natural map: of the whole \
         run. Seconds: set-up and solver to {there}, by the code's own clock; process: the whole process of another code by \
         ours, with what starts it and what it reads and writes, which ours has not. Ratio: of the seconds to the least on the \
         problem. Asked: the code's own tolerance at which it first reached that. {}\n{}",
        repeats(&study.runs),
        reasons(&study.runs)
    );
    let pairs = pairs(runs);
    let of_best = "\nSeconds: those of the best setting of the code, and of the best of our methods, to an answer that is as accurate; ours stays so. \
                   Ratio: of the code's to ours.\n";
    vec![
        Part::table("peers", table(&rows), note),
        Part::table("peers-ratios", ratios(&rows), format!("\nReached: {there}.\n")),
        Part::table("peers-problems", by_problem(&pairs), of_best.to_owned()),
        Part::table("peers-codes", by_code(&pairs), "\nRatio: of the seconds of the code's best setting to those of the best of ours, over the problems that both solve.\n".to_owned()),
        Part::table("peers-tolerances", tolerances(runs), "\nNatural map of the answer to the code's own tolerance: least, median and most over the problems that it answered.\n".to_owned()),
    ]
}

/// Names the accuracy that is enough, in the measure that the study is stopped on.
fn there(runs: &[RunRow], accuracy: f64) -> String {
    let on = runs.first().map(|run| run.stop_on.0).filter(|on| *on == Measure::VelocityError);
    let name = if on.is_some() { "a velocity error" } else { "a natural map" };
    format!("{name} of {}", accuracy_text(accuracy))
}

struct Row<'r> {
    run: &'r RunRow,
    reached: Option<Reached>,
    /// Ratio of its seconds to the least on the problem.
    ratio: Option<f64>,
}

/// When a run first was accurate enough.
#[derive(Clone, Copy)]
struct Reached {
    seconds: f64,
    process_s: Option<f64>,
    asked: Option<f64>,
}

fn of_problem<'r>(runs: &'r [RunRow], problem: &str, accuracy: f64) -> Vec<Row<'r>> {
    let reached = runs.iter().filter(|run| run.problem == problem).map(|run| (run, reached(run, accuracy)));
    let reached: Vec<(&RunRow, Option<Reached>)> = reached.collect();
    let least = span(reached.iter().filter_map(|(_, reached)| Some(reached.as_ref()?.seconds)));
    let ratio = |reached: Option<Reached>| Some(reached?.seconds / least?.0);
    reached.into_iter().map(|(run, reached)| Row { run, reached, ratio: ratio(reached) }).collect()
}

/// The first sample that is accurate enough and stays so; of another code the run at one tolerance that it is, with both clocks.
fn reached(run: &RunRow, accuracy: f64) -> Option<Reached> {
    let error = run.stopped_on();
    let Some(rungs) = run.derived.get("rungs").and_then(Value::as_array) else {
        let seconds = COSTS[0].to(run, error, accuracy)?;
        return Some(Reached { seconds, process_s: None, asked: None });
    };
    // Each sample is a run of its own. Before the first of them the curve has r = 0.
    let at = run.curve.iter().position(|point| point.get(error).is_some_and(|error| error <= accuracy))?;
    let rung = at.checked_sub(1).and_then(|at| rungs.get(at))?;
    let value = |key: &str| rung[key].as_f64();
    let seconds = value("setup_s")? + value("solve_s")?;
    Some(Reached { seconds, process_s: value("process_s"), asked: value("tolerance") })
}

/// Another code and ours on a problem, each by its best setting to an accuracy.
struct Pair<'r> {
    problem: &'r str,
    accuracy: f64,
    code: &'r str,
    /// Label and seconds.
    theirs: Option<(String, f64)>,
    ours: Option<(String, f64)>,
}

impl Pair<'_> {
    /// Returns the seconds of the other code over ours.
    fn ratio(&self) -> Option<f64> {
        Some(self.theirs.as_ref()?.1 / self.ours.as_ref()?.1)
    }
}

/// Returns a pair for each accuracy, other code, and problem that it was run on.
fn pairs(runs: &[RunRow]) -> Vec<Pair<'_>> {
    let is_other = |run: &RunRow| !run.provenance.other_code.is_empty();
    let best = |of: &dyn Fn(&&RunRow) -> bool, accuracy: f64| {
        let seconds = |run: &RunRow| Some((run.label(), reached(run, accuracy)?.seconds));
        runs.iter().filter(of).filter_map(seconds).min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let codes = unique(runs.iter().filter(|run| is_other(run)).map(|run| run.method.as_str()));
    let mut pairs = Vec::new();
    for code in codes {
        for accuracy in ACCURACIES {
            for problem in problems(runs) {
                let here = |run: &&RunRow| run.problem == problem && run.status != Ending::Skipped;
                if !runs.iter().any(|run| here(&run) && run.method == code) {
                    continue;
                }
                let theirs = best(&|run| here(run) && run.method == code, accuracy);
                let ours = best(&|run| here(run) && !is_other(run), accuracy);
                pairs.push(Pair { problem, accuracy, code, theirs, ours });
            }
        }
    }
    pairs
}

fn by_problem(pairs: &[Pair]) -> DataFrame {
    let seconds = |of: &Option<(String, f64)>| of.as_ref().map(|(_, seconds)| *seconds);
    let label = |of: &Option<(String, f64)>| of.as_ref().map(|(label, _)| label.clone());
    frame(df!(
        "problem" => pairs.iter().map(|pair| pair.problem).collect::<Vec<_>>(),
        "accuracy" => pairs.iter().map(|pair| pair.accuracy).collect::<Vec<_>>(),
        "code" => pairs.iter().map(|pair| pair.code).collect::<Vec<_>>(),
        "its_best" => pairs.iter().map(|pair| label(&pair.theirs)).collect::<Vec<_>>(),
        "its_seconds" => pairs.iter().map(|pair| seconds(&pair.theirs)).collect::<Vec<_>>(),
        "our_best" => pairs.iter().map(|pair| label(&pair.ours)).collect::<Vec<_>>(),
        "our_seconds" => pairs.iter().map(|pair| seconds(&pair.ours)).collect::<Vec<_>>(),
        "ratio" => pairs.iter().map(Pair::ratio).collect::<Vec<_>>(),
    ))
}

fn by_code(pairs: &[Pair]) -> DataFrame {
    let codes = unique(pairs.iter().map(|pair| pair.code));
    let of_code = |code| ACCURACIES.map(|accuracy| (code, accuracy));
    let keys: Vec<(&str, f64)> = codes.into_iter().flat_map(of_code).collect();
    let is_of = |pair: &Pair, key: &(&str, f64)| (pair.code, pair.accuracy) == *key;
    let count = |is: &dyn Fn(&Pair) -> bool| {
        let of = |key| pairs.iter().filter(|pair| is_of(pair, key) && is(pair)).count() as u64;
        keys.iter().map(of).collect::<Vec<_>>()
    };
    let of = |key| pairs.iter().filter(|pair| is_of(pair, key)).filter_map(Pair::ratio).collect();
    let ratios: Vec<Vec<f64>> = keys.iter().map(of).collect();
    let ranges: Vec<_> = ratios.iter().map(|ratios| span(ratios.iter().copied())).collect();
    frame(df!(
        "code" => keys.iter().map(|(code, _)| *code).collect::<Vec<_>>(),
        "accuracy" => keys.iter().map(|(_, accuracy)| *accuracy).collect::<Vec<_>>(),
        "problems" => count(&|_| true),
        "it_reached" => count(&|pair| pair.theirs.is_some()),
        "we_reached" => count(&|pair| pair.ours.is_some()),
        "least_ratio" => ranges.iter().map(|range| Some((*range)?.0)).collect::<Vec<_>>(),
        "median_ratio" => ratios.into_iter().map(median).collect::<Vec<_>>(),
        "most_ratio" => ranges.iter().map(|range| Some((*range)?.1)).collect::<Vec<_>>(),
    ))
}

/// Returns a row for each setting of another code and each tolerance that was asked of it.
fn tolerances(runs: &[RunRow]) -> DataFrame {
    let mut answers: Vec<(String, f64, Vec<f64>)> = Vec::new();
    for run in runs {
        let rungs = run.derived.get("rungs").and_then(Value::as_array).into_iter().flatten();
        // Before the first answer the curve has r = 0.
        for (rung, point) in rungs.zip(run.curve.iter().skip(1)) {
            let (Some(asked), Some(left)) = (rung["tolerance"].as_f64(), point.get(Measure::NaturalMap))
            else {
                continue;
            };
            let label = run.label();
            match answers.iter_mut().find(|(of, at, _)| *of == label && *at == asked) {
                Some((.., all)) => all.push(left),
                None => answers.push((label, asked, vec![left])),
            }
        }
    }
    let ranges: Vec<_> = answers.iter().map(|(.., all)| span(all.iter().copied())).collect();
    frame(df!(
        "method" => answers.iter().map(|(label, ..)| label.as_str()).collect::<Vec<_>>(),
        "tolerance" => answers.iter().map(|(_, asked, _)| *asked).collect::<Vec<_>>(),
        "problems" => answers.iter().map(|(.., all)| all.len() as u64).collect::<Vec<_>>(),
        "natural_map_low" => ranges.iter().map(|range| Some((*range)?.0)).collect::<Vec<_>>(),
        "natural_map" => answers.iter().map(|(.., all)| median(all.clone())).collect::<Vec<_>>(),
        "natural_map_high" => ranges.iter().map(|range| Some((*range)?.1)).collect::<Vec<_>>(),
    ))
}

fn table(rows: &[Row]) -> DataFrame {
    let of = |value: &dyn Fn(&Row) -> Option<f64>| rows.iter().map(value).collect::<Vec<_>>();
    // What was not begun has none.
    let end = |row: &Row, measure| row.run.end.get(measure).filter(|_| row.run.status != Ending::Skipped);
    let own = df!(
        "method" => rows.iter().map(|row| row.run.label()).collect::<Vec<_>>(),
        "ending" => rows.iter().map(|row| ending_text(row.run.status)).collect::<Vec<_>>(),
        "velocity_error" => of(&|row| end(row, Measure::VelocityError)),
        "natural_map" => of(&|row| end(row, Measure::NaturalMap)),
        "seconds" => of(&|row| Some(row.reached?.seconds)),
        "ratio" => of(&|row| row.ratio),
        "process_s" => of(&|row| row.reached?.process_s),
        "asked" => of(&|row| row.reached?.asked),
    );
    let names = "problem method ending velocity_error natural_map seconds ratio process_s asked";
    chosen(rows.iter().map(|row| row.run), names, own)
}

/// A row for each method: on how many of the problems that it was run on it reached that, and its median ratio, the least first.
fn ratios(rows: &[Row]) -> DataFrame {
    let of_method = |method: String| {
        let of = || rows.iter().filter(|row| row.run.label() == method);
        let (ratios, skipped) =
            (of().filter_map(|row| row.ratio), of().filter(|row| row.run.status == Ending::Skipped));
        let (reached, ratio, skipped) =
            (ratios.clone().count() as u64, median(ratios.collect()), skipped.count() as u64);
        let made = of().count() as u64 - skipped;
        (method, made, reached, skipped, ratio)
    };
    let mut methods: Vec<_> =
        unique(rows.iter().map(|row| row.run.label())).into_iter().map(of_method).collect();
    methods.sort_by(|a, b| a.4.unwrap_or(f64::INFINITY).total_cmp(&b.4.unwrap_or(f64::INFINITY)));
    frame(df!(
        "method" => methods.iter().map(|row| row.0.as_str()).collect::<Vec<_>>(),
        "problems" => methods.iter().map(|row| row.1).collect::<Vec<_>>(),
        "reached" => methods.iter().map(|row| row.2).collect::<Vec<_>>(),
        "skipped" => methods.iter().map(|row| row.3).collect::<Vec<_>>(),
        "median_ratio" => methods.iter().map(|row| row.4).collect::<Vec<_>>(),
    ))
}

/// Why other codes gave no answer.
fn reasons(runs: &[RunRow]) -> String {
    let failed = runs.iter().filter(|run| run.status == Ending::Failed);
    let reason = |run: &RunRow| format!("\nfailed: {} on {}: {}\n", run.label(), run.problem, run.reason);
    failed.map(reason).collect::<Vec<_>>().concat()
}

#[cfg(test)]
mod tests;
