//! Proximal points: ε draws the impulses to those of the point before, with v + ε (s − centre) in the place of v.
//!
//! Where more sticks than motion allows, sweeps of non-linear Gauss-Seidel move impulses along the kernel of W by the same amount each
//! time; a proximal point goes 1/ε times as far at once, through all that opens and slides on its way. So ε falls after a point that
//! took few steps. It grows where none is reached, and every second time sweeps look for another beginning.
//!
//! R. T. Rockafellar, Monotone operators and the proximal point algorithm, SIAM J. Control Optim. 14 (1976) 877-898; Coulomb's law is
//! not monotone, so nothing is promised.

use super::Halved;
use super::newton::Newton;
use crate::Best;
use contact::{Frictional, Rough};
use nalgebra::SVector;

/// ε of the first point (–).
const FIRST: f64 = 1e-3;

/// Factor by which ε falls and grows (–), and how many steps are few; in space, where there are no exact paths, a point takes no more.
const FACTOR: f64 = 2.0;
pub(super) const FEW: u32 = 6;

/// Sweeps after every second point that is not reached.
const SWEEPS: u32 = 200;

/// Points in which the residual is not halved, after which nothing leads on.
const PATIENCE: u64 = 300;

/// Solver of one proximal point after another.
pub(super) trait PointSolver<const D: usize, const N: usize>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Begins at s (√J).
    fn begin(newton: &Newton<D, N>, s: &[SVector<f64, D>]) -> Self;

    /// Advances by one step towards the point that ε (–) draws to the one before.
    fn advance(&mut self, newton: &mut Newton<D, N>, epsilon: f64) -> Progress;

    /// Returns the iterate (√J): where no step leads on, the point before.
    fn s(&self) -> &[SVector<f64, D>];
}

/// Result of a step towards a point.
pub(super) enum Progress {
    /// The point is reached after so many steps, or lines of a path.
    Reached {
        steps: u32,
    },
    On,
    /// The point is not reached: the iterate is the one before.
    Missed,
}

/// Result of a proximal point, or of a step towards it.
pub(super) enum Approach {
    /// Newton's method ends it.
    Nearly,
    On,
    /// Nothing leads on.
    InVain,
}

/// Proximal points.
pub(super) struct Points<P, const D: usize, const N: usize> {
    solver: P,
    /// ε (–).
    epsilon: f64,
    /// Points in a row that were not reached.
    missed: u32,
    halved: Halved,
}

impl<P: PointSolver<D, N>, const D: usize, const N: usize> Points<P, D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Begins at the best impulses.
    pub(super) fn new(newton: &Newton<D, N>, best: &Best) -> Self {
        let solver = P::begin(newton, &newton.layout.scaled(&best.impulses));
        Self { solver, epsilon: FIRST, missed: 0, halved: Halved::at(best.left) }
    }

    /// Advances by one step towards a point; what leaves at most `round_off` (√J) is nearly a solution.
    pub(super) fn advance(&mut self, newton: &mut Newton<D, N>, best: &mut Best, round_off: f64) -> Approach {
        let progress = self.solver.advance(newton, self.epsilon);
        let s = newton.layout.admitted(self.solver.s());
        let left = newton.left(Newton::ALONE, &s);
        best.take(left, |r| newton.layout.impulses(&s, r));
        self.halved.look(left);
        match progress {
            Progress::On => {}
            Progress::Reached { steps } => {
                self.missed = 0;
                self.halved.since += 1;
                if steps <= FEW {
                    self.epsilon /= FACTOR;
                }
            }
            Progress::Missed => {
                self.halved.since += 1;
                self.missed += 1;
                if self.missed.is_multiple_of(2) {
                    let mut s = newton.layout.admitted(self.solver.s());
                    newton.sweep(&mut s, SWEEPS);
                    self.solver = P::begin(newton, &s);
                } else {
                    self.epsilon *= FACTOR;
                }
            }
        }
        if left <= round_off || newton.layout.is_round_off(left, &s) {
            Approach::Nearly
        } else if self.halved.since > PATIENCE {
            Approach::InVain
        } else {
            Approach::On
        }
    }
}
