//! Proximal points in space, where the law is not piecewise linear: whole steps of Newton's method lead from one to the next.
//!
//! A whole step may raise the residual, since contacts change their statuses on its way; with the new statuses the next steps usually
//! converge quadratically. A step that is shortened until the residual falls often ends at the first such change.

use super::newton::Newton;
use super::points::{FEW, PointSolver, Progress};
use crate::layout::{Drawn, distance};
use nalgebra::Vector3;

/// Residual of a point over ε times the way to it, at most (–). With 0.1 as many of 72 packings of 250 grains come to 1e-8, for 8 % more
/// factors.
const REACHED: f64 = 0.5;

/// Iterate of Newton's method.
pub(super) struct Whole {
    /// √J.
    s: Vec<Vector3<f64>>,
    /// The point before (√J).
    centre: Vec<Vector3<f64>>,
    /// Steps from the centre.
    steps: u32,
}

impl PointSolver<3, 6> for Whole {
    fn begin(_: &Newton<3, 6>, s: &[Vector3<f64>]) -> Self {
        Self { s: s.to_vec(), centre: s.to_vec(), steps: 0 }
    }

    fn advance(&mut self, newton: &mut Newton<3, 6>, epsilon: f64) -> Progress {
        let drawn = Drawn { epsilon, centre: Some(&self.centre) };
        let next = newton.step(drawn, &self.s);
        self.steps += 1;
        let is_last = next.is_none() || self.steps >= FEW;
        self.s = next.unwrap_or_else(|| self.centre.clone());
        let (left, moved) = (newton.left(drawn, &self.s), distance(&self.s, &self.centre));
        if left <= REACHED * epsilon * moved || newton.layout.is_round_off(left, &self.s) {
            self.centre.copy_from_slice(&self.s);
            Progress::Reached { steps: std::mem::take(&mut self.steps) }
        } else if is_last {
            self.s.copy_from_slice(&self.centre);
            self.steps = 0;
            Progress::Missed
        } else {
            Progress::On
        }
    }

    fn s(&self) -> &[Vector3<f64>] {
        &self.s
    }
}
