//! The primal-dual active set: Newton's method on s = max(0, s − v).

use crate::inner::{Inner, Whole};
use crate::scaled::{Scaled, left};
use contact::{ContactProblem, Packing, SetupError, Smooth, Work};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Solves with one factor, at most: each makes good what round-off, κ times as great, left of the one before.
const SOLVES: u32 = 4;

/// The share of what is left of the law that the closed contacts may have after a solve, or another follows (–).
const HELD: f64 = 1e-2;

/// The share of the terms that make v up which is round-off (–): some six of them at a contact, added one after the other.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// The contacts that are held closed, and the impulses that hold them.
pub struct Set<const D: usize = 2, K: Inner<D> = Whole<D>> {
    pub(crate) scaled: Scaled<D, K>,
    closed: Vec<bool>,
    /// True where the factor is that of the set.
    is_factorised: bool,
    pub(crate) s: Vec<f64>,
    /// v that follow from s.
    pub(crate) v: Vec<f64>,
    /// s before the last solve.
    before: Vec<f64>,
}

impl<const D: usize> Set<D> {
    /// Lays the problem out, with r = 0.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub fn new(problem: &Packing<Smooth<D>>) -> Result<Self, SetupError> {
        Ok(Self::on(Scaled::new(problem, Whole::new(problem)?)))
    }
}

impl<const D: usize, K: Inner<D>> Set<D, K> {
    /// No contact closed, no impulse.
    pub(crate) fn on(scaled: Scaled<D, K>) -> Self {
        let (zeros, closed) = (vec![0.0; scaled.contacts()], vec![false; scaled.contacts()]);
        let (v, before) = (zeros.clone(), zeros.clone());
        let mut set = Self { scaled, closed, is_factorised: false, s: zeros, v, before };
        set.measure();
        set
    }

    /// √(Σ min(s, v)²): what is left of the law (√J).
    pub fn left(&self) -> f64 {
        left(&self.s, &self.v)
    }

    /// Reports whether the residual of the law is round-off.
    pub fn is_solved(&self) -> bool {
        let of_s = self.s.iter().map(|s| s * s).sum::<f64>().sqrt();
        self.left() <= ROUND_OFF * (of_s + self.scaled.terms_of_b)
    }

    /// The set, as a number.
    pub(crate) fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.closed.hash(&mut hasher);
        hasher.finish()
    }

    /// Closes the contacts with s > v and lets the others go, in one step of Newton: how many changed, `None` if there is no factor.
    pub fn step(&mut self) -> Option<usize> {
        let closed = self.s.iter().zip(&self.v).map(|(s, v)| s > v).collect();
        self.hold(closed)
    }

    /// Holds these contacts closed and lets the others go. With K = 1 + κ H̃_A H̃_Aᵗ,
    ///
    /// K δy = −κ H̃_A v_A − H̃_I s_I,   s_A ← s_A − κ (v_A + H̃_Aᵗ δy),   s_I ← 0,
    ///
    /// which is (H̃_Aᵗ H̃_A + 1/κ) δs_A = −v_A − H̃_Aᵗ δy_I. v comes from s each time, so that no error of K stays. Returns how many
    /// contacts changed, `None` if the matrix has no factor; where none did, the factor is the one before.
    pub(crate) fn hold(&mut self, closed: Vec<bool>) -> Option<usize> {
        let changed = self.closed.iter().zip(&closed).filter(|(before, now)| before != now).count();
        self.closed = closed;
        if changed > 0 || !self.is_factorised {
            let (closed, kappa) = (&self.closed, self.scaled.penalty());
            self.is_factorised = self.scaled.factorise(|k| if closed[k] { kappa } else { 0.0 });
        }
        if !self.is_factorised {
            return None;
        }
        let mut held = f64::INFINITY;
        for _ in 0..SOLVES {
            self.solve();
            let of_held = self.v.iter().zip(&self.closed).filter(|(_, closed)| **closed);
            let now = of_held.map(|(v, _)| v * v).sum::<f64>().sqrt();
            if !(now > HELD * self.left() && now < 0.5 * held) {
                break;
            }
            held = now;
        }
        Some(changed)
    }

    fn solve(&mut self) {
        let Self { scaled, closed, s, v, before, .. } = self;
        before.copy_from_slice(s);
        let kappa = scaled.penalty();
        let pull = |k: usize| if closed[k] { -kappa * v[k] } else { -before[k] };
        scaled.solve(pull, |k, change| s[k] = if closed[k] { s[k] - kappa * (v[k] + change) } else { 0.0 });
        self.measure();
    }

    /// v of s.
    pub(crate) fn measure(&mut self) {
        self.scaled.velocities(&self.s, &mut self.v);
    }

    /// The factor is about to be that of another matrix.
    pub(crate) fn lend_factor(&mut self) -> &mut Scaled<D, K> {
        self.is_factorised = false;
        &mut self.scaled
    }

    /// Takes the impulses `r` (N·s).
    pub fn begin(&mut self, r: &[f64]) {
        self.s = self.scaled.scale(r);
        self.measure();
    }

    /// max(0, r) in the problem's order (N·s).
    pub fn impulses(&self, r: &mut [f64]) {
        self.scaled.impulses(&self.s, r);
    }

    /// Work so far.
    pub fn work(&self) -> Work {
        self.scaled.work()
    }

    /// Turns impulses `d` (N·s) near a proof of infeasibility into one: the change of those above 0 that is least in s and after
    /// which they balance, H d = 0.
    pub fn balance(&mut self, d: &mut [f64]) {
        let mut s = self.scaled.scale(d);
        let greatest = s.iter().copied().fold(0.0, f64::max);
        // What is left of multipliers that should be 0.
        let acts: Vec<bool> = s.iter().map(|s| *s > 1e-6 * greatest).collect();
        s.iter_mut().zip(&acts).filter(|(_, acts)| !**acts).for_each(|(s, _)| *s = 0.0);
        let scaled = self.lend_factor();
        let kappa = scaled.penalty();
        if !scaled.factorise(|k| if acts[k] { kappa } else { 0.0 }) {
            return;
        }
        for _ in 0..SOLVES {
            let unbalanced = s.clone();
            scaled.solve(|k| unbalanced[k], |k, change| s[k] -= if acts[k] { kappa * change } else { 0.0 });
        }
        scaled.impulses(&s, d);
    }

    /// Impulses that prove that `problem` has no solution, if the growth of the last solve does.
    pub(crate) fn ray(&mut self, problem: &ContactProblem<Smooth<D>>) -> Option<Vec<f64>> {
        let growth: Vec<f64> = self.s.iter().zip(&self.before).map(|(s, before)| s - before).collect();
        self.ray_of(problem, &growth)
    }

    /// Returns the ray of the impulses `s` (√J), if they prove that there is no solution.
    pub(crate) fn ray_of(&mut self, problem: &ContactProblem<Smooth<D>>, s: &[f64]) -> Option<Vec<f64>> {
        let mut ray = vec![0.0; s.len()];
        self.scaled.impulses(s, &mut ray);
        let proves = |ray: &[f64]| analysis::proves_infeasible(problem, ray);
        if !proves(&ray) {
            self.balance(&mut ray);
        }
        proves(&ray).then_some(ray)
    }
}
