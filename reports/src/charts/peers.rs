//! Peers: every method on every problem, ours and other codes, by what it reaches and by both clocks.

use contact::Measure;
use polars::df;
use polars::prelude::DataFrame;
use serde_json::Value;

use crate::read::{
    ACCURACIES, Ending, Problems, RunRow, accuracy_text, counted, median, number, problems, repeats, span,
};
use crate::text::{Part, frame};

/// The accuracy at which seconds are compared: the strictest.
const ACCURACY: f64 = ACCURACIES[ACCURACIES.len() - 1];

/// `peers`: a row for each run; and in sentences the median ratio of each method.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let rows: Vec<Row> =
        problems(&study.runs).iter().flat_map(|problem| of_problem(study, problem)).collect();
    let there = there(&study.runs);
    let note = format!(
        "\nEnding, velocity error, with friction that from the nearest solution that is known, and natural map: of the whole \
         run. Seconds: set-up and solver to {there}, by the code's own clock; process: the whole process of another code by \
         ours, with what starts it and what it reads and writes, which ours has not. Ratio: of the seconds to the least on the \
         problem. Asked: the code's own tolerance at which it first came there. {}\n{}",
        repeats(&study.runs),
        reasons(&study.runs)
    );
    vec![Part::table("peers", table(&rows), note), Part::text("peers-ratios", sentences(&rows, &there))]
}

/// Names the accuracy that is enough, in the measure that the study is stopped on.
fn there(runs: &[RunRow]) -> String {
    let on = runs.first().and_then(RunRow::stopping_measure).filter(|on| *on == Measure::VelocityError);
    let name = if on.is_some() { "a velocity error" } else { "a natural map" };
    format!("{name} of {}", accuracy_text(ACCURACY))
}

struct Row {
    problem: String,
    method: String,
    ending: Ending,
    velocity_error: Option<f64>,
    natural_map: Option<f64>,
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

fn of_problem(study: &Problems, problem: &str) -> Vec<Row> {
    let runs = || study.runs.iter().filter(|run| run.problem == problem);
    let least = span(runs().filter_map(|run| Some(reached(run)?.seconds))).map(|(least, _)| least);
    let row = |run: &RunRow| {
        let reached = reached(run);
        // What was not begun has none.
        let end = |measure| if run.ending == Ending::Skipped { None } else { run.end.get(measure) };
        Row {
            problem: problem.to_owned(),
            method: run.label(),
            ending: run.ending,
            velocity_error: end(Measure::VelocityError),
            natural_map: end(Measure::NaturalMap),
            reached,
            ratio: reached.zip(least).map(|(reached, least)| reached.seconds / least),
        }
    };
    runs().map(row).collect()
}

/// The first sample that is accurate enough; of another code the run at one tolerance that it is, with both clocks.
fn reached(run: &RunRow) -> Option<Reached> {
    let accurate = |error: Option<f64>| error.is_some_and(|error| error <= ACCURACY);
    let at = run.curve.iter().position(|point| accurate(point.stopped_on(run)))?;
    let Some(rungs) = run.derived.get("rungs").and_then(Value::as_array) else {
        let seconds = run.setup_s? + run.curve[at].iterating_s;
        return Some(Reached { seconds, process_s: None, asked: None });
    };
    // Before the first of them the curve has r = 0.
    let rung = at.checked_sub(1).and_then(|at| rungs.get(at))?;
    let value = |key: &str| rung[key].as_f64();
    let seconds = value("setup_s")? + value("solve_s")?;
    Some(Reached { seconds, process_s: value("process_s"), asked: value("tolerance") })
}

fn table(rows: &[Row]) -> DataFrame {
    let reached = |of: fn(&Reached) -> Option<f64>| -> Vec<Option<f64>> {
        rows.iter().map(|row| row.reached.as_ref().and_then(of)).collect()
    };
    frame(df!(
        "problem" => rows.iter().map(|row| row.problem.as_str()).collect::<Vec<_>>(),
        "method" => rows.iter().map(|row| row.method.as_str()).collect::<Vec<_>>(),
        "ending" => rows.iter().map(|row| row.ending.text()).collect::<Vec<_>>(),
        "velocity_error" => rows.iter().map(|row| row.velocity_error).collect::<Vec<_>>(),
        "natural_map" => rows.iter().map(|row| row.natural_map).collect::<Vec<_>>(),
        "seconds" => reached(|reached| Some(reached.seconds)),
        "ratio" => rows.iter().map(|row| row.ratio).collect::<Vec<_>>(),
        "process_s" => reached(|reached| reached.process_s),
        "asked" => reached(|reached| reached.asked),
    ))
}

/// A line for each method: on how many of the problems that it was run on it came there, and its median ratio.
fn sentences(rows: &[Row], there: &str) -> String {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let ran = |method: &&str| rows.iter().any(|row| row.method == *method && row.ending != Ending::Skipped);
    let (ran, skipped): (Vec<&str>, Vec<&str>) = methods.into_iter().partition(ran);
    let mut ranked: Vec<(Option<f64>, String)> =
        ran.into_iter().map(|method| sentence(rows, method, there)).collect();
    let or_last = |ratio: &Option<f64>| ratio.unwrap_or(f64::INFINITY);
    ranked.sort_by(|(a, _), (b, _)| or_last(a).total_cmp(&or_last(b)));
    if !skipped.is_empty() {
        ranked.push((None, format!("Skipped on every problem: {}.\n", skipped.join("; "))));
    }
    ranked.into_iter().map(|(_, sentence)| sentence).collect()
}

fn sentence(rows: &[Row], method: &str, there: &str) -> (Option<f64>, String) {
    let of_method = || rows.iter().filter(|row| row.method == method);
    let ratios: Vec<f64> = of_method().filter_map(|row| row.ratio).collect();
    let skipped = of_method().filter(|row| row.ending == Ending::Skipped).count();
    let (reached, made) = (ratios.len(), of_method().count() - skipped);
    let ratio = median(ratios);
    let cost =
        ratio.map_or(String::new(), |ratio| format!(", median {} times the least seconds", number(ratio, 2)));
    let left_out = if skipped == 0 { String::new() } else { format!("; {skipped} skipped") };
    (ratio, format!("{method}: {reached} of {} to {there}{cost}{left_out}.\n", counted(made, "problem")))
}

/// Why other codes gave no answer.
fn reasons(runs: &[RunRow]) -> String {
    let failed = runs.iter().filter(|run| run.ending == Ending::Failed);
    let reason = |run: &RunRow| format!("\nfailed: {} on {}: {}\n", run.label(), run.problem, run.reason);
    failed.map(reason).collect::<Vec<_>>().concat()
}

#[cfg(test)]
mod tests;
