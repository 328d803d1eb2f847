//! Nesterov's extrapolation over the sweeps of any mechanics, with a restart that leaves slack.
//!
//! A sweep z = S(y) of Gauss-Seidel is made from an extrapolated point y of impulses, which may lie outside the cones: the sweep
//! projects it. From r0, with lag q and slack ρ, and x = y = r0, j = 0, m = ∞ to begin with:
//!
//! > z = S(y);  g = y − z;  d = z − x <br>
//! > if |g|² > ρ² m or ⟨g, d⟩ > 0:  j = 0, β = 0, m = |g|² (restart) <br>
//! > else:  j ← j + 1, β = j/(j + q), m = min(m, |g|²) <br>
//! > y = z + β (z − x);  x = z
//!
//! Norm and product are those of D = diag(`W_αα`), Euclidean in s = √`W_αα` r. V is affine in r, so velocities are extrapolated by the
//! same β and no product with W is needed. z is measured and handed back.
//!
//! Y. Nesterov, A method of solving a convex programming problem with convergence rate O(1/k²), Soviet Math. Dokl. 27 (1983) 372-376;
//! restarts after B. O'Donoghue and E. Candès, Adaptive restart for accelerated gradient schemes, Found. Comput. Math. 15 (2015)
//! 715-732. Without friction the sweep that follows a restart is one of plain NSGS, so q(z) ≤ q(y) there. With Coulomb's law q is no
//! merit function and nothing is proved; ρ > 1 is a finding.

use crate::error::SetupError;
use crate::mechanics::{Mechanics, Vector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Extrapolation over the iterations of a method of sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Acceleration {
    /// Every iteration begins where the last one ended.
    #[default]
    None,
    /// Nesterov's, with restarts.
    Nesterov,
}

impl Acceleration {
    /// The momentum, if any, with the lag q and the slack ρ (–).
    ///
    /// # Errors
    /// q ≤ 0, or ρ < 1, which would restart at every sweep.
    pub fn momentum(self, lag: f64, slack: f64) -> Result<Option<Momentum>, SetupError> {
        SetupError::unless_positive("lag", lag)?;
        SetupError::unless(slack >= 1.0, "slack", slack, "at least 1")?;
        let momentum = Momentum { lag, slack, sweeps: 0.0, least: f64::INFINITY, factor: 0.0 };
        Ok((self == Self::Nesterov).then_some(momentum))
    }
}

/// q of β = j/(j + q) (–).
pub const LAG: f64 = 3.0;

/// ρ (–).
pub const SLACK: f64 = 1.2;

/// The factor β of the extrapolation, from sweep to sweep.
#[derive(Clone, Copy, Debug)]
pub struct Momentum {
    lag: f64,
    slack: f64,
    sweeps: f64,
    least: f64,
    factor: f64,
}

impl Momentum {
    /// Returns β (–), with which the next sweep begins.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Reports a restart: velocities are then made anew from the impulses, since their round-off is extrapolated too.
    pub fn has_restarted(&self) -> bool {
        self.sweeps == 0.0 && self.least < f64::INFINITY
    }

    /// Takes |g|² and ⟨g, d⟩ (J) of a sweep.
    pub fn turn(&mut self, [squared, along]: [f64; 2]) {
        if squared > self.slack * self.slack * self.least || along > 0.0 {
            (self.sweeps, self.least) = (0.0, squared);
        } else {
            self.sweeps += 1.0;
            self.least = self.least.min(squared);
        }
        self.factor = self.sweeps / (self.sweeps + self.lag);
    }
}

/// What an accelerated sweep keeps of the one before.
pub struct Trail<M: Mechanics> {
    /// x: s after the sweep before (√J).
    s: Vec<M::Impulse>,
    /// y: s where this sweep began.
    ahead: Vec<M::Impulse>,
    /// Mass-scaled velocities of x (√J).
    velocity: Vec<M::Velocity>,
    /// Those without impulses (√J).
    free: Vec<M::Velocity>,
    /// β.
    factor: f64,
    /// |g|² and ⟨g, d⟩ (J).
    sums: [f64; 2],
}

impl<M: Mechanics> Trail<M> {
    /// The trail of a sweep that begins at impulses `s` and velocities `y`, which are `free` without impulses (√J).
    pub(crate) fn new(s: &[M::Impulse], y: &[M::Velocity], free: Vec<M::Velocity>) -> Self {
        let (s, velocity) = (s.to_vec(), y.to_vec());
        Self { ahead: s.clone(), s, velocity, free, factor: 0.0, sums: [0.0; 2] }
    }

    /// Returns the mass-scaled velocities without impulses (√J).
    pub fn free(&self) -> &[M::Velocity] {
        &self.free
    }

    /// Extrapolates the velocities `y`; the impulses follow as they are visited.
    pub(crate) fn extrapolate(&mut self, y: &mut [M::Velocity], factor: f64) {
        (self.factor, self.sums) = (factor, [0.0; 2]);
        for (y, before) in y.iter_mut().zip(&mut self.velocity) {
            let z = *y;
            *y = z + (z - *before) * factor;
            *before = z;
        }
    }

    /// Returns |g|² and ⟨g, d⟩ of the iteration (J).
    pub fn sums(&self) -> [f64; 2] {
        self.sums
    }
}

/// The visits of one pass of an iteration, of which the first extrapolates and the last is judged.
pub(crate) struct Accelerated<'a, M: Mechanics> {
    pub(crate) trail: &'a mut Trail<M>,
    pub(crate) is_first: bool,
    pub(crate) is_last: bool,
}

impl<M: Mechanics> crate::sweep::Around<M> for Accelerated<'_, M> {
    #[expect(clippy::inline_always, reason = "a call per visit would cost as much as the visit")]
    #[inline(always)]
    fn before(&mut self, first: usize, s: &mut [M::Impulse]) {
        if self.is_first {
            let Trail { s: x, ahead, factor, .. } = &mut *self.trail;
            let last = first + s.len();
            for ((s, x), ahead) in s.iter_mut().zip(&mut x[first..last]).zip(&mut ahead[first..last]) {
                *ahead = *s + (*s - *x) * *factor;
                *x = *s;
                *s = *ahead;
            }
        }
    }

    #[expect(clippy::inline_always, reason = "a call per visit would cost as much as the visit")]
    #[inline(always)]
    fn after(&mut self, first: usize, s: &[M::Impulse]) {
        if self.is_last {
            let Trail { s: x, ahead, sums, .. } = &mut *self.trail;
            let last = first + s.len();
            for ((s, x), ahead) in s.iter().zip(&x[first..last]).zip(&ahead[first..last]) {
                let g = *ahead - *s;
                sums[0] += g.dot_product(g);
                sums[1] += g.dot_product(*s - *x);
            }
        }
    }
}
