//! Search directions that adapt: a few times, all are scaled so that impulses and velocities change alike.
//!
//! With κ below its best value the slow changes of the iterates are those of the whole packing, in which impulses change
//! much and velocities little; above it, those between neighbours, the other way round. Where both are equally slow,
//! κ = ‖Δr‖/‖Δv‖, with r/√M and √M V for contacts (M = 1/W_αα) and for the copies of boundary grains alike: a form of
//! the residual balancing of ADMM (Boyd et al. 2011, Found. Trends Mach. Learn. 3(1), §3.4.1).
//!
//! On one subdomain Δv = W Δr. Where impulses grow against each other, as between walls that close, W Δr vanishes and the
//! quotient is round-off: it is not believed, and κ stays among the values that can be the best of some set of closed
//! contacts, see [`Balance::limits`].

use crate::directions::Directions;
use crate::stages::Stages;
use crate::subdomain::{Iterate, Latin};
use nalgebra::SVector;
use partition::Team;
use std::ops::RangeInclusive;

/// Iterations after which directions are scaled. In between, the fast part of the change dies out.
const ROUNDS: [u64; 5] = [20, 40, 80, 160, 320];
/// A change of direction below this factor is not worth a factorisation.
const WORTH: f64 = 1.25;
/// Round-off of an iterate over the size of its terms, at κ = 0 (–).
const ROUND_OFF: f64 = 1e-14;

/// The iterates of one iteration, to compare those of the next with.
pub(crate) struct Balance {
    previous: Vec<Iterate>,
    current: Vec<Iterate>,
    /// Λ ≥ λmax(W_D⁻¹ W) (–).
    eigenvalue_bound: f64,
}

impl Balance {
    /// With Λ of the whole problem, and room for the iterates of so many unknowns of contacts, and components of boundary grains.
    pub(crate) fn new<M: Stages>(scaled_delassus_bound: f64, iterates: usize, kappa_t: f64) -> Self {
        let room = || Vec::with_capacity(iterates);
        // A tangent's l is κ_t times that of W_D.
        let steepest = if M::HAS_FRICTION { kappa_t.max(1.0) } else { 1.0 };
        let eigenvalue_bound = steepest * scaled_delassus_bound;
        Self { previous: room(), current: room(), eigenvalue_bound }
    }

    /// Sees the linear stage of an iteration; returns the factor by which to scale, at the end of a round.
    pub(crate) fn factor<M, const D: usize>(
        &mut self,
        iteration: u64,
        kappa: f64,
        subdomains: &[Latin<M, D>],
        team: &Team,
    ) -> Option<f64>
    where
        M: Stages<Velocity = SVector<f64, D>>,
    {
        if !ROUNDS.iter().any(|round| *round == iteration || *round == iteration + 1) {
            return None;
        }
        std::mem::swap(&mut self.previous, &mut self.current);
        self.current.clear();
        self.current.extend(subdomains.iter().flat_map(Latin::linear_iterate));
        if !ROUNDS.contains(&iteration) {
            return None;
        }
        // M + H l⁻ Hᵗ amplifies the round-off of v by the root of its condition, at most 1 + κ Λ.
        let round_off = ROUND_OFF * (1.0 + kappa * self.eigenvalue_bound).sqrt();
        let changes = || self.current.iter().zip(&self.previous);
        let of_r = || changes().map(|(i, before)| (i.r - before.r, i.terms_of_r));
        let of_v = || changes().map(|(i, before)| (i.v - before.v, i.terms_of_v));
        // One rank after the other goes on with the sums, so that none changes a bit.
        let sums = team.in_turn(vec![0.0; 4], |sums| {
            let (of_r, of_v) = (squares((sums[0], sums[1]), of_r()), squares((sums[2], sums[3]), of_v()));
            sums.copy_from_slice(&[of_r.0, of_r.1, of_v.0, of_v.1]);
        });
        let impulses = believed((sums[0], sums[1]), round_off)?;
        let velocities = believed((sums[2], sums[3]), round_off)?;
        let limits = self.limits();
        let factor = (impulses / velocities).clamp(*limits.start(), *limits.end()) / kappa;
        let worth = factor.is_finite() && !(1.0 / WORTH..=WORTH).contains(&factor);
        worth.then_some(factor)
    }

    /// The κ that can be the best, 1/√(λ̃min λ̃max) over the spectrum of `W_D^{-½} W W_D^{-½}` on some closed contacts.
    ///
    /// The diagonal of that matrix is 1, so λ̃min ≤ 1 ≤ λ̃max ≤ Λ and κ ≥ 1/√Λ. Eigenvalues below ε λ̃max are 0 but for
    /// round-off, so κ ≤ 1/(√ε λ̃max); Λ for λ̃max keeps half of the digits of M in M + H l⁻ Hᵗ as well.
    pub(crate) fn limits(&self) -> RangeInclusive<f64> {
        let bound = self.eigenvalue_bound.max(1.0);
        1.0 / bound.sqrt()..=1.0 / (f64::EPSILON.sqrt() * bound)
    }
}

/// Sums of squares that go on with those of changes, and of the sizes of the terms that each is the difference of.
fn squares(sums: (f64, f64), changes: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    changes.fold(sums, |(change, terms), (of, size)| (change + of * of, terms + size * size))
}

/// The norm of changes whose sums of squares these are, with those of their terms; `None` if it is round-off.
fn believed((change, terms): (f64, f64), round_off: f64) -> Option<f64> {
    (change.sqrt() > round_off * terms.sqrt()).then(|| change.sqrt())
}

impl Directions {
    /// All four, `factor` times.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self {
            l_minus: factor * self.l_minus,
            l_plus: factor * self.l_plus,
            d_minus: factor * self.d_minus,
            d_plus: factor * self.d_plus,
        }
    }
}
