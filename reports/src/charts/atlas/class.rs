//! The class of a run: one rule for every method.

use contact::Measure;

use crate::draw::{BLACK, Cell, RGBColor, WHITE};
use crate::read::{Ending, Point, RunRow};

/// Outcome of a method on a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    Converged,
    /// All iterations made, and the measure still falls.
    Slow,
    /// All iterations made, and the measure falls no more.
    Stalled,
    Diverged,
    /// The measure was met far from the solution.
    FalseConvergence,
    /// It was proved that there is no solution.
    Infeasible,
    /// Not begun.
    Skipped,
    /// Any way that this report does not know.
    Failed,
}

/// A run whose measure falls by less than this share while its iterations double is stalled (–).
const STALLED: f64 = 0.01;
/// A velocity error of more than this many times the tolerance is no convergence, as in the loop that stops runs (–).
const FAR: f64 = 100.0;

impl Class {
    /// All, as a key says them; in a cell, with a letter that says it without colour, on a ground that is the darker the worse.
    pub(crate) const ALL: [(Self, &'static str, Cell); 8] = [
        (Self::Converged, "converged", cell("c", RGBColor(222, 240, 232), RGBColor(90, 130, 112))),
        (Self::Slow, "slow", cell("S", RGBColor(250, 214, 110), BLACK)),
        (Self::Stalled, "stalled", cell("T", RGBColor(224, 132, 44), BLACK)),
        (Self::Diverged, "diverged", cell("D", RGBColor(158, 28, 48), WHITE)),
        (Self::FalseConvergence, "false convergence", cell("F", RGBColor(62, 26, 98), WHITE)),
        (Self::Infeasible, "infeasible", cell("i", RGBColor(200, 222, 242), RGBColor(40, 80, 120))),
        (Self::Skipped, "skipped", cell("–", WHITE, RGBColor(120, 120, 120))),
        (Self::Failed, "failed", cell("?", RGBColor(90, 90, 90), WHITE)),
    ];

    /// The class of a run.
    pub(crate) fn of(run: &RunRow) -> Self {
        match run.ending {
            Ending::Converged if is_far(run, run.curve.last()) => Self::FalseConvergence,
            Ending::Converged => Self::Converged,
            Ending::IterationLimit if falls(run) => Self::Slow,
            Ending::IterationLimit | Ending::Stalled => Self::Stalled,
            Ending::Diverged => Self::Diverged,
            Ending::Infeasible => Self::Infeasible,
            Ending::FalseConvergence => Self::FalseConvergence,
            Ending::Skipped => Self::Skipped,
            Ending::Failed => Self::Failed,
        }
    }

    /// Reports whether the method did well: it found the solution, or proved that there is none.
    pub(crate) fn is_good(self) -> bool {
        matches!(self, Self::Converged | Self::Infeasible)
    }

    pub(crate) fn text(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    pub(crate) fn cell(self) -> Cell {
        Self::ALL[self as usize].2
    }
}

const fn cell(letter: &'static str, fill: RGBColor, ink: RGBColor) -> Cell {
    Cell { fill, letter, ink }
}

/// Reports whether a point is far from the true velocity; `false` where that is not known.
fn is_far(run: &RunRow, point: Option<&Point>) -> bool {
    let (Some(tolerance), Some(error)) = (run.tolerance, point.and_then(Point::velocity_error)) else {
        return false;
    };
    error > FAR * tolerance
}

/// Reports whether ζ first met the tolerance at an iterate far from the solution, or of a problem that has none.
pub(crate) fn zeta_lies(run: &RunRow) -> bool {
    let met = |point: &&Point| {
        point.get(Measure::Zeta).zip(run.tolerance).is_some_and(|(zeta, tolerance)| zeta <= tolerance)
    };
    let first = run.curve.iter().find(met);
    first.is_some_and(|point| run.ending == Ending::Infeasible || is_far(run, Some(point)))
}

/// Reports whether the measure still falls: its least value in the second half of the iterations is more than 1 % below
/// that in the first.
fn falls(run: &RunRow) -> bool {
    let half = run.iterations / 2;
    let least = |late: bool| {
        let points = run.curve.iter().filter(|point| (point.iteration > half) == late);
        points.filter_map(|point| point.stopped_on(run)).fold(f64::INFINITY, f64::min)
    };
    least(true) < (1.0 - STALLED) * least(false)
}
