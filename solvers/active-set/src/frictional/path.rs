//! From the exact solution of one problem to that of another along a path: the law is piecewise linear in the plane, so solutions of
//!
//! v = W s + ε (s − centre) + b + t p
//!
//! lie on lines, one for each list of statuses, and a line ends where a contact opens, closes, slides or sticks. From t = 1, where a
//! solution is known, the path follows them to t = 0. It may turn back in t on its way, which Newton's method cannot: a contact that
//! changes its status says to which side the next line goes. With ε > 0 each line is given by a matrix that has an inverse but by
//! chance. (Lemke's pivots are such a path; this one begins anywhere.)

mod line;
#[cfg(test)]
mod tests;

use super::matrix::Matrix;
use crate::layout::{Drawn, Layout, norm};
use contact::status::{Status, wanted};
use contact::{SetupError, Visited, Work};
use line::{End, Line};
use nalgebra::{Vector2, Vector3};

/// Lines of one path, at most.
const LINES: u32 = 400;

/// t beyond which a path has gone away (–).
const AWAY: f64 = 3.0;

/// Changes of status after which the matrix is factorised anew.
const CHANGES: usize = 30;

/// Solves of one system, at most: each makes good what round-off left of the one before.
const SOLVES: u32 = 5;

/// The share of what a solve had before it that is left after it, at most, or no other follows (–).
const WORTH_ANOTHER: f64 = 0.1;

/// Largest motion of held velocities: along a line over the change of the impulses; over the impulses where a line ends, and the path (–).
const ALONG: f64 = 1e-10;
const UNDERWAY: f64 = 1e-13;
const ROUND_OFF: f64 = 1e-15;

/// A solution of the law, and the path's place on it.
pub(super) struct Path {
    pub(super) layout: Layout<2, 3>,
    pub(super) status: Vec<Status<2>>,
    pub(super) s: Vec<Vector2<f64>>,
    matrix: Matrix<2, 3>,
    /// Sweeps over contacts.
    sweeps: u64,
}

/// Part of the problem that a path changes.
pub(super) struct Change<'a> {
    /// ε (–).
    pub(super) epsilon: f64,
    /// Towards which ε draws (√J).
    pub(super) centre: &'a [Vector2<f64>],
    /// p (√J).
    pub(super) perturbation: &'a [Vector2<f64>],
}

impl Path {
    /// Lays a packing out, with s = 0.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub(super) fn new(layout: Layout<2, 3>) -> Result<Self, SetupError> {
        let count = layout.columns.len();
        Ok(Self {
            matrix: Matrix::new(&layout)?,
            status: vec![Status::Open; count],
            s: vec![Vector2::zeros(); count],
            layout,
            sweeps: 0,
        })
    }

    /// Follows the path from s at t = 1, the solution that goes with `status`, to t = 0. Returns the lines that it had; `None` where it
    /// comes back to where it began, goes away, or has too many.
    pub(super) fn follow(&mut self, change: &Change) -> Option<u32> {
        let start = self.status.clone();
        let (mut t, mut crossed, mut away_from_start) = (1.0, None::<(usize, Status<2>)>, 0_usize);
        if !self.matrix.is_of(&self.status, change.epsilon) && !self.factorise(change.epsilon) {
            return None;
        }
        for line in 0..LINES {
            let along = self.respond(change.epsilon, change.perturbation);
            let forth = crossed.is_some_and(|(contact, before)| self.enters(contact, before, &along));
            let sign = if forth { 1.0 } else { -1.0 };
            let v = self.velocity(change, t);
            let end = self.end(crossed, &v, sign, &along);
            let arrives = !forth && end.is_none_or(|end| end.at >= t);
            let far = if arrives { t } else { end?.at };
            for (s, ds) in self.s.iter_mut().zip(&along.ds) {
                *s += sign * far * ds;
            }
            t = if arrives { 0.0 } else { t + sign * far };
            self.correct(change, t);
            if arrives {
                return Some(line);
            }
            let End { contact, next, .. } = end?;
            let before = std::mem::replace(&mut self.status[contact], next);
            away_from_start += usize::from(before == start[contact]);
            away_from_start -= usize::from(next == start[contact]);
            if next == Status::Open {
                self.s[contact] = Vector2::zeros();
            }
            if away_from_start == 0 || t > AWAY || !self.update(contact, change.epsilon) {
                return None;
            }
            crossed = Some((contact, before));
        }
        None
    }

    /// v + ε (s − centre) + t p of s, which the law holds for.
    pub(super) fn velocity(&self, change: &Change, t: f64) -> Vec<Vector2<f64>> {
        let drawn = Drawn { epsilon: change.epsilon, centre: Some(change.centre) };
        let mut v = drawn.velocity(&self.layout, &self.s);
        v.iter_mut().zip(change.perturbation).for_each(|(v, p)| *v += t * p);
        v
    }

    /// The change of s, and of v, that answers velocities `added` (√J): such that nothing moves that is held.
    fn respond(&mut self, epsilon: f64, added: &[Vector2<f64>]) -> Line {
        let mut ds = vec![Vector2::zeros(); added.len()];
        let mut dv = added.to_vec();
        let mut moves = f64::INFINITY;
        for _ in 0..SOLVES {
            self.matrix.correct(&self.layout.columns, &dv, &mut ds);
            let y = self.layout.pushed(vec![Vector3::zeros(); self.layout.grains()], &ds);
            let of = self.layout.columns.iter().zip(&ds).zip(added);
            dv = of.map(|((column, ds), added)| column.relative(&y) + epsilon * ds + added).collect();
            let before = std::mem::replace(&mut moves, wanted(&self.status, &ds, &dv));
            if moves <= ALONG * (norm(&ds) + norm(added)) || moves > WORTH_ANOTHER * before {
                break;
            }
        }
        Line { ds, dv }
    }

    /// Takes back what moves of that which is held, at t: round-off of the line that led there.
    fn correct(&mut self, change: &Change, t: f64) {
        let allowed = if t == 0.0 { ROUND_OFF } else { UNDERWAY };
        let mut moves = f64::INFINITY;
        for _ in 0..SOLVES {
            let v = self.velocity(change, t);
            let before = std::mem::replace(&mut moves, wanted(&self.status, &self.s, &v));
            if moves <= allowed * (norm(&self.s) + self.layout.terms_of_b) || moves > WORTH_ANOTHER * before {
                break;
            }
            self.matrix.correct(&self.layout.columns, &v, &mut self.s);
        }
    }

    /// The matrix of the statuses that there are; says whether it has an inverse.
    fn factorise(&mut self, epsilon: f64) -> bool {
        self.matrix.factorise(&self.layout.columns, &self.status, epsilon)
    }

    /// Updates the factor after a contact changed its status; reports whether there is one.
    fn update(&mut self, contact: usize, epsilon: f64) -> bool {
        if self.matrix.changes() < CHANGES {
            self.matrix.change(&self.layout.columns, contact, self.status[contact])
        } else {
            self.factorise(epsilon)
        }
    }

    /// Takes s as it is, with the statuses of s − v: returns the velocities for which the law holds with the nearest impulses that it
    /// admits, which s then is.
    pub(super) fn begin(&mut self) -> Vec<Vector2<f64>> {
        let v = self.layout.velocity(&self.s);
        self.status = self.layout.statuses(&self.s, &v);
        let moved: Vec<_> = self.s.iter().zip(&v).map(|(s, v)| s - v).collect();
        self.s = self.layout.admitted(&moved);
        self.s.iter().zip(&moved).map(|(s, moved)| s - moved).collect()
    }

    /// Work so far.
    pub(super) fn work(&self) -> Work {
        let mut work = self.matrix.work();
        work.contact_updates += self.sweeps * self.s.len() as u64;
        work
    }

    /// Takes from velocities what contacts must not have.
    pub(super) fn free_of_held(&self, v: &mut [Vector2<f64>]) {
        for (v, status) in v.iter_mut().zip(&self.status) {
            match status {
                Status::Open => {}
                Status::Stick => *v = Vector2::zeros(),
                Status::Slide(_) => v.x = 0.0,
            }
        }
    }

    /// Sweeps over the contacts.
    pub(super) fn sweep(&mut self, sweeps: u32) {
        self.sweeps += u64::from(sweeps);
        self.layout.sweep(Drawn { epsilon: 0.0, centre: None }, &mut self.s, sweeps);
    }

    /// Returns the residual of s, made admissible (√J).
    pub(super) fn left(&self) -> f64 {
        let s = self.layout.admitted(&self.s);
        self.layout.left(&s, &self.layout.velocity(&s))
    }

    /// Reports whether the residual of s is round-off.
    pub(super) fn is_solved(&self) -> bool {
        self.layout.is_round_off(self.left(), &self.s)
    }
}
