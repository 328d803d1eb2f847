//! A primal-dual interior point on the same factor: what finds the neighbourhood of a solution where nothing cheaper does.
//!
//! S. Mehrotra, On the implementation of a primal-dual interior point method, SIAM J. Optim. 2 (1992) 575-601.

use crate::inner::Inner;
use crate::scaled::{Scaled, left};

/// Impulses s > 0 and slacks t > 0 of H̃ᵗ y + c − t = 0, with y = M^½ `V_free` + H̃ s throughout.
pub(crate) struct Interior {
    pub(crate) s: Vec<f64>,
    pub(crate) t: Vec<f64>,
    /// v that follow from s.
    v: Vec<f64>,
    change_of_s: Vec<f64>,
    change_of_t: Vec<f64>,
    steps: u32,
}

/// Limit of steps: where there is a solution, a fifth of so many leads to it.
pub(crate) const MOST_STEPS: u32 = 150;

/// The impulses and slacks to begin with, over the quadratic mean of what r = 0 leaves (–): impulses add up in a packing, so
/// that those of a hundred layers are a hundred times those of one.
pub(crate) const FROM: f64 = 100.0;

/// Fraction of the way to the boundary that a step takes (–).
pub(crate) const SHORT_OF_IT: f64 = 0.99;

/// The steps are so short that there is no way on (–).
pub(crate) const NO_WAY: f64 = 1e-6;

impl Interior {
    /// Begins away from all bounds; `scale` is √(Σ max(0, −b̃)²).
    pub(crate) fn new<const D: usize, K: Inner<D>>(scaled: &mut Scaled<D, K>, scale: f64) -> Self {
        let contacts = scaled.contacts();
        let away = FROM * scale / (contacts.max(1) as f64).sqrt();
        let s = vec![away; contacts];
        let mut v = vec![0.0; contacts];
        scaled.velocities(&s, &mut v);
        let t = v.iter().map(|v| v.max(away)).collect();
        Self { s, t, v, change_of_s: vec![0.0; contacts], change_of_t: vec![0.0; contacts], steps: 0 }
    }

    /// √(Σ min(s, v)²) of its impulses (√J).
    pub(crate) fn left(&self) -> f64 {
        left(&self.s, &self.v)
    }

    /// One step, with one factorisation of K = 1 + Σ (s/t) h̃ h̃ᵗ and two solves: towards s t = 0, and then towards what the way
    /// there allows, s t = σ μ. `false` if there is no way on.
    pub(crate) fn step<const D: usize, K: Inner<D>>(&mut self, scaled: &mut Scaled<D, K>) -> bool {
        self.steps += 1;
        let (s, t) = (&self.s, &self.t);
        if self.steps > MOST_STEPS || !scaled.factorise(|k| s[k] / t[k]) {
            return false;
        }
        let mu = self.mean(0.0, 0.0);
        self.towards(scaled, |_, _| 0.0);
        let (of_s, of_t) = self.reach();
        let centring = (self.mean(of_s.min(1.0), of_t.min(1.0)) / mu).powi(3);
        self.towards(scaled, |change_of_s, change_of_t| centring * mu - change_of_s * change_of_t);
        let (of_s, of_t) = self.reach();
        let [of_s, of_t] = [of_s, of_t].map(|reach| (SHORT_OF_IT * reach).min(1.0));
        if !(of_s.min(of_t) > NO_WAY) {
            return false;
        }
        let advance = |x: &mut [f64], change: &[f64], length: f64| {
            x.iter_mut().zip(change).for_each(|(x, change)| *x += length * change);
        };
        advance(&mut self.s, &self.change_of_s, of_s);
        advance(&mut self.t, &self.change_of_t, of_t);
        scaled.velocities(&self.s, &mut self.v);
        true
    }

    /// Newton's direction towards s t = `goal`, of which each contact's last changes may be part:
    ///
    /// K δy = H̃ (goal/t − s + (s/t) (t − v)),   δt = H̃ᵗ δy − (t − v),   δs = goal/t − s − (s/t) δt.
    fn towards<const D: usize, K: Inner<D>>(
        &mut self,
        scaled: &mut Scaled<D, K>,
        goal: impl Fn(f64, f64) -> f64,
    ) {
        let Self { s, t, v, change_of_s, change_of_t, .. } = self;
        let goals: Vec<f64> = change_of_s.iter().zip(&*change_of_t).map(|(s, t)| goal(*s, *t)).collect();
        let p = |k: usize| (goals[k] - s[k] * v[k]) / t[k];
        scaled.solve(p, |k, along| {
            change_of_t[k] = along - (t[k] - v[k]);
            change_of_s[k] = (goals[k] - s[k] * change_of_t[k]) / t[k] - s[k];
        });
    }

    /// Returns the longest steps that keep s and t above 0.
    fn reach(&self) -> (f64, f64) {
        let reach = |x: &[f64], change: &[f64]| {
            let falling = x.iter().zip(change).filter(|(_, change)| **change < 0.0);
            falling.map(|(x, change)| -x / change).fold(f64::INFINITY, f64::min)
        };
        (reach(&self.s, &self.change_of_s), reach(&self.t, &self.change_of_t))
    }

    /// The mean of s t after steps of these lengths.
    fn mean(&self, of_s: f64, of_t: f64) -> f64 {
        let of_contact =
            |k: usize| (self.s[k] + of_s * self.change_of_s[k]) * (self.t[k] + of_t * self.change_of_t[k]);
        (0..self.s.len()).map(of_contact).sum::<f64>() / self.s.len() as f64
    }
}
