//! Charts of predictions for ranks.

use super::declared::{MEASURED_ON_RANKS, ON_RANKS};
use super::predicted::has_ranks;
use crate::read::{Ending, Problems, RunRow, Scenes};
use crate::text::Part;

/// The runs; those whose iterates do not depend on subdomains, on as many as others have too.
fn shared(runs: &[RunRow]) -> Vec<RunRow> {
    let made = || runs.iter().filter(|run| run.status != Ending::Skipped);
    let shared = made().filter(|run| run.is_shared_anyhow()).flat_map(|run| {
        let mut seen = vec![run.subdomains];
        let others = made().filter(move |other| {
            let is_new = other.problem == run.problem
                && other.spectrum.contains_key("neighbours")
                && !seen.contains(&other.subdomains);
            if is_new {
                seen.push(other.subdomains);
            }
            is_new
        });
        others.map(|other| run.shared_as(other))
    });
    made().cloned().chain(shared).collect()
}

/// The chart of predictions; where ranks made runs, that of their seconds over the predicted.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    if has_ranks(&study.runs) {
        return MEASURED_ON_RANKS.parts(study);
    }
    let (runs, given, scenes) = (shared(&study.runs), Vec::new(), Scenes::new());
    ON_RANKS.parts(&Problems { runs, given, scenes })
}

#[cfg(test)]
mod tests;
