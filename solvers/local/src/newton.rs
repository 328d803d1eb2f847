//! Newton's method on the [statuses](contact::status) of contacts: open, stick, slide.
//!
//! P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods, Comput. Methods
//! Appl. Mech. Engrg. 92 (1991) 353-375; with the proximal term of R. T. Rockafellar (SIAM J. Control Optim. 14 (1976) 877-898), since W
//! is singular where contacts depend on each other.

use crate::LocalProblem;
use cholesky::General;
use contact::law::admissible;
use contact::status::{Status, wanted};
use contact::{Vector, Work};
use nalgebra::SVector;

/// ε of the proximal term, over w (–).
const PROXIMAL: f64 = 1e-8;

/// Solves with one factor, at most: each makes good what ε left of the one before.
const SOLVES: u32 = 8;

/// The share of what a solve had before it that is left after it, at most, or no other follows (–).
const WORTH_ANOTHER: f64 = 0.5;

/// The share of the terms that make v up which is round-off (–).
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// Impulses and their velocities, in units of the contacts: s = √w r, and v/√w.
pub(crate) struct Newton<'p, const D: usize> {
    problem: &'p LocalProblem,
    /// √w (kg^-½).
    unit: Vec<SVector<f64, D>>,
    /// μ √(`w_t`/`w_n`) (–).
    friction: Vec<f64>,
    /// √J.
    s: Vec<SVector<f64, D>>,
    v: Vec<SVector<f64, D>>,
    work: Work,
}

impl<'p, const D: usize> Newton<'p, D> {
    pub(crate) fn new(problem: &'p LocalProblem) -> Self {
        let unit = |contact| problem.weight::<D>(contact).map(f64::sqrt);
        let unit: Vec<_> = (0..problem.contact_count()).map(unit).collect();
        let friction = problem.friction().iter().zip(&unit).map(|(mu, unit)| mu * (unit[D - 1] / unit[0]));
        let none = vec![SVector::zeros(); unit.len()];
        let (friction, work) = (friction.collect(), Work::default());
        Self { problem, unit, friction, s: none.clone(), v: none, work }
    }

    /// Takes the impulses `r` (N·s).
    pub(crate) fn begin(&mut self, r: &[f64]) {
        let own = |(k, unit): (usize, &SVector<f64, D>)| SVector::<f64, D>::at(r, k).component_mul(unit);
        self.s = self.unit.iter().enumerate().map(own).collect();
        self.measure();
    }

    /// v of s.
    fn measure(&mut self) {
        let v = self.problem.velocity(&self.listed(|_, s| s));
        let own = |(k, unit): (usize, &SVector<f64, D>)| SVector::<f64, D>::at(&v, k).component_div(unit);
        self.v = self.unit.iter().enumerate().map(own).collect();
    }

    /// The impulses that are made of s, contact by contact (N·s).
    fn listed(&self, make: impl Fn(usize, SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        let mut r = vec![0.0; self.problem.q().len()];
        for (k, (s, unit)) in self.s.iter().zip(&self.unit).enumerate() {
            make(k, *s).component_div(unit).put(&mut r, k);
        }
        r
    }

    /// The nearest impulses that the law admits (N·s).
    pub(crate) fn impulses(&self) -> Vec<f64> {
        self.listed(|k, s| admissible(s, self.friction[k]))
    }

    /// Work so far.
    pub(crate) fn work(&self) -> Work {
        self.work
    }

    /// Reports whether the residual `left` of the law (√J) is round-off.
    pub(crate) fn is_round_off(&self, left: f64) -> bool {
        let r = self.listed(|_, s| s);
        let of = |contact: usize| {
            let mut terms = SVector::<f64, D>::at(self.problem.q(), contact).abs();
            for (w, other) in self.problem.row::<D>(contact) {
                terms += w.abs() * SVector::<f64, D>::at(&r, other).abs();
            }
            terms.component_div(&self.unit[contact]).norm_squared()
        };
        left <= ROUND_OFF * (0..self.unit.len()).map(of).sum::<f64>().sqrt()
    }

    /// One step: the statuses of s − v, and the impulses for which they hold to first order. Returns whether the matrix had a factor.
    pub(crate) fn step(&mut self) -> bool {
        let own = self.s.iter().zip(&self.v).zip(&self.friction);
        let status: Vec<_> = own.map(|((s, v), friction)| Status::of(*s, *v, *friction)).collect();
        for ((s, status), friction) in self.s.iter_mut().zip(&status).zip(&self.friction) {
            *s = status.project(*s, *friction);
        }
        self.measure();
        let closed: Vec<usize> = (0..status.len()).filter(|k| status[*k] != Status::Open).collect();
        if closed.is_empty() {
            return true;
        }
        self.work.factorisations += 1;
        let Ok(factor) = General::new(D * closed.len(), self.entries(&status, &closed)) else { return false };
        self.work.factorisation_multiply_adds += factor.multiply_adds();
        let mut left = wanted(&status, &self.s, &self.v);
        for _ in 0..SOLVES {
            let mut x = vec![0.0; D * closed.len()];
            for (place, k) in closed.iter().enumerate() {
                status[*k].unmet(self.s[*k], self.v[*k]).put(&mut x, place);
            }
            factor.solve(&mut x);
            let before = self.s.clone();
            closed.iter().enumerate().for_each(|(place, k)| self.s[*k] -= SVector::<f64, D>::at(&x, place));
            self.measure();
            let now = wanted(&status, &self.s, &self.v);
            if !(now < left) {
                self.s = before;
                self.measure();
            }
            if !(now < WORTH_ANOTHER * std::mem::replace(&mut left, now)) {
                break;
            }
        }
        self.s.iter().all(|s| s.iter().all(|x| x.is_finite()))
    }

    /// A δs + B δv of the contacts that are closed, see [`Status::conditions`], with δv = W δs.
    fn entries(&self, status: &[Status<D>], closed: &[usize]) -> Vec<(usize, usize, f64)> {
        let mut place = vec![None; status.len()];
        closed.iter().enumerate().for_each(|(k, contact)| place[*contact] = Some(k));
        let mut entries = Vec::new();
        for (row, contact) in closed.iter().enumerate() {
            let [a, b] = status[*contact].conditions(self.friction[*contact], PROXIMAL);
            for (w, other) in self.problem.row::<D>(*contact) {
                let Some(column) = place[other] else { continue };
                let w = w.component_div(&(self.unit[*contact] * self.unit[other].transpose()));
                let block = if other == *contact { a + b * w } else { b * w };
                for (k, l) in (0..D).flat_map(|k| (0..D).map(move |l| (k, l))) {
                    entries.push((D * row + k, D * column + l, block[(k, l)]));
                }
            }
        }
        entries
    }
}
