//! Newton's method on the statuses of contacts with friction: which are open, stick, or slide to which side.

use super::layout::{Layout, Status, against, moving};
use super::matrix::Matrix;
use contact::{Packing, RoughDiscs, SetupError, Work};
use nalgebra::Vector2;

/// κ, the weight of the contacts against the masses (–): what sticks more than motion allows keeps its impulses but for 1/κ.
const PENALTY: f64 = 1e6;

/// Solves with one factor, at most: each makes good what 1/κ left of the one before.
const SOLVES: u32 = 6;

/// The share of what a solve had before it that is left after it, at most, or no other follows (–).
const WORTH_ANOTHER: f64 = 0.1;

/// Statuses, and the impulses that go with them.
pub(crate) struct Statuses {
    layout: Layout,
    status: Vec<Status>,
    s: Vec<Vector2<f64>>,
    v: Vec<Vector2<f64>>,
    matrix: Matrix,
}

impl Statuses {
    /// Lays the problem out, with r = 0.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub(crate) fn new(problem: &Packing<RoughDiscs>) -> Result<Self, SetupError> {
        let layout = Layout::new(problem);
        let s = vec![Vector2::zeros(); layout.columns.len()];
        Ok(Self {
            matrix: Matrix::new(&layout.columns, layout.grains())?,
            status: vec![Status::Open; layout.columns.len()],
            v: layout.velocity(&s),
            s,
            layout,
        })
    }

    /// Takes the impulses `r` (N·s).
    pub(crate) fn begin(&mut self, r: &[f64]) {
        self.s = self.layout.scaled(r);
        self.measure();
    }

    /// The nearest impulses that the law admits, in the problem's order (N·s).
    pub(crate) fn impulses(&self, r: &mut [f64]) {
        self.layout.impulses(&self.s, r);
    }

    /// Returns the residual of the law, weighed as energy: the natural map (√J).
    pub(crate) fn left(&self) -> f64 {
        self.layout.left(&self.s, &self.v)
    }

    /// Reports whether the residual of the law is round-off.
    pub(crate) fn is_solved(&self) -> bool {
        self.layout.is_round_off(self.left(), &self.s)
    }

    /// Work so far.
    pub(crate) fn work(&self) -> Work {
        self.matrix.work()
    }

    /// One step of Newton: the statuses of s − v, and the impulses for which they hold. v comes from s each time, so that no error of K
    /// stays. Returns how many contacts changed, `None` if the matrix has no factor.
    pub(crate) fn step(&mut self) -> Option<usize> {
        let now = self.layout.statuses(&self.s, &self.v);
        let changed = now.iter().zip(&self.status).filter(|(now, before)| now != before).count();
        self.status = now;
        if !self.matrix.is_of(&self.status, PENALTY)
            && !self.matrix.factorise(&self.layout.columns, &self.status, PENALTY)
        {
            return None;
        }
        self.project();
        let mut left = moving(&self.status, &self.v);
        for _ in 0..SOLVES {
            self.matrix.stop(&self.layout.columns, &self.v, &mut self.s);
            self.measure();
            let before = std::mem::replace(&mut left, moving(&self.status, &self.v));
            if !(left < WORTH_ANOTHER * before) {
                break;
            }
        }
        Some(changed)
    }

    /// Impulses that have their statuses.
    fn project(&mut self) {
        for ((s, status), column) in self.s.iter_mut().zip(&self.status).zip(&self.layout.columns) {
            *s = match status {
                Status::Stick => *s,
                _ => against(*status, column, *s).unwrap_or_default(),
            };
        }
        self.measure();
    }

    /// v of s.
    fn measure(&mut self) {
        self.v = self.layout.velocity(&self.s);
    }
}
