//! What is counted of the work of a method, and how much work is worth a thread.

use serde::Serialize;

/// Counted work: the same on any machine, with any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
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

/// A thread that sleeps takes some tens of microseconds to wake (ns).
const WORTH_A_THREAD: usize = 100_000;

/// How many of some items stay together on one thread, for `with_min_len` of rayon: all, where they take less than a
/// tenth of a millisecond in all. Only time depends on it.
pub fn together(nanoseconds: usize) -> usize {
    if nanoseconds < WORTH_A_THREAD { usize::MAX } else { 1 }
}
