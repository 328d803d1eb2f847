//! Counters of the work of a method.

use serde::{Deserialize, Serialize};

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

    /// Returns the work with the counts in the order of [`Work::named`].
    pub fn of(counts: [u64; 6]) -> Self {
        let [contact_updates, delassus_products, interface_values, triangular_solve_entries, ..] = counts;
        let [.., factorisations, factorisation_multiply_adds] = counts;
        Self {
            contact_updates,
            delassus_products,
            interface_values,
            triangular_solve_entries,
            factorisations,
            factorisation_multiply_adds,
        }
    }
}

/// Adds records of one type field by field.
#[macro_export]
macro_rules! added {
    ($record:ty: $($field:ident),+) => {
        impl std::ops::AddAssign for $record {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)+
            }
        }
    };
}

added!(Work: contact_updates, delassus_products, interface_values, triangular_solve_entries, factorisations, factorisation_multiply_adds);
