//! Ending of a run in words, and the evidence for or against it.

use std::collections::BTreeSet;

use results::name::Name;

use crate::read::{Ending, RunRow};

/// Returns an ending as a key says it.
pub(crate) fn ending_text(ending: Ending) -> String {
    ending.name().replace('-', " ")
}

/// Known facts on the problems of a study.
pub(crate) struct Verdicts<'r> {
    /// Problems that have a solution: a run converged, or the reference is certified.
    solved: BTreeSet<&'r str>,
}

impl<'r> Verdicts<'r> {
    pub(crate) fn of(runs: &'r [RunRow]) -> Self {
        let solved = |run: &&RunRow| run.has_converged() || run.end.velocity_error().is_some();
        Self { solved: runs.iter().filter(solved).map(|run| run.problem.as_str()).collect() }
    }

    /// Reports whether a run proved that there is no solution, and nothing speaks against it.
    pub(crate) fn is_proof(&self, run: &RunRow) -> bool {
        run.status == Ending::Infeasible && !self.solved.contains(run.problem.as_str())
    }

    /// Reports whether a run is right: it found the solution, or proved that there is none.
    pub(crate) fn is_right(&self, run: &RunRow) -> bool {
        run.has_converged() || self.is_proof(run)
    }
}
