//! Projected Jacobi: the sweep of NSGS with every relative velocity taken at the old impulses.
//!
//! Converges for ω < 2/λmax(`W_D`⁻¹ W) only; `bounded` keeps it there. Cost of an iteration: that of a sweep, and a copy of the velocities.

use analysis::scaled_delassus_bound;
use contact::scaled::scaled_velocity;
use contact::sweep::Row;
use contact::{Contact, Iteration, Packing, SetupError, Solver, Work, law};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of projected Jacobi.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
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
    /// s = √`W_αα` r (√J).
    s: Vec<f64>,
    /// √`W_αα` (kg^-½).
    unit: Vec<f64>,
    /// M^½ V of the impulses.
    y: Vec<Vector2<f64>>,
    /// That of the iteration before, from which all v are taken.
    old_y: Vec<Vector2<f64>>,
    iterations: u64,
}

impl Iteration for Run {
    fn advance(&mut self) {
        self.old_y.copy_from_slice(&self.y);
        for (row, s) in self.rows.iter().zip(&mut self.s) {
            // v = Hᵗ V_old + c;  r⁺ = max(0, r − ω v/W_αα);  V ← V + M⁻¹ h_α (r⁺ − r)
            let change = law::change(*s, row.relative(&self.old_y), self.relaxation);
            row.push(change, &mut self.y);
            *s += change;
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        for ((r, s), unit) in r.iter_mut().zip(&self.s).zip(&self.unit) {
            *r = s / unit;
        }
    }

    fn derived(&self) -> Vec<(&'static str, f64)> {
        if self.bounded { vec![("relaxation", self.relaxation)] } else { Vec::new() }
    }

    fn work(&self) -> Work {
        Work { contact_updates: self.iterations * self.s.len() as u64, ..Work::default() }
    }
}

impl Solver for Jacobi {
    fn start<'p>(&self, problem: &'p Packing, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let inverse_mass = |grain: u32| 1.0 / problem.mass()[grain as usize];
        let row = |contact: &Contact| Row::new(contact, contact.ends(), inverse_mass);
        let (rows, unit): (Vec<Row>, Vec<f64>) = problem.contacts().iter().map(row).unzip();
        let y = scaled_velocity(problem, r0);
        let bound = scaled_delassus_bound(problem);
        let scale = if self.bounded && bound > 0.0 { 2.0 / bound } else { 1.0 };
        Ok(Box::new(Run {
            rows,
            relaxation: scale * self.relaxation,
            bounded: self.bounded,
            s: r0.iter().zip(&unit).map(|(r, unit)| r * unit).collect(),
            unit,
            old_y: y.clone(),
            y,
            iterations: 0,
        }))
    }
}
