//! In the plane: Newton's method on the statuses open, stick and slide, which ends where it begins near a solution, and wanders anywhere
//! else; and proximal points, each reached along an exact path, which come through where walls move and where impulses only drift.

mod convex;
mod layout;
mod matrix;
mod path;
mod proximal;
mod statuses;

use crate::stages::{Approach, Newton, RUNG, Step};
use crate::{ActiveSet, Best};
use contact::{Iteration, Packing, RoughDiscs, SetupError, Solver, Work};
pub use convex::Convex;
use layout::terms_of_b;
use proximal::Proximal;
use statuses::Statuses;

impl<'p> Newton<'p> for Statuses {
    type Mechanics = RoughDiscs;
    type Points = Proximal<'p>;

    fn new(problem: &'p Packing<RoughDiscs>) -> Result<Self, SetupError> {
        Self::new(problem)
    }

    fn begin(&mut self, r: &[f64]) -> f64 {
        self.begin(r);
        self.left()
    }

    fn step(&mut self, before: f64, best: &mut Best) -> Step {
        let changed = self.step();
        let left = self.left();
        let is_better = best.take(left, |r| self.impulses(r));
        if self.is_solved() {
            Step::Solved
        } else if changed.is_none() || !(left < before) || changed == Some(0) && !is_better {
            Step::InVain
        } else {
            Step::On(left.max(before * RUNG))
        }
    }

    fn points(&self, problem: &'p Packing<RoughDiscs>, best: &Best) -> Option<Proximal<'p>> {
        Proximal::new(problem, &best.impulses).ok()
    }

    fn approach(&mut self, points: &mut Proximal<'p>, best: &mut Best, _: f64) -> Approach {
        if let Some(left) = points.advance() {
            best.take(left, |r| points.impulses(r));
        }
        if points.is_solved() {
            Approach::Solved
        } else if points.is_in_vain() {
            Approach::InVain
        } else {
            Approach::On
        }
    }

    fn work_of(points: &Proximal<'p>) -> Work {
        points.work()
    }

    fn work(&self) -> Work {
        self.work()
    }
}

impl Solver<RoughDiscs> for ActiveSet {
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughDiscs>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        self.with_friction::<Statuses>(problem, r0)
    }
}
