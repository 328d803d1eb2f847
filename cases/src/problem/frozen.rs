//! Frozen problems: the contact problem of a chosen time step, so that every method meets the same input.

use contact::{Discs, Mechanics, Packing};

/// The contact problem of one time step, with what a method does not need but a reader does.
#[derive(Clone, Debug, PartialEq)]
pub struct Frozen<M: Mechanics = Discs> {
    /// Name of the problem.
    pub name: String,
    /// Source of the problem, in a sentence.
    pub source: String,
    /// h (s).
    pub time_step: f64,
    /// Radius of each grain (m).
    pub radius: Vec<f64>,
    /// Gap of each contact at detection (m).
    pub gap: Vec<f64>,
    /// The problem itself.
    pub problem: Packing<M>,
    /// Impulses of the time step before, where the contact existed, a flat list (N·s); empty for none.
    pub start: Vec<f64>,
    /// Number of time steps before it whose solve did not converge; none at the first, or if it is not known.
    pub missed_before: Option<u64>,
}

impl<M: Mechanics> Frozen<M> {
    /// The impulses to begin from: those of the time step before if `warm`, else none (N·s).
    pub fn start(&self, warm: bool) -> Vec<f64> {
        if warm && !self.start.is_empty() {
            self.start.clone()
        } else {
            vec![0.0; self.problem.impulse_count()]
        }
    }
}
