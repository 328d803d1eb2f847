//! Proximal points, each exact: ε draws the impulses to those of the point before, and a path leads from one to the next.
//!
//! Where more sticks than motion allows, sweeps of non-linear Gauss-Seidel move impulses along the kernel of W by the same amount each
//! time; a proximal point goes 1/ε times as far at once, through all that opens and slides on its way. So ε falls while paths arrive;
//! where one does not, ε grows; where that does not help either, sweeps look for another beginning.

use super::newton::Newton;
use super::path::{Change, Path};
use super::{Approach, Points};
use crate::Best;
use crate::layout::{distance, norm};
use contact::Work;
use nalgebra::Vector2;

/// ε of the first path, the least and the greatest (–).
const FIRST: f64 = 1e-3;
const LEAST: f64 = 1e-12;
const GREATEST: f64 = 0.1;

/// By how much ε falls and grows; by how much it falls after a path of few lines (–), and how many are few.
const FACTOR: f64 = 2.0;
const FAST: f64 = 4.0;
const FEW: u32 = 5;

/// The share of the impulses that a longer path changes, above which ε does not fall (–).
const FAR: f64 = 0.003;

/// Paths in a row that lead nowhere before it ends.
const IN_VAIN: u32 = 12;

/// Sweeps after paths that led nowhere, for each of these.
const SWEEPS: u32 = 200;

/// Points after which what is left must be half of what it was, or they lead nowhere.
const PATIENCE: u32 = 300;

/// Largest relative difference of the moves of two points that drift (–).
const DRIFT: f64 = 1e-2;

/// Points that leave more than ε accounts for: a contact is beyond its status by round-off, and they begin anew.
const BEGUN_ANEW: u32 = 40;

/// Largest residual of a point beyond what ε accounts for, over the terms that make b up (–).
const ROUND_OFF: f64 = 1e-14;

/// The points.
pub(super) struct Exact {
    path: Path,
    epsilon: f64,
    /// For which the law holds with s (√J).
    v: Vec<Vector2<f64>>,
    in_vain: u32,
    begun_anew: u32,
    /// The least that is left (√J); what it was when it was last halved, and the points since.
    least: f64,
    halved: f64,
    points: u32,
    /// ε times the change of the impulses by the last point, if it had one line (√J).
    last: Option<Vec<Vector2<f64>>>,
}

impl Exact {
    /// One point. Returns what it leaves of the law (√J), `None` where the path did not arrive.
    fn step(&mut self) -> Option<f64> {
        if self.least <= 0.5 * self.halved {
            (self.halved, self.points) = (self.least, 0);
        }
        self.points += 1;
        let centre = self.path.s.clone();
        let status = self.path.status.clone();
        let of_s = self.path.layout.velocity(&centre);
        let perturbation: Vec<_> = self.v.iter().zip(&of_s).map(|(v, of_s)| v - of_s).collect();
        let change = Change { epsilon: self.epsilon, centre: &centre, perturbation: &perturbation };
        let lines = self.path.follow(&change);
        let left = self.path.left();
        let moved = distance(&self.path.s, &centre);
        if let Some(lines) = lines {
            if left <= 2.0 * self.epsilon * moved + ROUND_OFF * self.path.layout.terms_of_b {
                self.least = self.least.min(left);
                self.in_vain = 0;
                self.v = self.path.velocity(&change, 0.0);
                self.path.free_of_held(&mut self.v);
                self.drift(lines, &centre);
                if moved < FAR * norm(&self.path.s) || lines < FEW {
                    self.epsilon = (self.epsilon / if lines < FEW { FAST } else { FACTOR }).max(LEAST);
                }
                return Some(left);
            }
            if self.begun_anew < BEGUN_ANEW && left < 3.0 * self.least {
                self.begun_anew += 1;
                self.last = None;
                self.least = self.least.min(left);
                self.path.s = self.path.layout.admitted(&self.path.s);
                self.v = self.path.begin();
                self.epsilon = self.epsilon.max(1e-7);
                return Some(left);
            }
        }
        self.in_vain += 1;
        self.last = None;
        self.path.s = centre;
        self.path.status = status;
        if self.in_vain.is_multiple_of(2) {
            self.sweep(SWEEPS * self.in_vain);
        } else {
            self.epsilon *= FACTOR;
        }
        None
    }

    /// Continues a drift of impulses until something opens or slides, where a point had one line only, and moved as the one before.
    fn drift(&mut self, lines: u32, before: &[Vector2<f64>]) {
        let last = self.last.take();
        if lines > 0 {
            return;
        }
        // ε drives, so that twice the ε goes half as far.
        let now: Vec<_> =
            self.path.s.iter().zip(before).map(|(now, before)| self.epsilon * (now - before)).collect();
        if last.is_some_and(|last| distance(&now, &last) < DRIFT * norm(&now)) {
            let times = self.path.room(&now) * (1.0 - 1e-7);
            if times.is_finite() && times * self.epsilon > 1.0 {
                self.path.s.iter_mut().zip(&now).for_each(|(s, now)| *s += times * now);
                self.v = self.path.layout.velocity(&self.path.s);
                self.path.free_of_held(&mut self.v);
                return;
            }
        }
        self.last = Some(now);
    }

    /// Begins anew from where sweeps lead.
    fn sweep(&mut self, sweeps: u32) {
        self.path.sweep(sweeps);
        self.v = self.path.begin();
        self.epsilon = (10.0 * self.epsilon.max(1e-6)).min(GREATEST);
    }
}

impl Points<2, 3> for Exact {
    fn new(newton: &Newton<2, 3>, best: &Best) -> Option<Self> {
        let mut path = Path::new(newton.layout.clone()).ok()?;
        path.s = path.layout.scaled(&best.impulses);
        let least = path.left();
        let v = path.begin();
        Some(Self {
            path,
            epsilon: FIRST,
            v,
            in_vain: 0,
            begun_anew: 0,
            least,
            halved: least,
            points: 0,
            last: None,
        })
    }

    fn advance(&mut self, _: &mut Newton<2, 3>, best: &mut Best, _: f64) -> Approach {
        if let Some(left) = self.step() {
            best.take(left, |r| self.path.layout.impulses(&self.path.s, r));
        }
        if self.path.is_solved() {
            Approach::Solved
        } else if self.in_vain >= IN_VAIN || self.points > PATIENCE {
            Approach::InVain
        } else {
            Approach::On
        }
    }

    fn work(&self) -> Work {
        self.path.work()
    }
}
