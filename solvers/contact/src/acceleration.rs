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
//! A restart whose cycle did not lower the least |g|² of all cycles before is followed by plain sweeps, β = 0: 1, 2, 4, … up to 64 of
//! them from one such cycle to the next. With Coulomb's law extrapolation alone may end in a limit cycle where plain sweeps converge.
//!
//! Norm and product are those of D = diag(`W_αα`), Euclidean in s = √`W_αα` r. V is affine in r, so velocities are extrapolated by the
//! same β and no product with W is needed. z is measured and handed back.
//!
//! Y. Nesterov, A method of solving a convex programming problem with convergence rate O(1/k²), Soviet Math. Dokl. 27 (1983) 372-376;
//! restarts after B. O'Donoghue and E. Candès, Adaptive restart for accelerated gradient schemes, Found. Comput. Math. 15 (2015)
//! 715-732. Without friction the sweep that follows a restart is one of plain NSGS, so q(r) falls there or stays. With Coulomb's law
//! q is no merit function and nothing is proved; ρ > 1 is a finding.

use crate::error::SetupError;
use crate::mechanics::{Mechanics, Vector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Range;

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
        let (least, best) = (f64::INFINITY, f64::INFINITY);
        let momentum = Momentum { lag, slack, age: 0, least, best, pause: 0, paused: 0 };
        Ok((self == Self::Nesterov).then_some(momentum))
    }
}

/// q of β = j/(j + q) (–). On the frozen problems 2, 3 and 4 need the same number of sweeps to within a fifth, with friction the
/// higher ones reach the lower residuals.
pub const LAG: f64 = 3.0;

/// ρ (–). On 14 frictional problems of 250 to 1,000 grains, μ from 0.1 to 0.8, 1.5 takes a fifth fewer sweeps to 1e-3 and 1e-4, and 2
/// fails to reach these on two to four of them; but through time 1.5 misses twice as many time steps as 1.2.
pub const SLACK: f64 = 1.2;

/// Plain iterations at most between two cycles. Over 200 time steps each of the cases `heap`, `drum` and `biaxial` with five seeds, 20 of
/// the 3,000 miss 1e-4 in 20,000 iterations with it (42 with ρ = 1.5), and 55 (71) without any pause, where extrapolation ends in a limit
/// cycle; plain sweeps miss 78, with six times as many iterations. Without a bound 17 (18) miss, but the frozen problem `settled-991`
/// then stays at 1e-7.
const LONGEST_PAUSE: u32 = 64;

/// Sums side by side.
const LANES: usize = 4;

/// The factor β of the extrapolation, from iteration to iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum {
    lag: f64,
    slack: f64,
    /// j.
    age: u32,
    /// m (J): the least |g|² of this cycle, and of all before.
    least: f64,
    best: f64,
    /// Plain iterations that follow the cycle, and how many of them are still to come.
    pause: u32,
    paused: u32,
}

impl Momentum {
    /// Returns β (–), with which the next iteration begins.
    pub fn factor(&self) -> f64 {
        f64::from(self.age) / (f64::from(self.age) + self.lag)
    }

    /// Reports whether the next iteration begins without extrapolation after others: velocities are then made anew from the
    /// impulses, since their round-off is extrapolated too.
    pub fn has_restarted(&self) -> bool {
        self.age == 0 && self.least < f64::INFINITY && self.paused == self.pause
    }

    /// Takes |g|² and ⟨g, d⟩ (J) of an iteration.
    pub fn turn(&mut self, [squared, along]: [f64; 2]) {
        if self.paused > 0 {
            self.paused -= 1;
            self.least = squared;
        } else if squared > self.slack * self.slack * self.least || along > 0.0 {
            // A cycle without progress is followed by twice as many plain iterations as the one before.
            self.pause = if self.least < self.best { 0 } else { (2 * self.pause).clamp(1, LONGEST_PAUSE) };
            self.best = self.best.min(self.least);
            (self.age, self.least, self.paused) = (0, squared, self.pause);
        } else {
            self.age += 1;
            self.least = self.least.min(squared);
        }
    }
}

/// Impulses of an accelerated iteration, of a contact each: x and y of the formula, and its two sums.
pub struct Lead<V> {
    /// x: the impulses after the sweep before.
    before: Vec<V>,
    /// y: the impulses where this sweep began.
    ahead: Vec<V>,
    /// β.
    factor: f64,
    /// |g|² and ⟨g, d⟩ (J).
    sums: [f64; 2],
}

impl<V: Vector> Lead<V> {
    /// The lead of a sweep that begins at impulses `s`.
    pub fn new(s: &[V]) -> Self {
        Self { before: s.to_vec(), ahead: s.to_vec(), factor: 0.0, sums: [0.0; 2] }
    }

    /// Begins an iteration with `factor` β.
    pub fn begin(&mut self, factor: f64) {
        (self.factor, self.sums) = (factor, [0.0; 2]);
    }

    /// Extrapolates the impulses of some rows: y = z + β (z − x), x = z.
    pub fn extrapolate(&mut self, s: &mut [V], here: Range<usize>) {
        let (x, ahead) = (&mut self.before[here.clone()], &mut self.ahead[here.clone()]);
        for ((s, x), ahead) in s[here].iter_mut().zip(x).zip(ahead) {
            *ahead = *s + (*s - *x) * self.factor;
            *x = *s;
            *s = *ahead;
        }
    }

    /// Adds |g|² and ⟨g, d⟩ of some rows, g = y − z and d = z − x, in sums that do not wait for each other; `weighed` multiplies the g of a
    /// row by the D of the norm.
    pub fn judge(&mut self, s: &[V], here: Range<usize>, weighed: impl Fn(usize, V) -> V) {
        let [mut squared, mut along] = [[0.0; LANES]; 2];
        let (first, s) = (here.start, &s[here.clone()]);
        let (x, ahead) = (&self.before[here.clone()], &self.ahead[here]);
        let chunks = s.chunks(LANES).zip(x.chunks(LANES)).zip(ahead.chunks(LANES));
        for (chunk, ((s, x), ahead)) in chunks.enumerate() {
            for (lane, ((s, x), ahead)) in s.iter().zip(x).zip(ahead).enumerate() {
                let g = *ahead - *s;
                let of_g = weighed(first + LANES * chunk + lane, g);
                squared[lane] += g.dot_product(of_g);
                along[lane] += of_g.dot_product(*s - *x);
            }
        }
        self.sums[0] += squared.iter().sum::<f64>();
        self.sums[1] += along.iter().sum::<f64>();
    }

    /// Returns |g|² and ⟨g, d⟩ of the iteration (J).
    pub fn sums(&self) -> [f64; 2] {
        self.sums
    }
}

/// State that an accelerated iteration keeps of the one before.
pub struct Trail<M: Mechanics> {
    /// Mass-scaled impulses s (√J).
    pub(crate) impulses: Lead<M::Impulse>,
    /// Mass-scaled velocities of x (√J).
    velocity: Vec<M::Velocity>,
    /// Mass-scaled velocities without impulses (√J).
    free: Vec<M::Velocity>,
}

impl<M: Mechanics> Trail<M> {
    /// The trail of a sweep that begins at impulses `s` and velocities `y`, which are `free` without impulses (√J).
    pub(crate) fn new(s: &[M::Impulse], y: &[M::Velocity], free: Vec<M::Velocity>) -> Self {
        Self { impulses: Lead::new(s), velocity: y.to_vec(), free }
    }

    /// Returns the mass-scaled velocities without impulses (√J).
    pub fn free(&self) -> &[M::Velocity] {
        &self.free
    }

    /// Extrapolates the velocities `y`; the impulses follow as they are visited.
    pub(crate) fn extrapolate(&mut self, y: &mut [M::Velocity], factor: f64) {
        self.impulses.begin(factor);
        for (y, before) in y.iter_mut().zip(&mut self.velocity) {
            let z = *y;
            *y = z + (z - *before) * factor;
            *before = z;
        }
    }

    /// Returns |g|² and ⟨g, d⟩ of the iteration (J).
    pub fn sums(&self) -> [f64; 2] {
        self.impulses.sums()
    }
}
