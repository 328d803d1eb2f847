//! The contacts in units in which M and the diagonal of W are 1: neither masses nor units enter the numerics.

use contact::{ContactProblem, Smooth};
use nalgebra::SVector;

/// A row of H̃ᵗ = `W_D`^(−½) Hᵗ M^(−½), of length 1: the contact as a constraint on y.
pub(crate) struct Constraint<const D: usize> {
    candidate: (usize, SVector<f64, D>),
    antagonist: Option<(usize, SVector<f64, D>)>,
    /// √`W_αα` (kg^(−½)): r̃ = r √`W_αα` and ṽ = v / √`W_αα` are both in √J.
    pub(crate) root: f64,
}

impl<const D: usize> Constraint<D> {
    pub(crate) fn all(problem: &ContactProblem<Smooth<D>>) -> Vec<Self> {
        let roots = problem.delassus_diagonal().into_iter().map(f64::sqrt);
        problem
            .contacts()
            .iter()
            .zip(roots)
            .map(|(contact, root)| {
                let end = |grain: u32, sign: f64| {
                    let grain = grain as usize;
                    (grain, contact.normal * (sign / (problem.mass()[grain].sqrt() * root)))
                };
                let candidate = end(contact.candidate, 1.0);
                Self { candidate, antagonist: contact.antagonist.map(|j| end(j, -1.0)), root }
            })
            .collect()
    }

    /// Column and value of each entry; grain i has the columns D i to D i + D − 1.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        let ends = std::iter::once(self.candidate).chain(self.antagonist);
        ends.flat_map(|(grain, n)| (0..D).map(move |axis| (D * grain + axis, n[axis])))
    }
}
