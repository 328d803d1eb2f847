//! Non-linear Gauss-Seidel (NSGS) on the whole problem: one contact after the other, each solved for (2) with all others kept.
//!
//! M. Jean, The non-smooth contact dynamics method, Comput. Methods Appl. Mech. Engrg. 177 (1999) 235-257; the
//! paper's reference \[1\]. Cost of a sweep: one visit of each contact, that is two gathers and two scatters of a
//! velocity; whatever the order, the visits are made level by level, and the grains are numbered as they are visited, which
//! changes no bit. Without friction q(r) never increases for 0 < ω < 2. With acceleration the iterations are extrapolated
//! ([`contact::acceleration`]): one more pass over the velocities, and two lists of impulses to keep.

mod order;

pub use order::Order;

use contact::acceleration::{Acceleration, LAG, Momentum};
use contact::precision::Precision;
use contact::sweep::{Accelerated, Sweep};
use contact::{Iteration, Mechanics, Packing, SetupError, Solver, VisitedIn, Work};
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
    /// Precision of the sweeps: all in `double`; all in `single`; or `mixed`, which corrects velocities in single precision, while impulses,
    /// the law and from time to time the residuals are double.
    pub precision: Precision,
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
            precision: Precision::Double,
        }
    }
}

/// Iterations between two renewals of the velocities, unless these are in double precision.
///
/// A renewal passes over the contacts twice, as two sweeps do, so it must be rare; and between two of them round-off adds up. Where sweeps change a grain
/// by about the same from one to the next, k of them leave its correction with a relative error of at most ε k, ε = 6e-8, which is to stay
/// small beside the 1/k that a sweep changes: ε k² ≪ 1. With 128 renewals are 2 % of the time, and that is 0.1 %.
const RENEWAL: u64 = 128;

struct Run<M: Mechanics, C: VisitedIn<M>> {
    sweep: Sweep<M, C>,
    relaxation: f64,
    symmetric: bool,
    accelerated: Option<Accelerated<C>>,
    iterations: u64,
}

impl<M: Mechanics, C: VisitedIn<M>> Run<M, C> {
    fn new(sweep: Sweep<M, C>, settings: &Nsgs, momentum: Option<Momentum>) -> Self {
        let Nsgs { relaxation, symmetric, .. } = *settings;
        let accelerated = momentum.map(|momentum| Accelerated::new(momentum, &sweep));
        Self { sweep, relaxation, symmetric, accelerated, iterations: 0 }
    }

    fn passes(&self) -> u64 {
        1 + u64::from(self.symmetric)
    }
}

impl<M: Mechanics, C: VisitedIn<M>> Iteration for Run<M, C> {
    fn advance(&mut self) {
        let backward = (0..self.passes()).map(|pass| pass == 1);
        let Self { sweep, relaxation, accelerated, .. } = self;
        let is_due = self.iterations > 0 && self.iterations.is_multiple_of(RENEWAL);
        if let Some(accelerated) = accelerated {
            if is_due {
                accelerated.refine(sweep);
            }
            accelerated.iterate(sweep, |sweep, trail| sweep.iterate_ahead(*relaxation, backward, trail));
        } else {
            if is_due {
                sweep.refine();
            }
            sweep.iterate(*relaxation, backward);
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweep.impulses(r);
    }

    fn work(&self) -> Work {
        let delassus_products = match self.sweep.renewal_products() {
            0 => self.accelerated.as_ref().map_or(0, Accelerated::delassus_products),
            products => products,
        };
        let contact_updates = self.passes() * self.iterations * self.sweep.rows.len() as u64;
        Work { contact_updates, delassus_products, ..Work::default() }
    }
}

impl<M: Mechanics> Solver<M> for Nsgs {
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let momentum = self.acceleration.momentum(self.lag, self.slack)?;
        let sweep = Sweep::new(problem, &self.order.of(problem, self.seed), r0);
        Ok(match self.precision {
            Precision::Double => Box::new(Run::new(sweep, self, momentum)),
            Precision::Single => Box::new(Run::new(sweep.single(), self, momentum)),
            Precision::Mixed => Box::new(Run::new(sweep.mixed(), self, momentum)),
        })
    }
}
