//! What a method is: a value that holds its settings and starts on a problem; an iteration that advances.

use crate::problem::ContactProblem;
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;
use thiserror::Error;

/// A method with its parameters, not yet bound to a problem. The value *is* the settings.
pub trait Solver: Send + Sync {
    /// Binds the method to a problem from the impulses `r0` (N·s, one per contact, ≥ 0).
    ///
    /// # Errors
    /// Names the setting that has no meaning, alone or for this problem.
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError>;
}

/// One run of a method on one problem. Knows no tolerance, no clock, no file.
pub trait Iteration {
    /// One iteration of the method.
    fn advance(&mut self);

    /// Writes the impulses (N·s) in the problem's contact order.
    fn impulses(&self, r: &mut [f64]);

    /// Greatest |`V_E` − V̄| over the copies of the boundary grains before the last gluing (m/s); 0 without copies.
    fn velocity_jump(&self) -> f64 {
        0.0
    }

    /// Whether no further iteration will bring the impulses nearer to a solution: the run then ends.
    fn stalled(&self) -> bool {
        false
    }

    /// What the method works with beside its settings: a value that they leave open, by the setting's name; and, where
    /// subdomains work at the same time, `critical_path`: the multiply-adds of an iteration on the longest of them.
    fn derived(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// Exact counts since `start`.
    fn work(&self) -> Work;
}

/// Counted work: the same on any machine, with any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Work {
    /// Contacts updated by the law.
    pub contact_updates: u64,
    /// Products W p.
    pub delassus_products: u64,
    /// Velocity components that copies sent to the interface.
    pub interface_values: u64,
    /// Entries of triangular factors that solves went through, two passes per solve.
    pub triangular_solve_entries: u64,
    /// Matrices factorised.
    pub factorisations: u64,
}

impl Work {
    /// Each count by its name in files.
    pub fn named(&self) -> [(&'static str, u64); 5] {
        [
            ("contact_updates", self.contact_updates),
            ("delassus_products", self.delassus_products),
            ("interface_values", self.interface_values),
            ("triangular_solve_entries", self.triangular_solve_entries),
            ("factorisations", self.factorisations),
        ]
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.contact_updates += other.contact_updates;
        self.delassus_products += other.delassus_products;
        self.interface_values += other.interface_values;
        self.triangular_solve_entries += other.triangular_solve_entries;
        self.factorisations += other.factorisations;
    }
}

/// A number in an error: in full, or with an exponent where that is long.
pub fn shown(x: f64) -> String {
    let (full, exponent) = (format!("{x}"), format!("{x:e}"));
    if full.len() > 12 && exponent.len() < full.len() { exponent } else { full }
}

/// Why a method cannot start: the setting, its value, what would be accepted.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{key}` is {value}: it must be {expected}")]
pub struct SetupError {
    /// Name of the setting.
    pub key: &'static str,
    /// Its value.
    pub value: String,
    /// What would be accepted.
    pub expected: String,
}

impl SetupError {
    /// The error of a setting `key` whose `value` is not as `expected`.
    pub fn new(key: &'static str, value: impl std::fmt::Display, expected: impl Into<String>) -> Self {
        let value = value.to_string();
        // 1e200 has 201 digits; none that must stay.
        let long = if value.len() > 24 { value.parse().ok() } else { None };
        Self { key, value: long.map_or(value, shown), expected: expected.into() }
    }

    /// Accepts a positive finite value.
    ///
    /// # Errors
    /// Names `key` otherwise.
    pub fn unless_positive(key: &'static str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::new(key, value, "positive and finite"))
        }
    }

    /// Accepts a warm start with one admissible impulse per contact.
    ///
    /// # Errors
    /// Names the first impulse that is not.
    pub fn unless_admissible(problem: &ContactProblem, r0: &[f64]) -> Result<(), Self> {
        if r0.len() != problem.contact_count() {
            let expected = format!("of one impulse per contact, {} in all", problem.contact_count());
            return Err(Self::new("start", format!("{} impulses", r0.len()), expected));
        }
        match r0.iter().position(|r| !(*r >= 0.0 && r.is_finite())) {
            None => Ok(()),
            Some(index) => {
                let value = format!("{} at contact {index}", shown(r0[index]));
                Err(Self::new("start", value, "finite and not negative"))
            }
        }
    }
}
