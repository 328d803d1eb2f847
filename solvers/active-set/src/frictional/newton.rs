//! Newton's method on the statuses of contacts: which are open, stick, or slide, and in which direction.
//!
//! P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods, Comput. Methods
//! Appl. Mech. Engrg. 92 (1991) 353-375; in the space of grains, and with the proximal term of R. T. Rockafellar (SIAM J. Control
//! Optim. 14 (1976) 877-898), since W is singular where contacts depend on each other.

use super::matrix::Matrix;
use crate::Best;
use crate::layout::{Drawn, Layout};
use crate::start::Start;
use contact::{Cone, Frictional, Packing, Rough, SetupError, Work};
use nalgebra::SVector;

/// ε of Newton's method alone (–): what sticks more than motion allows keeps its impulses but for so much.
const EPSILON: f64 = 1e-6;

/// Newton's method, and its iterate.
pub(super) struct Newton<const D: usize, const N: usize>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    pub(super) layout: Layout<D, N>,
    /// Matrix, from its first use on; an error where it does not fit in memory.
    matrix: Option<Result<Matrix<D, N>, SetupError>>,
    /// √J.
    s: Vec<SVector<f64, D>>,
    /// Sweeps over the contacts.
    sweeps: u64,
}

/// Result of a step of Newton's method.
pub(super) enum Step {
    /// Residual at round-off.
    Solved,
    /// Residual of at most half the one before.
    On,
    /// Greater residual than that, or no step.
    InVain,
}

impl<const D: usize, const N: usize> Newton<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Without a point that draws.
    pub(super) const ALONE: Drawn<'static, D> = Drawn { epsilon: EPSILON, centre: None };

    /// Lays the problem out.
    pub(super) fn new(problem: &Packing<Rough<D>>) -> Self {
        Self { layout: Layout::new(problem), matrix: None, s: Vec::new(), sweeps: 0 }
    }

    /// Prepares the matrix, unless it is prepared.
    ///
    /// # Errors
    /// Where the problem is too large for that.
    pub(super) fn prepare(&mut self) -> Result<(), SetupError> {
        let matrix = self.matrix.get_or_insert_with(|| Matrix::new(&self.layout));
        matrix.as_ref().map(|_| ()).map_err(Clone::clone)
    }

    /// Returns how many sweeps take as long as a factor; none, where the matrix does not fit in memory.
    pub(super) fn sweeps_of_factor(&mut self) -> Option<u64> {
        let (layout, matrix) = self.parts()?;
        Some(Start::Sweeps.iterations_of(matrix.cost(), layout.columns.len(), D) as u64)
    }

    /// Returns the residual of the law that impulses `r` (N·s) leave (√J).
    pub(super) fn left_by(&self, r: &[f64]) -> f64 {
        self.left(Self::ALONE, &self.layout.scaled(r))
    }

    /// Returns the problem and the matrix; none, where it does not fit in memory.
    pub(super) fn parts(&mut self) -> Option<(&Layout<D, N>, &mut Matrix<D, N>)> {
        self.prepare().ok()?;
        let matrix = self.matrix.iter_mut().flatten().next()?;
        Some((&self.layout, matrix))
    }

    /// Takes the impulses `r` (N·s); returns what they leave of the law (√J).
    pub(super) fn begin(&mut self, r: &[f64]) -> f64 {
        self.s = self.layout.scaled(r);
        self.left(Self::ALONE, &self.s)
    }

    /// Advances the iterate by one whole step. Where the iterate has the statuses of a solution, it leads there; elsewhere sweeps lead on.
    pub(super) fn advance(&mut self, best: &mut Best) -> Step {
        let before = self.left(Self::ALONE, &self.s);
        if self.layout.is_round_off(before, &self.s) {
            return Step::Solved;
        }
        let s = std::mem::take(&mut self.s);
        let Some(next) = self.step(Self::ALONE, &s) else { return Step::InVain };
        let left = self.left(Self::ALONE, &next);
        if !(left <= 0.5 * before) {
            return Step::InVain;
        }
        self.s = next;
        best.take(left, |r| self.layout.impulses(&self.s, r));
        if self.layout.is_round_off(left, &self.s) { Step::Solved } else { Step::On }
    }

    /// The impulses to which a step of Newton leads from s, for the statuses of s − v: those that s has to first order. v comes from s
    /// each time, so that no error of K stays. `None` if the matrix has no factor,
    /// or does not fit in memory.
    pub(super) fn step(&mut self, drawn: Drawn<D>, s: &[SVector<f64, D>]) -> Option<Vec<SVector<f64, D>>> {
        let (layout, matrix) = self.parts()?;
        let status = layout.statuses(s, &drawn.velocity(layout, s));
        if !matrix.is_of(&status, drawn.epsilon) && !matrix.factorise(&layout.columns, &status, drawn.epsilon)
        {
            return None;
        }
        let own = s.iter().zip(&status).zip(&layout.columns);
        let mut s: Vec<_> = own.map(|((s, status), column)| status.project(*s, column.friction())).collect();
        // An impulse in a new direction changes the statuses again.
        matrix.settle(
            &layout.columns,
            &mut s,
            |s| drawn.velocity(layout, s),
            |s, v, _| status.iter().zip(s).zip(v).any(|((status, s), v)| status.is_new(*s, *v)),
        );
        s.iter().all(|s| s.iter().all(|x| x.is_finite())).then_some(s)
    }

    /// Makes sweeps over the contacts.
    pub(super) fn sweep(&mut self, s: &mut [SVector<f64, D>], sweeps: u32) {
        self.sweeps += u64::from(sweeps);
        self.layout.sweep(s, sweeps);
    }

    /// Returns the residual of s in the law, with v + ε (s − centre) in the place of v (√J).
    pub(super) fn left(&self, drawn: Drawn<D>, s: &[SVector<f64, D>]) -> f64 {
        self.layout.left(s, &drawn.velocity(&self.layout, s))
    }

    /// Work so far.
    pub(super) fn work(&self) -> Work {
        let contact_updates = self.sweeps * self.layout.columns.len() as u64;
        let matrix = self.matrix.iter().flatten().map(Matrix::work).next().unwrap_or_default();
        Work { contact_updates, ..matrix }
    }
}
