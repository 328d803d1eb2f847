//! Judgement of iterates for the loop: measures, and proofs that there is no solution.

use analysis::Meter;
use contact::{Measure, Measures, Mechanics};

/// Judge of the iterates of a run. Where ranks share a problem all must ask alike, and get the same answers.
pub(crate) trait Judge {
    /// Scale of the impulses' work, fixed by the problem (J).
    fn scale(&self) -> f64;

    /// Measures the iterate `r` (N·s), which comes after `before`; that is empty if there is none.
    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures;

    /// Reports whether the iterate `r` is proved not to end the run; `false` says nothing.
    fn goes_on(&mut self, on: Measure, tolerance: f64, energy: f64, iterates: (&[f64], &[f64])) -> bool;

    /// Reports whether one of the rays, or impulses near one, proves that there is no solution.
    fn any_proves_infeasible(&self, rays: &[Vec<f64>]) -> bool;

    /// The greatest approach velocity of r = 0 (m/s).
    fn greatest_rate(&self) -> f64;

    /// Reports whether all solutions have the same velocity.
    fn has_one_velocity(&self) -> bool;

    /// Reports the logical OR over all ranks.
    fn any(&self, here: bool) -> bool;
}

impl<M: Mechanics> Judge for Meter<'_, M> {
    fn scale(&self) -> f64 {
        self.scale()
    }

    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        self.measure_after(before, r, velocity_jump)
    }

    fn goes_on(&mut self, on: Measure, tolerance: f64, energy: f64, iterates: (&[f64], &[f64])) -> bool {
        self.goes_on(on, tolerance, energy, iterates)
    }

    fn any_proves_infeasible(&self, rays: &[Vec<f64>]) -> bool {
        self.any_proves_infeasible(rays)
    }

    fn greatest_rate(&self) -> f64 {
        self.greatest_rate()
    }

    fn has_one_velocity(&self) -> bool {
        M::HAS_ONE_VELOCITY
    }

    fn any(&self, here: bool) -> bool {
        self.any(here)
    }
}
