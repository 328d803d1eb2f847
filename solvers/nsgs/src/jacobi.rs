//! Projected Jacobi: the sweep of NSGS with every relative velocity taken at the old impulses.
//!
//! Converges for ω < 2/λmax(`W_D`⁻¹ W) only; `bounded` keeps it there. Cost of an iteration: that of a sweep, and a copy of the velocities.

use crate::row::{Row, start_velocity};
use contact::spectrum::eigenvalue_bound;
use contact::{ContactProblem, Iteration, SetupError, Solver, Work, law};
use documented::DocumentedFields;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// Settings of projected Jacobi.
#[derive(Clone, Copy, Debug, PartialEq, DocumentedFields, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Jacobi {
    /// ω (–). Any positive value is accepted: that a packing diverges at ω = 1 is a result.
    pub relaxation: f64,
    /// Whether ω is `relaxation` times 2/Λ instead, with Λ ≥ λmax(W_D⁻¹W): then any value below 1 converges, on any problem.
    pub bounded: bool,
}

/// ω = ½. Equal discs touch at most 6 others, so λmax(`W_D`⁻¹ W) ≤ 3 on them and any ω < 2/3 converges; ½ leaves a
/// margin for unequal discs.
impl Default for Jacobi {
    fn default() -> Self {
        Self { relaxation: 0.5, bounded: false }
    }
}

struct Run {
    rows: Vec<Row>,
    relaxation: f64,
    bounded: bool,
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

    fn derived(&self) -> Vec<(&'static str, f64)> {
        if self.bounded { vec![("relaxation", self.relaxation)] } else { Vec::new() }
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
        let bound = eigenvalue_bound(problem);
        let scale = if self.bounded && bound > 0.0 { 2.0 / bound } else { 1.0 };
        Ok(Box::new(Run {
            rows: (0..problem.contact_count() as u32).map(|contact| Row::new(problem, contact)).collect(),
            relaxation: scale * self.relaxation,
            bounded: self.bounded,
            r: r0.to_vec(),
            old_velocity: velocity.clone(),
            velocity,
            iterations: 0,
        }))
    }
}
