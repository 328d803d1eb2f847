//! Non-linear Gauss-Seidel: one contact after the other, each solved for (2) with all others kept.
//!
//! M. Jean, The non-smooth contact dynamics method, Comput. Methods Appl. Mech. Engrg. 177 (1999) 235-257; the
//! paper's reference \[1\]. Cost of a sweep: one visit of each contact, that is two gathers and two scatters of a
//! velocity. q(r) never increases for 0 < ω < 2.

use crate::order::Order;
use crate::row::{Row, start_velocity};
use contact::{ContactProblem, Iteration, SetupError, Solver, Work, law};
use nalgebra::Vector2;
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

struct Run {
    /// In the order of the sweep, like `r`.
    rows: Vec<Row>,
    /// The contact of each row.
    order: Vec<u32>,
    r: Vec<f64>,
    /// V = `V_free` + M⁻¹ H r, kept up to date contact by contact.
    velocity: Vec<Vector2<f64>>,
    relaxation: f64,
    symmetric: bool,
    sweeps: u64,
}

/// v = Hᵗ V + c at α; r⁺ = max(0, r − ω v/`W_αα`); V ← V + M⁻¹ `h_α` (r⁺ − r).
#[inline]
fn solve(row: &Row, r: &mut f64, velocity: &mut [Vector2<f64>], relaxation: f64) {
    let r_plus = law::update(*r, row.relative(velocity), row.inverse_delassus, relaxation);
    row.push(r_plus - *r, velocity);
    *r = r_plus;
}

impl Iteration for Run {
    fn advance(&mut self) {
        for (row, r) in self.rows.iter().zip(&mut self.r) {
            solve(row, r, &mut self.velocity, self.relaxation);
        }
        self.sweeps += 1;
        if self.symmetric {
            for (row, r) in self.rows.iter().zip(&mut self.r).rev() {
                solve(row, r, &mut self.velocity, self.relaxation);
            }
            self.sweeps += 1;
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        for (value, contact) in self.r.iter().zip(&self.order) {
            r[*contact as usize] = *value;
        }
    }

    fn work(&self) -> Work {
        Work { contact_updates: self.sweeps * self.rows.len() as u64, ..Work::default() }
    }
}

impl Solver for Nsgs {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let order = self.order.of(problem, self.seed);
        let rows = order.iter().map(|contact| Row::new(problem, *contact)).collect();
        let velocity = start_velocity(problem, r0);
        let r = order.iter().map(|contact| r0[*contact as usize]).collect();
        let Self { relaxation, symmetric, .. } = *self;
        Ok(Box::new(Run { rows, order, r, velocity, relaxation, symmetric, sweeps: 0 }))
    }
}
