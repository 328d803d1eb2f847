//! Between spheres: Newton's method on the statuses open, stick and slide, where sliding has a direction; and proximal points.
//!
//! The law is not piecewise linear here, so Newton's method ends by round-off, not by statuses that stay. In packings at rest more may
//! stick than motion allows, and impulses then drift along the kernel of W, further than any stage follows them.

mod layout;
mod newton;
mod proximal;

use crate::stages::{self, Approach, Step};
use crate::{ActiveSet, Best};
use contact::{Iteration, Packing, RoughSpheres, SetupError, Solver, Work};
use nalgebra::Vector3;
use newton::{Drawn, Newton};
use proximal::{Proximal, shortened};

/// ε of Newton's method alone (–): what sticks more than motion allows keeps its impulses but for so much.
const EPSILON: f64 = 1e-6;

/// Newton's method without a point that draws.
const ALONE: Drawn<'static> = Drawn { epsilon: EPSILON, centre: None };

/// Newton's method, and its iterate.
struct InSpace {
    newton: Newton,
    /// √J.
    s: Vec<Vector3<f64>>,
}

impl<'p> stages::Newton<'p> for InSpace {
    type Mechanics = RoughSpheres;
    type Points = Proximal;

    fn new(problem: &'p Packing<RoughSpheres>) -> Result<Self, SetupError> {
        Ok(Self { newton: Newton::new(problem)?, s: Vec::new() })
    }

    fn begin(&mut self, r: &[f64]) -> f64 {
        self.s = self.newton.layout.scaled(r);
        self.newton.left(ALONE, &self.s)
    }

    fn step(&mut self, _: f64, best: &mut Best) -> Step {
        let before = self.newton.left(ALONE, &self.s);
        if self.newton.layout.is_round_off(before, &self.s) {
            return Step::Solved;
        }
        let Some((next, left)) = shortened(&mut self.newton, ALONE, &self.s, before) else {
            return Step::InVain;
        };
        self.s = next;
        best.take(left, |r| self.newton.layout.impulses(&self.s, r));
        Step::On(left)
    }

    fn points(&self, _: &'p Packing<RoughSpheres>, best: &Best) -> Option<Proximal> {
        Some(Proximal::new(self.newton.layout.scaled(&best.impulses), best.left))
    }

    fn approach(&mut self, points: &mut Proximal, best: &mut Best, round_off: f64) -> Approach {
        let left = points.advance(&mut self.newton);
        best.take(left, |r| self.newton.layout.impulses(&points.s, r));
        if best.left <= round_off || self.newton.layout.is_round_off(left, &points.s) {
            Approach::Nearly
        } else if points.is_in_vain() {
            Approach::InVain
        } else {
            Approach::On
        }
    }

    fn work(&self) -> Work {
        self.newton.work()
    }
}

impl Solver<RoughSpheres> for ActiveSet {
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughSpheres>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        self.with_friction::<InSpace>(problem, r0)
    }
}
