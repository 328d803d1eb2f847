//! Counters of the work of a method.

use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

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
    /// Multiply-adds of the factorisations; 0 where a library does not tell them.
    pub factorisation_multiply_adds: u64,
}

impl Work {
    /// Each count by its name in files.
    pub fn named(&self) -> [(&'static str, u64); 6] {
        [
            ("contact_updates", self.contact_updates),
            ("delassus_products", self.delassus_products),
            ("interface_values", self.interface_values),
            ("triangular_solve_entries", self.triangular_solve_entries),
            ("factorisations", self.factorisations),
            ("factorisation_multiply_adds", self.factorisation_multiply_adds),
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
        self.factorisation_multiply_adds += other.factorisation_multiply_adds;
    }
}
