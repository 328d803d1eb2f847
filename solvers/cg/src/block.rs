//! A block of contacts: what an iteration does with them, a pass at a time.
//!
//! With `unit` 1, the columns are those of M^-½ H and all vectors those of the reference. With `unit` √`W_αα` they are those
//! of H̃, r is √`W_αα` r, u and b are u/√`W_αα` and b/√`W_αα`: the plain method in these unknowns is the one
//! preconditioned by `W_D`, in which g = u/`W_αα` enters w only.

use contact::ContactProblem;
use contact::law::non_negative;
use contact::scaled::{ScaledContact, inverse_masses};
use nalgebra::Vector2;
use partition::Subdomain;

/// Some contacts, with what the method knows of each.
pub(crate) struct Block {
    /// The problem's contact of each column.
    contacts: Vec<u32>,
    columns: Vec<ScaledContact>,
    unit: Vec<f64>,
    b: Vec<f64>,
    r: Vec<f64>,
    /// u = −(W r + b), minus the gradient of q.
    u: Vec<f64>,
    /// The direction.
    p: Vec<f64>,
    /// W p.
    w_p: Vec<f64>,
}

/// u where r > 0 or u > 0, else 0: the part of it that r ≥ 0 does not block.
#[inline]
#[expect(clippy::needless_bitwise_bool, reason = "no branch: which contacts are blocked is hard to predict")]
fn unblocked(r: f64, u: f64, value: f64) -> f64 {
    if (r > 0.0) | (u > 0.0) { value } else { 0.0 }
}

impl Block {
    /// The contacts of `subdomain`, in its local indices, from the impulses `r0`.
    pub(crate) fn new(
        problem: &ContactProblem,
        subdomain: &Subdomain,
        preconditioned: bool,
        b: &[f64],
        r0: &[f64],
    ) -> Self {
        let column = |k: usize| {
            let contact = &problem.contacts()[subdomain.contacts[k] as usize];
            let (inverse_mass, root) =
                inverse_masses(contact.ends(), |grain| 1.0 / problem.mass()[grain as usize]);
            let unit = if preconditioned { root } else { 1.0 };
            let ends = (subdomain.candidate[k], subdomain.antagonist[k]);
            (ScaledContact::new(ends, contact.normal, inverse_mass, unit), unit)
        };
        let contacts = subdomain.contacts.clone();
        let (columns, unit): (Vec<_>, Vec<f64>) = (0..contacts.len()).map(column).unzip();
        let each = || contacts.iter().map(|contact| *contact as usize).zip(&unit);
        Self {
            b: each().map(|(contact, unit)| b[contact] / unit).collect(),
            r: each().map(|(contact, unit)| r0[contact] * unit).collect(),
            u: vec![0.0; contacts.len()],
            p: vec![0.0; contacts.len()],
            w_p: vec![0.0; contacts.len()],
            contacts,
            columns,
            unit,
        }
    }

    /// W p from y = M^-½ H p; returns the block's part of pᵗ W p.
    pub(crate) fn curvature(&mut self, y: &[Vector2<f64>]) -> f64 {
        let mut sum = 0.0;
        for ((column, p), w_p) in self.columns.iter().zip(&self.p).zip(&mut self.w_p) {
            *w_p = column.relative(y);
            sum += p * *w_p;
        }
        sum
    }

    /// r = max(0, r + α p), and y = M^-½ H r; there is nothing to sum.
    pub(crate) fn step(&mut self, length: f64, y: &mut [Vector2<f64>]) -> f64 {
        y.fill(Vector2::zeros());
        for ((column, p), r) in self.columns.iter().zip(&self.p).zip(&mut self.r) {
            *r = non_negative(*r + length * p);
            column.push(*r, y);
        }
        0.0
    }

    /// u = −(W r + b) from y = M^-½ H r; returns the block's part of wᵗ W p, with w the part of u that is not blocked.
    pub(crate) fn gradient(&mut self, y: &[Vector2<f64>]) -> f64 {
        let mut sum = 0.0;
        let known = self.b.iter().zip(&self.r).zip(&self.w_p);
        for ((column, u), ((b, r), w_p)) in self.columns.iter().zip(&mut self.u).zip(known) {
            *u = -(column.relative(y) + b);
            sum += unblocked(*r, *u, *u) * w_p;
        }
        sum
    }

    /// p = w + β z, with z = p where w is not blocked, and y = M^-½ H p; returns the block's part of uᵗ p.
    pub(crate) fn turn(&mut self, beta: f64, y: &mut [Vector2<f64>]) -> f64 {
        y.fill(Vector2::zeros());
        let mut sum = 0.0;
        for ((column, p), (r, u)) in self.columns.iter().zip(&mut self.p).zip(self.r.iter().zip(&self.u)) {
            *p = unblocked(*r, *u, u + beta * *p);
            column.push(*p, y);
            sum += u * *p;
        }
        sum
    }

    /// Puts the impulses in the problem's order (N·s).
    pub(crate) fn impulses(&self, impulses: &mut [f64]) {
        for ((r, unit), contact) in self.r.iter().zip(&self.unit).zip(&self.contacts) {
            impulses[*contact as usize] = r / unit;
        }
    }
}
