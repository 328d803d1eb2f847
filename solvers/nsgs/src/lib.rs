//! Non-linear Gauss-Seidel (NSGS) on the whole problem: one contact after the other, each solved for (2) with all others kept.
//!
//! M. Jean, The non-smooth contact dynamics method, Comput. Methods Appl. Mech. Engrg. 177 (1999) 235-257; the
//! paper's reference \[1\]. Cost of a sweep: one visit of each contact, that is two gathers and two scatters of a
//! velocity; whatever the order, the visits are made level by level, and the grains are numbered as they are visited, which
//! changes no bit. Without friction q(r) never increases for 0 < ω < 2.

mod order;

pub use order::Order;

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
    /// Whether an iteration is a sweep forward and a sweep backward, instead of one forward.
    pub symmetric: bool,
}

/// The paper's method: the order of the list, ω = 1, forward sweeps.
impl Default for Nsgs {
    fn default() -> Self {
        Self { order: Order::Natural, seed: 1, relaxation: 1.0, symmetric: false }
    }
}

struct Run<M: Mechanics> {
    sweep: Sweep<M>,
    relaxation: f64,
    symmetric: bool,
    sweeps: u64,
}

impl<M: Mechanics> Iteration for Run<M> {
    fn advance(&mut self) {
        self.sweep.forward(self.relaxation);
        self.sweeps += 1;
        if self.symmetric {
            self.sweep.backward(self.relaxation);
            self.sweeps += 1;
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweep.impulses(r);
    }

    fn work(&self) -> Work {
        Work { contact_updates: self.sweeps * self.sweep.rows.len() as u64, ..Work::default() }
    }
}

impl<M: Mechanics> Solver<M> for Nsgs {
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let sweep = Sweep::new(problem, &self.order.of(problem, self.seed), r0);
        let Self { relaxation, symmetric, .. } = *self;
        Ok(Box::new(Run { sweep, relaxation, symmetric, sweeps: 0 }))
    }
}
