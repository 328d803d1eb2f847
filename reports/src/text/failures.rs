//! The runs that failed, each with its reason; one that proves that there is no solution has not.

use contact::Measure;
use polars::df;
use polars::prelude::DataFrame;

use crate::read::{Ending, RunRow, Simulation, Study, Verdicts, count, number};
use crate::text::chosen;

/// One row per run that failed, or per simulation that did not come to its end.
pub(crate) fn failures(study: &Study) -> DataFrame {
    match study {
        Study::Problems(study) => of_runs(&study.runs),
        Study::Simulations(all) => of_simulations(all),
    }
}

fn of_runs(runs: &[RunRow]) -> DataFrame {
    let verdicts = Verdicts::of(runs);
    let failed: Vec<&RunRow> = runs.iter().filter(|run| !verdicts.is_right(run)).collect();
    let own = df!(
        "variant" => failed.iter().map(|run| run.words.as_str()).collect::<Vec<_>>(),
        "ended" => failed.iter().map(|run| run.ending.text()).collect::<Vec<_>>(),
        "run" => failed.iter().map(|run| run.id.as_str()).collect::<Vec<_>>(),
        "reason" => failed.iter().map(|run| reason(run)).collect::<Vec<_>>(),
    );
    chosen(failed, "problem method variant ended iterations run reason", own)
}

fn of_simulations(all: &[Simulation]) -> DataFrame {
    let failed = all.iter().filter(|simulation| !simulation.reason.is_empty());
    chosen(failed, "scene method variant status reason", Ok(DataFrame::empty()))
}

/// Returns the reason in the row, or the meaning of its ending.
fn reason(run: &RunRow) -> String {
    if !run.reason.is_empty() {
        return run.reason.clone();
    }
    let (iterations, measure) = (count(run.iterations as usize), run.stop_on.replace('_', " "));
    let value = |value: Option<f64>| value.map_or("undefined".to_owned(), |value| number(value, 2));
    let at_end = || value(run.stopping_measure().and_then(|measure| run.end.get(measure)));
    match run.ending {
        Ending::IterationLimit => format!(
            "all {iterations} iterations made, and {measure} is {} where {} was asked",
            at_end(),
            value(run.tolerance)
        ),
        Ending::Stalled => format!(
            "after {iterations} iterations no further one makes it better, and {measure} is {} where {} was asked",
            at_end(),
            value(run.tolerance)
        ),
        Ending::Diverged => {
            format!("not finite, or far above its own scale of energy, at iteration {iterations}")
        }
        Ending::Infeasible => {
            format!(
                "at iteration {iterations} it claimed to prove that there is no solution, and there is one"
            )
        }
        Ending::FalseConvergence => {
            let but = match run.end.velocity_error() {
                Some(error) => format!("the velocity error is {}", number(error, 2)),
                None => format!("the natural map is {}", value(run.end.get(Measure::NaturalMap))),
            };
            format!("{measure} met its tolerance while {but}")
        }
        Ending::Converged | Ending::Skipped | Ending::Failed => "no reason is stored".to_owned(),
    }
}

#[cfg(test)]
mod tests;
