//! How a run ended, and its sign.

use plotters::style::RGBColor;

use crate::ReportError;
use crate::canvas::{Canvas, Place};
use crate::style::{Mark, Pen, WHITE};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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
        match status {
            "converged" => Self::Converged,
            "iteration-limit" => Self::IterationLimit,
            "stalled" => Self::Stalled,
            "diverged" => Self::Diverged,
            "infeasible" => Self::Infeasible,
            "false-convergence" => Self::FalseConvergence,
            "skipped" => Self::Skipped,
            _ => Self::Failed,
        }
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

    /// Its sign, of a shape of its own.
    pub(crate) fn draw(self, canvas: &Canvas, (x, y): Place, color: RGBColor) -> Result<(), ReportError> {
        const HALF: f64 = 0.85;
        let pen = Pen { color, width: 0.3, dash: &[] };
        let stroke = |from: Place, to: Place| {
            let place = |(dx, dy): Place| (x + HALF * dx, y + HALF * dy);
            canvas.line(&[place(from), place(to)], Pen { width: 0.45, ..pen })
        };
        match self {
            Self::Converged => canvas.mark(Mark::Disc, (x, y), pen),
            Self::IterationLimit => canvas.polygon(
                &[(x - 0.7 * HALF, y - HALF), (x + HALF, y), (x - 0.7 * HALF, y + HALF)],
                WHITE,
                Some(pen),
            ),
            Self::Stalled => canvas.polygon(
                &[(x - HALF, y - HALF), (x + HALF, y - HALF), (x + HALF, y + HALF), (x - HALF, y + HALF)],
                WHITE,
                Some(pen),
            ),
            Self::Diverged => {
                stroke((-1.0, -1.0), (1.0, 1.0))?;
                stroke((-1.0, 1.0), (1.0, -1.0))
            }
            Self::Infeasible => {
                canvas.disc((x, y), HALF, WHITE, Some(pen))?;
                stroke((-0.7, 0.7), (0.7, -0.7))
            }
            Self::FalseConvergence => canvas.disc((x, y), 0.7, WHITE, Some(pen)),
            Self::Skipped => stroke((-1.0, 0.0), (1.0, 0.0)),
            Self::Failed => {
                stroke((-1.0, 0.0), (1.0, 0.0))?;
                stroke((0.0, -1.0), (0.0, 1.0))
            }
        }
    }
}
