//! Search directions that adapt: a few times, all are scaled so that impulses and velocities change alike.
//!
//! With κ below its best value the slow changes of the iterates are those of the whole packing, in which impulses change
//! much and velocities little; above it, those between neighbours, the other way round. Where both are equally slow,
//! κ = ‖Δr‖/‖Δv‖, with r/√M and √M V for contacts (M = 1/W_αα) and for the copies of boundary grains alike: a form of
//! the residual balancing of ADMM (Boyd et al. 2011, Found. Trends Mach. Learn. 3(1), §3.4.1).

use crate::directions::Directions;
use crate::subdomain::Latin;

/// Iterations after which directions are scaled. In between, the fast part of the change dies out.
const ROUNDS: [u64; 5] = [20, 40, 80, 160, 320];
/// A change of direction below this factor is not worth a factorisation.
const WORTH: f64 = 1.25;

/// The iterates of one iteration, to compare those of the next with.
#[derive(Default)]
pub(crate) struct Balance {
    previous: Vec<(f64, f64)>,
    current: Vec<(f64, f64)>,
}

impl Balance {
    /// Sees the linear stage of an iteration; returns the factor by which to scale, at the end of a round.
    pub(crate) fn factor(&mut self, iteration: u64, kappa: f64, subdomains: &[Latin]) -> Option<f64> {
        if !ROUNDS.iter().any(|round| *round == iteration || *round == iteration + 1) {
            return None;
        }
        std::mem::swap(&mut self.previous, &mut self.current);
        self.current.clear();
        self.current.extend(subdomains.iter().flat_map(Latin::linear_iterate));
        if !ROUNDS.contains(&iteration) {
            return None;
        }
        let (mut impulses, mut velocities) = (0.0, 0.0);
        for ((r, v), (r_before, v_before)) in self.current.iter().zip(&self.previous) {
            impulses += (r - r_before) * (r - r_before);
            velocities += (v - v_before) * (v - v_before);
        }
        let factor = (impulses / velocities).sqrt() / kappa;
        let worth = factor.is_finite() && !(1.0 / WORTH..=WORTH).contains(&factor);
        worth.then_some(factor)
    }
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
