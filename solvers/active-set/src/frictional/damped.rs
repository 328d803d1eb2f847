//! Proximal points in space, where the law is not piecewise linear: Newton's method, its steps shortened where they make things worse,
//! and followed by sweeps, leads from one to the next.

use super::newton::Newton;
use super::points::{PointSolver, Progress};
use crate::layout::{Drawn, distance};
use nalgebra::Vector3;

/// Steps of Newton to a point, at most.
const STEPS: u32 = 25;

/// Residual of a point over ε times the way to it, at most (–).
const REACHED: f64 = 0.1;

/// Iterate of Newton's method.
pub(super) struct Damped {
    /// √J.
    s: Vec<Vector3<f64>>,
    /// The point before (√J).
    centre: Vec<Vector3<f64>>,
    /// Steps from the centre.
    steps: u32,
}

impl PointSolver<3, 6> for Damped {
    fn begin(_: &Newton<3, 6>, s: &[Vector3<f64>]) -> Self {
        Self { s: s.to_vec(), centre: s.to_vec(), steps: 0 }
    }

    fn advance(&mut self, newton: &mut Newton<3, 6>, epsilon: f64) -> Progress {
        let drawn = Drawn { epsilon, centre: Some(&self.centre) };
        let before = newton.left(drawn, &self.s);
        let next = newton.shortened(drawn, &self.s, before);
        self.steps += 1;
        let is_last = next.is_none() || self.steps >= STEPS;
        let mut left = before;
        if let Some(next) = next {
            (self.s, left) = next;
        }
        let moved = distance(&self.s, &self.centre);
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
