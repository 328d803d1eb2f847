//! NSGS on a stored W: one contact after the other, each solved exactly with all others kept.

use crate::LocalProblem;
use crate::exact::{line, plane, space};
use nalgebra::{SMatrix, SVector};

/// Sweeps in the order of the problem's contacts.
#[derive(Clone, Debug)]
pub struct Nsgs<'p> {
    problem: &'p LocalProblem,
    r: Vec<f64>,
}

/// The law at one contact, from `W_αα`, the relative velocity without its own impulse, and μ.
type Exact<const D: usize> = fn(&SMatrix<f64, D, D>, &SVector<f64, D>, f64) -> SVector<f64, D>;

impl<'p> Nsgs<'p> {
    /// From r = 0.
    pub fn new(problem: &'p LocalProblem) -> Self {
        Self { problem, r: vec![0.0; problem.q().len()] }
    }

    /// One update of each contact.
    pub fn sweep(&mut self) {
        match self.problem.dimension() {
            1 => self.sweep_with(line),
            2 => self.sweep_with(plane),
            _ => self.sweep_with(space),
        }
    }

    fn sweep_with<const D: usize>(&mut self, exact: Exact<D>) {
        let problem = self.problem;
        for contact in 0..problem.contact_count() {
            let v = problem.velocity_at(&self.r, contact, true);
            let r = exact(&problem.own(contact), &v, problem.friction()[contact]);
            self.r[D * contact..D * (contact + 1)].copy_from_slice(r.as_slice());
        }
    }

    /// r (N·s), normal first at each contact.
    pub fn impulses(&self) -> &[f64] {
        &self.r
    }
}
