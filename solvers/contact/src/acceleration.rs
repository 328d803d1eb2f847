//! Nesterov's extrapolation over the sweeps of any mechanics, with a restart that leaves slack.
//!
//! A sweep z = S(y) of Gauss-Seidel is made from an extrapolated point y of impulses, which may lie outside the cones: the sweep
//! projects it. From r0, with lag q and slack ρ, and x = y = r0, j = 0, m = ∞ to begin with:
//!
//! > z = S(y);  g = y − z;  d = z − x <br>
//! > if ⟨g, d⟩ > 0, or |g|² > ρ² m:  j = 0, β = 0, m = |g|² (restart) <br>
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
//! 715-732, whose test of the gradient is ⟨g, d⟩ > 0. Without friction the sweep that follows a restart is one of plain NSGS, so q(r)
//! falls there or stays. With Coulomb's law q is no merit function and nothing is proved: that test alone hardly ever restarts, and
//! that ρ > 1 does better than 1 is a finding.

#![expect(clippy::inline_always, reason = "else these lack the instructions that a sweep is made for")]

use crate::error::SetupError;
use crate::lanes::Number;
use crate::vector::{Numbers, Vector};
use crate::visit::Visited;
use bytemuck::{cast_slice, cast_slice_mut};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::array::from_fn;
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
    /// The momentum, if any, with the lag q and the slack ρ (–), which unless given is 1.2 with friction, and 5 without.
    ///
    /// # Errors
    /// q ≤ 0, or ρ < 1, which would restart at every sweep.
    pub fn momentum(self, lag: f64, slack: Option<f64>) -> Result<Option<Momentum>, SetupError> {
        SetupError::unless_positive("lag", lag)?;
        if let Some(slack) = slack {
            SetupError::unless(slack >= 1.0, "slack", slack, "at least 1")?;
        }
        let (least, best) = (f64::INFINITY, f64::INFINITY);
        let momentum = Momentum { lag, slack, age: 0, least, best, pause: 0, paused: 0 };
        Ok((self == Self::Nesterov).then_some(momentum))
    }
}

/// q of β = j/(j + q) (–). On 19 problems without friction, of 250 to 16,000 discs and 250 to 1,000 spheres, a column and a crystal,
/// 1, 1.5 and 2 take 0.93, 0.94 and 0.91 of the iterations of conjugate gradients to 1e-6 in the geometric mean, 3 takes 1.05. With friction 2 takes 0.93 of
/// the sweeps of 3 to 1e-4 on the seven of eight frozen problems that get there; over 200 time steps each of `heap`, `drum` and `biaxial` with five seeds they miss
/// 29 and 28 of the 3,000, in as many sweeps to within 2 %.
pub const LAG: f64 = 2.0;

/// ρ with friction (–). On 14 frictional problems of 250 to 1,000 grains, μ from 0.1 to 0.8, 1.5 takes a fifth fewer sweeps to 1e-3 and
/// 1e-4, and 2 fails to reach these on two to four of them; but through time 1.5 misses twice as many time steps as 1.2. Without
/// friction it restarts too early: on the 19 problems, at q = 3, 1.2 takes 9 % more iterations to 1e-6 than none.
const SLACK: f64 = 1.2;

/// ρ without friction (–). It stops what ⟨g, d⟩ > 0 does not see: in a crystal of 24 × 120 discs extrapolated sweeps oscillate and grow, to a
/// natural map of 10¹⁰ after 216 of them. On seven frozen problems `nsgs` takes as many iterations to 1e-8 with it as without,
/// where 3 changes one of them and 2 six.
const SLACK_WITHOUT_FRICTION: f64 = 5.0;

/// Plain iterations at most between two cycles. Through those 3,000 time steps, at q = 3 and with other round-off, 20 missed 1e-4 in
/// 20,000 iterations with it (42 with ρ = 1.5), and 55 (71) without any pause, where extrapolation ends in a limit cycle; plain sweeps
/// missed 78, with six times as many iterations. Without a bound 17 (18) missed, but the frozen problem `settled-991`
/// then stays at 1e-7.
const LONGEST_PAUSE: u32 = 64;

/// Numbers side by side: the processor's instructions take as many.
const LANES: usize = 4;

/// The factor β of the extrapolation, from iteration to iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum {
    lag: f64,
    slack: Option<f64>,
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
    /// Returns the momentum of a problem, with the slack of one that is `frictional` or not unless it has its own.
    #[must_use]
    pub fn of_problem(self, frictional: bool) -> Self {
        let of_problem = if frictional { SLACK } else { SLACK_WITHOUT_FRICTION };
        Self { slack: self.slack.or(Some(of_problem)), ..self }
    }

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
        } else if along > 0.0 || self.slack.is_some_and(|slack| squared > slack * slack * self.least) {
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

/// y = z + β (z − x), then x = z: `z` becomes y.
#[inline(always)]
fn extrapolate<V: Numbers>(z: &mut [V], x: &mut [V], factor: f64) {
    let factor = <V::Number as Number>::nearest(factor);
    for (z, x) in cast_slice_mut::<V, V::Number>(z).iter_mut().zip(cast_slice_mut::<V, V::Number>(x)) {
        (*x, *z) = (*z, *z + (*z - *x) * factor);
    }
}

/// |g|² and ⟨g, d⟩ (J) of several numbers side by side: no sum waits for another.
type Sums = [[f64; LANES]; 2];

/// Adds |g|² and ⟨g, d⟩ of some numbers, g = y − z and d = z − x.
#[inline(always)]
fn add<N: Number>([squared, along]: &mut Sums, [x, y, z]: [&[N; LANES]; 3]) {
    for k in 0..LANES {
        let [g, d]: [f64; 2] = [y[k] - z[k], z[k] - x[k]].map(Into::into);
        squared[k] += g * g;
        along[k] += g * d;
    }
}

/// The last numbers of a list, and zeros.
fn filled<N: Number>(last: &[N]) -> [N; LANES] {
    from_fn(|k| last.get(k).copied().unwrap_or(N::zero()))
}

/// Impulses of an accelerated iteration, of a contact each: x and y of the formula, and its two sums.
pub struct Lead<V> {
    /// x: the impulses after the sweep before.
    before: Vec<V>,
    /// y of the rows that were extrapolated last, which are next to be judged.
    ahead: Vec<V>,
    /// β.
    factor: f64,
    sums: Sums,
}

impl<V: Numbers> Lead<V> {
    /// The lead of a sweep that begins at impulses `s`.
    pub fn new(s: &[V]) -> Self {
        Self { before: s.to_vec(), ahead: s.to_vec(), factor: 0.0, sums: [[0.0; LANES]; 2] }
    }

    /// Begins an iteration with `factor` β.
    pub fn begin(&mut self, factor: f64) {
        (self.factor, self.sums) = (factor, [[0.0; LANES]; 2]);
    }

    /// Extrapolates the impulses of some rows: y = z + β (z − x), x = z.
    #[inline(always)]
    pub fn extrapolate(&mut self, s: &mut [V], here: Range<usize>) {
        let s = &mut s[here.clone()];
        extrapolate(s, &mut self.before[here], self.factor);
        self.ahead[..s.len()].copy_from_slice(s);
    }

    /// Adds |g|² and ⟨g, d⟩ of the rows that were extrapolated last, g = y − z and d = z − x.
    #[inline(always)]
    pub fn judge(&mut self, s: &[V], here: Range<usize>) {
        let lists = [&self.before[here.clone()], &self.ahead[..here.len()], &s[here]];
        let [(x, last_x), (y, last_y), (z, last_z)] =
            lists.map(|list| cast_slice::<V, V::Number>(list).as_chunks::<LANES>());
        // The compiler must know that nothing else is where the sums are.
        let mut sums = self.sums;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            add(&mut sums, [x, y, z]);
        }
        add(&mut sums, [last_x, last_y, last_z].map(filled).each_ref());
        self.sums = sums;
    }

    /// Adds |g|² and ⟨g, d⟩ of all rows where D is not the identity: `weighed` multiplies the g of a row by its D.
    pub fn judge_weighed(&mut self, s: &[V], weighed: impl Fn(usize, V) -> V)
    where
        V: Vector,
    {
        let [squared, along] = &mut self.sums;
        for (row, ((x, y), z)) in self.before.iter().zip(&self.ahead).zip(s).enumerate() {
            let (g, d) = (*y - *z, *z - *x);
            let of_g = weighed(row, g);
            squared[row % LANES] += of_g.dot_product(g);
            along[row % LANES] += of_g.dot_product(d);
        }
    }

    /// Returns |g|² and ⟨g, d⟩ of the iteration (J).
    pub fn sums(&self) -> [f64; 2] {
        self.sums.map(|lanes| lanes.into_iter().sum())
    }
}

/// State that an accelerated iteration keeps of the one before.
pub struct Trail<C: Visited> {
    /// Mass-scaled impulses s (√J).
    pub(crate) impulses: Lead<C::Impulse>,
    /// Mass-scaled velocities of x (√J).
    velocity: Vec<C::Velocity>,
    /// Number of velocities that are extrapolated already.
    reached: usize,
    /// Mass-scaled velocities without impulses (√J).
    free: Vec<C::Velocity>,
}

impl<C: Visited> Trail<C> {
    /// The trail of a sweep that begins at impulses `s` and velocities `y`, which are `free` without impulses (√J).
    pub(crate) fn new(s: &[C::Impulse], y: &[C::Velocity], free: Vec<C::Velocity>) -> Self {
        Self { impulses: Lead::new(s), velocity: y.to_vec(), reached: 0, free }
    }

    /// Returns the mass-scaled velocities without impulses (√J).
    pub fn free(&self) -> &[C::Velocity] {
        &self.free
    }

    /// Begins an iteration with `factor` β.
    pub fn begin(&mut self, factor: f64) {
        self.impulses.begin(factor);
        self.reached = 0;
    }

    /// Extrapolates the first velocities of `y`, up to `reach`, unless they are extrapolated already.
    #[inline(always)]
    pub fn extrapolate(&mut self, y: &mut [C::Velocity], reach: usize) {
        let here = self.reached..reach.max(self.reached);
        extrapolate(&mut y[here.clone()], &mut self.velocity[here], self.impulses.factor);
        self.reached = reach.max(self.reached);
    }

    /// Changes the velocities of x by as much as others, which were made anew without another change.
    pub(crate) fn shift(&mut self, before: &[C::Velocity], after: &[C::Velocity]) {
        for (x, (before, after)) in self.velocity.iter_mut().zip(before.iter().zip(after)) {
            *x += *after - *before;
        }
    }

    /// Returns |g|² and ⟨g, d⟩ of the iteration (J).
    pub fn sums(&self) -> [f64; 2] {
        self.impulses.sums()
    }
}
