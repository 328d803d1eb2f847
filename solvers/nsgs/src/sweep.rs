//! Non-linear Gauss-Seidel: one contact after the other, each solved for (2) with all others kept.
//!
//! M. Jean, The non-smooth contact dynamics method, Comput. Methods Appl. Mech. Engrg. 177 (1999) 235-257; the
//! paper's reference \[1\]. Cost of a sweep: one visit of each contact, that is two gathers and two scatters of a
//! velocity; whatever the order, the visits are made level by level, and the grains are numbered as they are visited, which
//! changes no bit. q(r) never increases for 0 < ω < 2.

use crate::order::Order;
use crate::row::{Row, row};
use contact::scaled::{by_levels, scaled_velocity};
use contact::{ContactProblem, Iteration, SetupError, Solver, Work};
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
    /// In the order of the sweep, level by level, like all that follows.
    rows: Vec<Row>,
    /// The contact of each row.
    order: Vec<u32>,
    /// s = √`W_αα` r (√J).
    s: Vec<f64>,
    /// √`W_αα` (kg^-½).
    unit: Vec<f64>,
    /// y = M^½ (`V_free` + M⁻¹ H r), kept up to date contact by contact; grains in the order of their first visit.
    y: Vec<Vector2<f64>>,
    relaxation: f64,
    symmetric: bool,
    sweeps: u64,
}

impl Iteration for Run {
    fn advance(&mut self) {
        for (row, s) in self.rows.iter().zip(&mut self.s) {
            row.solve(s, &mut self.y, self.relaxation);
        }
        self.sweeps += 1;
        if self.symmetric {
            for (row, s) in self.rows.iter().zip(&mut self.s).rev() {
                row.solve(s, &mut self.y, self.relaxation);
            }
            self.sweeps += 1;
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        for ((s, unit), contact) in self.s.iter().zip(&self.unit).zip(&self.order) {
            r[*contact as usize] = s / unit;
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
        let order = in_levels(problem, &self.order.of(problem, self.seed));
        let grains = by_first_visit(problem, &order);
        let mut place = vec![0; problem.grain_count()];
        for (new, grain) in (0_u32..).zip(&grains) {
            place[*grain as usize] = new;
        }
        let row = |contact: &u32| row(problem, *contact, |grain| place[grain as usize]);
        let (rows, unit): (Vec<Row>, Vec<f64>) = order.iter().map(row).unzip();
        let y = scaled_velocity(problem, r0);
        let y = grains.iter().map(|grain| y[*grain as usize]).collect();
        let s = order.iter().zip(&unit).map(|(contact, unit)| unit * r0[*contact as usize]).collect();
        let Self { relaxation, symmetric, .. } = *self;
        Ok(Box::new(Run { rows, order, s, unit, y, relaxation, symmetric, sweeps: 0 }))
    }
}

/// The same sweep, level by level.
fn in_levels(problem: &ContactProblem, order: &[u32]) -> Vec<u32> {
    let ends = order.iter().map(|contact| problem.contacts()[*contact as usize].ends());
    by_levels(ends, problem.grain_count()).iter().map(|place| order[*place as usize]).collect()
}

/// The grains that have contacts, in the order in which a sweep first visits them: those that it needs one after the other
/// then lie close together.
fn by_first_visit(problem: &ContactProblem, order: &[u32]) -> Vec<u32> {
    let mut seen = vec![false; problem.grain_count()];
    let visits = order.iter().flat_map(|contact| problem.contacts()[*contact as usize].grains());
    visits.filter(|grain| !std::mem::replace(&mut seen[*grain as usize], true)).collect()
}
