//! How a run ended.

/// How a run ended.
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
    pub(crate) const ALL: [Self; 8] = [
        Self::Converged,
        Self::IterationLimit,
        Self::Stalled,
        Self::Diverged,
        Self::Infeasible,
        Self::FalseConvergence,
        Self::Skipped,
        Self::Failed,
    ];

    pub(crate) fn of(status: &str) -> Self {
        let same = |ending: &Self| ending.text().replace(' ', "-") == status;
        Self::ALL.into_iter().find(same).unwrap_or(Self::Failed)
    }

    /// As a key says it.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "iteration limit",
            Self::Stalled => "stalled",
            Self::Diverged => "diverged",
            Self::Infeasible => "infeasible",
            Self::FalseConvergence => "false convergence",
            Self::Skipped => "skipped",
            Self::Failed => "failed",
        }
    }
}
