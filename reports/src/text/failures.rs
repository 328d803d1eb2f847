//! The runs that failed, each with how near it came; one that proves that there is no solution has not.

use polars::df;
use polars::prelude::DataFrame;

use crate::read::{RunRow, Simulation, Study, Verdicts, ending_text};
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
        "least_natural_map" => failed.iter().map(|run| run.least().map(|(least, _)| least)).collect::<Vec<_>>(),
        "at_iteration" => failed.iter().map(|run| run.least().map(|(_, at)| at)).collect::<Vec<_>>(),
        "ended" => failed.iter().map(|run| ending_text(run.status)).collect::<Vec<_>>(),
        "run" => failed.iter().map(|run| run.id.as_str()).collect::<Vec<_>>(),
    );
    chosen(
        failed,
        "problem method variant ended iterations stop_on tolerance natural_map least_natural_map at_iteration velocity_error run reason",
        own,
    )
}

fn of_simulations(all: &[Simulation]) -> DataFrame {
    let failed = all.iter().filter(|simulation| !simulation.reason.is_empty());
    chosen(failed, "scene method variant status reason", Ok(DataFrame::empty()))
}

#[cfg(test)]
mod tests;
