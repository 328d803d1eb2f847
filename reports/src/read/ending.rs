//! Ending of a run, and whether it holds for the problem whatever the run claims.

use std::collections::BTreeSet;

use crate::read::RunRow;

/// Ending of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Ending {
    Converged,
    IterationLimit,
    /// No further iteration changes anything.
    Stalled,
    Diverged,
    Infeasible,
    /// Stopped by a measure that was met far from the solution.
    FalseConvergence,
    /// Not begun.
    Skipped,
    /// Any way that this report does not know.
    #[default]
    Failed,
}

impl Ending {
    /// All, as a key says them.
    pub(crate) const ALL: [(Self, &'static str); 8] = [
        (Self::Converged, "converged"),
        (Self::IterationLimit, "iteration limit"),
        (Self::Stalled, "stalled"),
        (Self::Diverged, "diverged"),
        (Self::Infeasible, "infeasible"),
        (Self::FalseConvergence, "false convergence"),
        (Self::Skipped, "skipped"),
        (Self::Failed, "failed"),
    ];

    pub(crate) fn of(status: &str) -> Self {
        let same = |(_, text): &(Self, &str)| text.replace(' ', "-") == status;
        Self::ALL.into_iter().find(same).map_or(Self::Failed, |(ending, _)| ending)
    }

    pub(crate) fn text(self) -> &'static str {
        Self::ALL[self as usize].1
    }
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
        run.ending == Ending::Infeasible && !self.solved.contains(run.problem.as_str())
    }

    /// Reports whether a run is right: it found the solution, or proved that there is none.
    pub(crate) fn is_right(&self, run: &RunRow) -> bool {
        run.has_converged() || self.is_proof(run)
    }
}
