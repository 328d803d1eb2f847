//! Projected Jacobi: the sweep of NSGS with every relative velocity taken at the old impulses.
//!
//! Converges for ω < 2/λmax(`W_D`⁻¹ W) only. Cost of an iteration: that of a sweep, and a copy of the velocities.

use crate::row::{Row, start_velocity};
use contact::{ContactProblem, Iteration, SetupError, Solver, Work, law};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of projected Jacobi.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Jacobi {
    /// ω (–). Any positive value is accepted: that a packing diverges at ω = 1 is a result.
    pub relaxation: f64,
}

/// ω = ½. Equal discs touch at most 6 others, so λmax(`W_D`⁻¹ W) ≤ 3 on them and any ω < 2/3 converges; ½ leaves a
/// margin for unequal discs.
impl Default for Jacobi {
    fn default() -> Self {
        Self { relaxation: 0.5 }
    }
}

struct Run {
    rows: Vec<Row>,
    relaxation: f64,
    r: Vec<f64>,
    /// V of the impulses `r`.
    velocity: Vec<Vector2<f64>>,
    /// V of the iteration before, from which all v are taken.
    old_velocity: Vec<Vector2<f64>>,
    iterations: u64,
}

impl Iteration for Run {
    fn advance(&mut self) {
        self.old_velocity.copy_from_slice(&self.velocity);
        for (row, r) in self.rows.iter().zip(&mut self.r) {
            // v = Hᵗ V_old + c;  r⁺ = max(0, r − ω v/W_αα);  V ← V + M⁻¹ h_α (r⁺ − r)
            let v = row.relative(&self.old_velocity);
            let r_plus = law::update(*r, v, row.inverse_delassus, self.relaxation);
            row.push(r_plus - *r, &mut self.velocity);
            *r = r_plus;
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn work(&self) -> Work {
        Work { contact_updates: self.iterations * self.r.len() as u64, ..Work::default() }
    }
}

impl Solver for Jacobi {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let velocity = start_velocity(problem, r0);
        Ok(Box::new(Run {
            rows: (0..problem.contact_count() as u32).map(|contact| Row::new(problem, contact)).collect(),
            relaxation: self.relaxation,
            r: r0.to_vec(),
            old_velocity: velocity.clone(),
            velocity,
            iterations: 0,
        }))
    }
}
