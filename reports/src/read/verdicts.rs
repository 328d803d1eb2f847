//! What is true of a problem beside a run's own word.

use std::collections::BTreeSet;

use crate::read::{Ending, RunRow};

/// What is known of the problems.
pub(crate) struct Verdicts<'r> {
    /// Problems that have a solution: a run converged, or the reference is certified.
    solved: BTreeSet<&'r str>,
}

impl<'r> Verdicts<'r> {
    pub(crate) fn of(runs: &'r [RunRow]) -> Self {
        let solved = |run: &&RunRow| run.has_converged() || run.end.velocity_error.is_some();
        Self { solved: runs.iter().filter(solved).map(|run| run.problem.as_str()).collect() }
    }

    /// Whether a run proved that there is no solution, and nothing speaks against it.
    pub(crate) fn is_proof(&self, run: &RunRow) -> bool {
        run.ending == Ending::Infeasible && !self.solved.contains(run.problem.as_str())
    }

    /// Whether a run found what there is to find: the solution, or that there is none.
    pub(crate) fn is_right(&self, run: &RunRow) -> bool {
        run.has_converged() || self.is_proof(run)
    }
}
