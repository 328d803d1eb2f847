//! A block of contacts: what an iteration does with them, a pass at a time.
//!
//! With `unit` 1, the columns are those of M^-½ H and all vectors those of the reference. With `unit` √`W_αα` they are those
//! of H̃, r is √`W_αα` r, u and b are u/√`W_αα` and b/√`W_αα`: the plain method in these unknowns is the one
//! preconditioned by `W_D`, in which g = u/`W_αα` enters w only.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use contact::law::non_negative;
use contact::{Adjacency, Smooth, Visited};
use nalgebra::SVector;
use product::{Columns, Subdomain};
use pulp::{Arch, Simd, WithSimd};

/// A pass over a block, and the two sums that it is for. w is the part of u = −(W r + b) that r ≥ 0 does not block.
#[derive(Clone, Copy)]
pub(crate) enum Pass {
    /// pᵗ W p = |y|², with y = M^-½ H p.
    Curvature,
    /// r = max(0, r + α p) = r + α p + d, and u as if d were 0; wᵗ W p and −uᵗ d.
    Step { length: f64 },
    /// u with d; wᵗ W p and −uᵗ d + ½ dᵗ W d.
    Correct,
    /// M^-½ H r.
    Whole,
    /// u from M^-½ H r; wᵗ W p and, where w is not blocked, Σ b² + Σ (`W_αα` r)².
    Afresh,
    /// p = w + β z, with z = p where w is not blocked, else 0; uᵗ p and pᵗ p.
    Turn { beta: f64 },
}

/// Some contacts, with what the method knows of each.
pub(crate) struct Block<const D: usize> {
    columns: Columns<Smooth<D>>,
    b: Vec<f64>,
    r: Vec<f64>,
    /// u = −(W r + b), minus the gradient of q.
    u: Vec<f64>,
    /// r and u before the step.
    r_before: Vec<f64>,
    u_before: Vec<f64>,
    /// The direction.
    p: Vec<f64>,
    /// M^-½ H p, in local indices; of grains that blocks share, each has the sum after it has been received.
    y: Vec<SVector<f64, D>>,
    /// M^-½ H d, or of all r, likewise; 0 when it has been used.
    change: Vec<SVector<f64, D>>,
    /// True where the maximum added anything in the last step.
    added: bool,
    /// Contribution of the block to the sums that the last pass was for.
    parts: [f64; 2],
    adjacency: Adjacency,
}

/// u where r > 0 or u > 0, else 0: the part of it that r ≥ 0 does not block.
#[inline]
#[expect(clippy::needless_bitwise_bool, reason = "no branch: which contacts are blocked is hard to predict")]
fn unblocked(r: f64, u: f64, value: f64) -> f64 {
    if (r > 0.0) | (u > 0.0) { value } else { 0.0 }
}

impl<const D: usize> Block<D> {
    /// The contacts of `subdomain` as columns, from the impulses `r0`.
    pub(crate) fn new(columns: Columns<Smooth<D>>, subdomain: &Subdomain, b: &[f64], r0: &[f64]) -> Self {
        let of_contacts = vec![0.0; subdomain.contacts.len()];
        let zeros = vec![SVector::zeros(); subdomain.grains.len()];
        Self {
            b: columns.units().map(|(contact, unit)| b[contact] / unit).collect(),
            r: columns.units().map(|(contact, unit)| r0[contact] * unit).collect(),
            u: of_contacts.clone(),
            r_before: of_contacts.clone(),
            u_before: of_contacts.clone(),
            p: of_contacts,
            y: zeros.clone(),
            change: zeros,
            added: false,
            parts: [0.0; 2],
            adjacency: Adjacency::new(subdomain.ends.iter().copied(), subdomain.grains.len()),
            columns,
        }
    }

    /// Makes a pass, with the best instructions that the processor has: the same operations in the same order with any.
    pub(crate) fn make(&mut self, pass: Pass) {
        self.parts = Arch::new().dispatch(Dispatched(self, pass));
    }

    /// Returns the columns, and the values of grains that blocks share, after the pass or before it.
    pub(crate) fn shared(&mut self, pass: Pass) -> (&Columns<Smooth<D>>, &mut [SVector<f64, D>]) {
        let shared = match pass {
            Pass::Step { .. } | Pass::Correct | Pass::Whole | Pass::Afresh => &mut self.change,
            Pass::Turn { .. } | Pass::Curvature => &mut self.y,
        };
        (&self.columns, shared)
    }

    /// Returns the contribution of the block to the sums that the last pass was for.
    pub(crate) fn parts(&self) -> [f64; 2] {
        self.parts
    }

    /// Reports whether the maximum added anything in the last step: then a correction must follow.
    pub(crate) fn added(&self) -> bool {
        self.added
    }

    /// Σ `W_αα` (r − r⁺)² = Σ min(√`W_αα` r, v/√`W_αα`)², in eight sums that do not wait for each other.
    pub(crate) fn squared_left(&self) -> f64 {
        let left = |r: f64, u: f64| if -u < r { -u } else { r };
        let mut sums = [0.0; 8];
        if self.columns.is_scaled {
            let ((r, last_r), (u, last_u)) = (self.r.as_chunks::<8>(), self.u.as_chunks::<8>());
            for (r, u) in r.iter().zip(u) {
                for k in 0..8 {
                    let left = left(r[k], u[k]);
                    sums[k] += left * left;
                }
            }
            for (r, u) in last_r.iter().zip(last_u) {
                sums[0] += left(*r, *u) * left(*r, *u);
            }
        } else {
            for (k, column) in self.columns.scaled.iter().enumerate() {
                let w = column.squared();
                let left = left(w * self.r[k], self.u[k]);
                sums[k % 8] += left * left / w;
            }
        }
        sums.iter().sum()
    }

    /// r and u become what they were before the step.
    pub(crate) fn withdraw(&mut self) {
        std::mem::swap(&mut self.r, &mut self.r_before);
        std::mem::swap(&mut self.u, &mut self.u_before);
    }

    /// Returns the longest step that keeps r + α p above 0: the least −r/p of the contacts with p < 0, if there are any.
    pub(crate) fn reach(&self) -> Option<f64> {
        let falling = self.r.iter().zip(&self.p).filter(|(_, p)| **p < 0.0);
        falling.map(|(r, p)| -r / p).reduce(f64::min)
    }

    #[inline(always)]
    fn curvature(&self) -> f64 {
        self.y.iter().zip(&self.columns.share).map(|(y, share)| share * y.norm_squared()).sum()
    }

    #[inline(always)]
    fn step(&mut self, length: f64) -> [f64; 2] {
        std::mem::swap(&mut self.r, &mut self.r_before);
        std::mem::swap(&mut self.u, &mut self.u_before);
        let (y, change) = (&self.y[..], &mut self.change[..]);
        let before = self.r_before.iter().zip(&self.u_before);
        let after = self.r.iter_mut().zip(&mut self.u);
        let (mut added, mut product, mut uphill) = (false, 0.0, 0.0);
        for ((column, p), ((r_before, u_before), (r, u))) in
            self.columns.scaled.iter().zip(&self.p).zip(before.zip(after))
        {
            let of_p = column.relative(y);
            let moved = r_before + length * p;
            *r = non_negative(moved);
            *u = u_before - length * of_p;
            if moved < 0.0 {
                column.push(-moved, change);
                uphill += *u * moved;
                added = true;
            }
            product += unblocked(*r, *u, *u) * of_p;
        }
        self.added = added;
        [product, uphill]
    }

    #[inline(always)]
    fn correct(&mut self) -> [f64; 2] {
        let [mut product, mut uphill] = self.parts;
        for (grain, (change, share)) in self.change.iter_mut().zip(&self.columns.share).enumerate() {
            if *change != SVector::<f64, D>::zeros() {
                uphill += 0.5 * share * change.norm_squared();
                for k in self.adjacency.around(grain) {
                    let k = *k as usize;
                    let (column, r, u) = (&self.columns.scaled[k], self.r[k], &mut self.u[k]);
                    let before = unblocked(r, *u, *u);
                    *u -= column.relative_of(grain as u32, change);
                    product += (unblocked(r, *u, *u) - before) * column.relative(&self.y);
                }
                *change = SVector::zeros();
            }
        }
        [product, uphill]
    }

    #[inline(always)]
    fn whole(&mut self) {
        for (column, r) in self.columns.scaled.iter().zip(&self.r) {
            column.push(*r, &mut self.change);
        }
    }

    #[inline(always)]
    fn afresh(&mut self) -> [f64; 2] {
        let (mut product, mut squared_size) = (0.0, 0.0);
        for ((column, u), (b, r)) in
            self.columns.scaled.iter().zip(&mut self.u).zip(self.b.iter().zip(&self.r))
        {
            *u = -(column.relative(&self.change) + b);
            product += unblocked(*r, *u, *u) * column.relative(&self.y);
            let pressed = column.squared() * r;
            squared_size += unblocked(*r, *u, b * b + pressed * pressed);
        }
        self.change.fill(SVector::zeros());
        [product, squared_size]
    }

    #[inline(always)]
    fn turn(&mut self, beta: f64) -> [f64; 2] {
        let y = &mut self.y[..];
        y.fill(SVector::zeros());
        let (mut descent, mut squared) = (0.0, 0.0);
        for ((column, p), (r, u)) in
            self.columns.scaled.iter().zip(&mut self.p).zip(self.r.iter().zip(&self.u))
        {
            *p = unblocked(*r, *u, u + beta * *p);
            column.push(*p, y);
            descent += u * *p;
            squared += *p * *p;
        }
        [descent, squared]
    }

    /// Puts the impulses in the problem's order (N·s).
    pub(crate) fn impulses(&self, impulses: &mut [f64]) {
        self.columns.unscale(&self.r, impulses);
    }
}

/// Pass that is compiled for the processor's instructions. A closure would not be inlined there.
struct Dispatched<'b, const D: usize>(&'b mut Block<D>, Pass);

impl<const D: usize> WithSimd for Dispatched<'_, D> {
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [f64; 2] {
        let Self(block, pass) = self;
        match pass {
            Pass::Curvature => [block.curvature(), 0.0],
            Pass::Step { length } => block.step(length),
            Pass::Correct => block.correct(),
            Pass::Whole => {
                block.whole();
                [0.0; 2]
            }
            Pass::Afresh => block.afresh(),
            Pass::Turn { beta } => block.turn(beta),
        }
    }
}
