//! Accelerated iterations of a sweep.

use super::Sweep;
use crate::acceleration::{Momentum, Trail};
use crate::mechanics::{Mechanics, VisitedIn};
use crate::visit::Visited;

/// Acceleration of the iterations of one sweep.
pub struct Accelerated<C: Visited> {
    momentum: Momentum,
    trail: Trail<C>,
    restarts: u64,
}

impl<C: Visited> Accelerated<C> {
    /// The acceleration of iterations that begin where `sweep` is.
    pub fn new<M: Mechanics>(momentum: Momentum, sweep: &Sweep<M, C>) -> Self
    where
        C: VisitedIn<M>,
    {
        let momentum = momentum.of_problem(M::HAS_FRICTION);
        Self { momentum, trail: sweep.trail(sweep.without_impulses()), restarts: 0 }
    }

    /// Makes an `iteration`, which extrapolates and judges by the trail.
    pub fn iterate<M: Mechanics>(
        &mut self,
        sweep: &mut Sweep<M, C>,
        iteration: impl FnOnce(&mut Sweep<M, C>, &mut Trail<C>),
    ) where
        C: VisitedIn<M>,
    {
        let Self { momentum, trail, restarts } = self;
        if momentum.has_restarted() {
            sweep.renew(trail);
            *restarts += 1;
        }
        trail.begin(momentum.factor());
        iteration(sweep, trail);
        momentum.turn(trail.sums());
    }

    /// Makes velocities anew, see [`Sweep::refine`], and those of x with them.
    pub fn refine<M: Mechanics>(&mut self, sweep: &mut Sweep<M, C>)
    where
        C: VisitedIn<M>,
    {
        if sweep.renewal.is_some() {
            let before = sweep.y.clone();
            sweep.refine();
            self.trail.shift(&before, &sweep.y);
        }
    }

    /// Returns the products with W made so far: H r at each restart, half of one.
    pub fn delassus_products(&self) -> u64 {
        self.restarts.div_ceil(2)
    }
}
