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
use pulp::{Arch, Simd, WithSimd};

/// A pass over the contacts or the grains of a block.
#[derive(Clone, Copy)]
pub(crate) enum Pass {
    Curvature,
    Step { length: f64, whole: bool },
    Gradient { length: f64, whole: bool },
    Turn { beta: f64 },
}

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
    /// M^-½ H p, in local indices; of grains that blocks share, each has the sum once they have met. Likewise what follows.
    y: Vec<Vector2<f64>>,
    /// M^-½ H r.
    y_r: Vec<Vector2<f64>>,
    /// What a step adds to M^-½ H r beyond α y.
    change: Vec<Vector2<f64>>,
    /// 1 over the number of blocks that have the grain, in local indices.
    share: Vec<f64>,
}

/// u where r > 0 or u > 0, else 0: the part of it that r ≥ 0 does not block.
#[inline]
#[expect(clippy::needless_bitwise_bool, reason = "no branch: which contacts are blocked is hard to predict")]
fn unblocked(r: f64, u: f64, value: f64) -> f64 {
    if (r > 0.0) | (u > 0.0) { value } else { 0.0 }
}

impl Block {
    /// The contacts of `subdomain`, in its local indices, from the impulses `r0`. `multiplicity` says of each grain of the
    /// problem how many blocks have it.
    pub(crate) fn new(
        problem: &ContactProblem,
        subdomain: &Subdomain,
        multiplicity: &[u32],
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
        let share = |grain: &u32| 1.0 / f64::from(multiplicity[*grain as usize]);
        let zeros = vec![Vector2::zeros(); subdomain.grains.len()];
        Self {
            b: each().map(|(contact, unit)| b[contact] / unit).collect(),
            r: each().map(|(contact, unit)| r0[contact] * unit).collect(),
            u: vec![0.0; contacts.len()],
            p: vec![0.0; contacts.len()],
            y: zeros.clone(),
            y_r: zeros.clone(),
            change: zeros,
            share: subdomain.grains.iter().map(share).collect(),
            contacts,
            columns,
            unit,
        }
    }

    /// Makes a pass, with the best instructions that the processor has: the same operations in the same order with any. Returns
    /// what the block adds to the scalar product that the pass is for.
    pub(crate) fn make(&mut self, pass: Pass) -> f64 {
        Arch::new().dispatch(Dispatched(self, pass))
    }

    /// What blocks have in common after the pass, or before it.
    pub(crate) fn shared(&mut self, pass: Pass) -> &mut [Vector2<f64>] {
        match pass {
            Pass::Step { .. } | Pass::Gradient { .. } => &mut self.change,
            Pass::Turn { .. } | Pass::Curvature => &mut self.y,
        }
    }

    /// The block's part of pᵗ W p = |y|².
    #[inline(always)]
    fn curvature(&self) -> f64 {
        self.y.iter().zip(&self.share).map(|(y, share)| share * y.norm_squared()).sum()
    }

    /// r = max(0, r + α p); `change` becomes the block's part of M^-½ H r, or only of what the maximum adds to r + α p.
    #[inline(always)]
    fn step(&mut self, length: f64, whole: bool) -> f64 {
        let change = &mut self.change[..];
        change.fill(Vector2::zeros());
        for ((column, p), r) in self.columns.iter().zip(&self.p).zip(&mut self.r) {
            let moved = *r + length * p;
            *r = non_negative(moved);
            if whole {
                column.push(*r, change);
            } else if moved < 0.0 {
                column.push(-moved, change);
            }
        }
        0.0
    }

    /// u = −(W r + b) after the step of the same `length`; returns the block's part of wᵗ W p, with w the part of u that is not
    /// blocked.
    #[inline(always)]
    fn gradient(&mut self, length: f64, whole: bool) -> f64 {
        if whole {
            self.y_r.copy_from_slice(&self.change);
        } else {
            for ((y_r, y), change) in self.y_r.iter_mut().zip(&self.y).zip(&self.change) {
                *y_r += length * y + change;
            }
        }
        let (y, y_r) = (&self.y[..], &self.y_r[..]);
        let mut sum = 0.0;
        for ((column, u), (b, r)) in self.columns.iter().zip(&mut self.u).zip(self.b.iter().zip(&self.r)) {
            *u = -(column.relative(y_r) + b);
            sum += unblocked(*r, *u, *u) * column.relative(y);
        }
        sum
    }

    /// p = w + β z, with z = p where w is not blocked; y becomes the block's part of M^-½ H p; returns that of uᵗ p.
    #[inline(always)]
    fn turn(&mut self, beta: f64) -> f64 {
        let y = &mut self.y[..];
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

struct Dispatched<'b>(&'b mut Block, Pass);

impl WithSimd for Dispatched<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self(block, pass) = self;
        match pass {
            Pass::Curvature => block.curvature(),
            Pass::Step { length, whole } => block.step(length, whole),
            Pass::Gradient { length, whole } => block.gradient(length, whole),
            Pass::Turn { beta } => block.turn(beta),
        }
    }
}
