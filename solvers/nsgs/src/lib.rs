//! Non-linear Gauss-Seidel (NSGS) on the whole problem: one contact after the other, each solved for (2) with all others kept.
//!
//! M. Jean, The non-smooth contact dynamics method, Comput. Methods Appl. Mech. Engrg. 177 (1999) 235-257; the
//! paper's reference \[1\]. Cost of a sweep: one visit of each contact, that is two gathers and two scatters of a
//! velocity; whatever the order, the visits are made level by level, and the grains are numbered as they are visited, which
//! changes no bit. Without friction q(r) never increases for 0 < ω < 2. With acceleration the iterations are extrapolated
//! ([`contact::acceleration`]): one more pass over the velocities, and two lists of impulses to keep.

mod order;

pub use order::Order;

use contact::acceleration::{Accelerated, Acceleration, LAG};
use contact::sweep::Sweep;
use contact::{Iteration, Mechanics, Packing, SetupError, Solver, Work};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of NSGS.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Nsgs {
    /// Order in which a sweep visits the contacts.
    pub order: Order,
    /// Seed of the order `shuffled`; the others ignore it.
    pub seed: u64,
    /// ω (–): 1 solves (2) exactly at each contact; above, over-relaxation. Any positive value is accepted, since
    /// where it fails (ω ≥ 2) is of interest.
    pub relaxation: f64,
    /// Symmetric sweeps: an iteration is one forward and one backward, instead of one forward.
    pub symmetric: bool,
    /// Extrapolation over the iterations.
    pub acceleration: Acceleration,
    /// q (–): the extrapolation grows as β = j/(j + q) over the j iterations since the last restart.
    pub lag: f64,
    /// ρ (–): acceleration restarts also where an iteration changes the impulses more than ρ times as much as the least since the last
    /// restart; unless given 1.2 with friction, and 5 without.
    pub slack: Option<f64>,
}

/// The paper's method: the order of the list, ω = 1, forward sweeps.
impl Default for Nsgs {
    fn default() -> Self {
        Self {
            order: Order::Natural,
            seed: 1,
            relaxation: 1.0,
            symmetric: false,
            acceleration: Acceleration::None,
            lag: LAG,
            slack: None,
        }
    }
}

struct Run<M: Mechanics> {
    sweep: Sweep<M>,
    relaxation: f64,
    symmetric: bool,
    accelerated: Option<Accelerated<M>>,
    sweeps: u64,
}

impl<M: Mechanics> Iteration for Run<M> {
    fn advance(&mut self) {
        let Self { sweep, relaxation, .. } = self;
        let passes = 1 + usize::from(self.symmetric);
        let backward = (0..passes).map(|pass| pass == 1);
        match &mut self.accelerated {
            Some(accelerated) => {
                accelerated.iterate(sweep, |sweep, trail| sweep.iterate_ahead(*relaxation, backward, trail));
            }
            None => sweep.iterate(*relaxation, backward),
        }
        self.sweeps += passes as u64;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweep.impulses(r);
    }

    fn work(&self) -> Work {
        Work {
            contact_updates: self.sweeps * self.sweep.rows.len() as u64,
            delassus_products: self.accelerated.as_ref().map_or(0, Accelerated::delassus_products),
            ..Work::default()
        }
    }
}

impl<M: Mechanics> Solver<M> for Nsgs {
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let sweep = Sweep::new(problem, &self.order.of(problem, self.seed), r0);
        let Self { relaxation, symmetric, .. } = *self;
        let momentum = self.acceleration.momentum(self.lag, self.slack)?;
        let accelerated = momentum.map(|momentum| Accelerated::new(momentum, &sweep));
        Ok(Box::new(Run { sweep, relaxation, symmetric, accelerated, sweeps: 0 }))
    }
}
