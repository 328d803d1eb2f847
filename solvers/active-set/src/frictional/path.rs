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
use contact::Visited;
use contact::status::Status;
use line::{End, Line};
use nalgebra::{Vector2, Vector3};

/// Lines of one path, at most.
const LINES: u32 = 200;

/// Changes of status after which the matrix is factorised anew.
const CHANGES: usize = 30;

/// Largest motion of held velocities along a line over the change of the impulses (–). With 1e-10 some of 400 paths end 1e-9 beside a
/// solution.
const ALONG: f64 = 1e-12;

/// The problem that a path changes.
#[derive(Clone, Copy)]
pub(super) struct Change<'a> {
    pub(super) layout: &'a Layout<2, 3>,
    /// ε (–) and the centre (√J).
    pub(super) drawn: Drawn<'a, 2>,
    /// p (√J).
    pub(super) perturbation: &'a [Vector2<f64>],
}

impl Change<'_> {
    /// Returns v + ε (s − centre) + t p (√J).
    pub(super) fn velocity(&self, s: &[Vector2<f64>], t: f64) -> Vec<Vector2<f64>> {
        let mut v = self.drawn.velocity(self.layout, s);
        v.iter_mut().zip(self.perturbation).for_each(|(v, p)| *v += t * p);
        v
    }
}

/// A solution of the law, and the problem that the path changes.
pub(super) struct Path<'a> {
    pub(super) change: Change<'a>,
    pub(super) matrix: &'a mut Matrix<2, 3>,
    pub(super) status: Vec<Status<2>>,
    /// √J.
    pub(super) s: Vec<Vector2<f64>>,
}

impl Path<'_> {
    /// Follows the path from s at t = 1, the solution that goes with `status`, to t = 0. Returns the lines that it had; `None` where it
    /// comes back to where it began, or has too many.
    pub(super) fn follow(&mut self) -> Option<u32> {
        let start = self.status.clone();
        let (mut t, mut crossed, mut away_from_start) = (1.0, None::<(usize, Status<2>)>, 0_usize);
        if !self.matrix.is_of(&self.status, self.change.drawn.epsilon) && !self.factorise() {
            return None;
        }
        let (mut v, mut ds) = (self.change.velocity(&self.s, t), self.unknown());
        for line in 0..LINES {
            let along = self.respond(ds);
            let forth = crossed.is_some_and(|(contact, before)| self.enters(contact, before, &along));
            let sign = if forth { 1.0 } else { -1.0 };
            let end = self.end(crossed, &v, sign, &along);
            let arrives = !forth && end.is_none_or(|end| end.at >= t);
            let far = if arrives { t } else { end?.at };
            for (s, ds) in self.s.iter_mut().zip(&along.ds) {
                *s += sign * far * ds;
            }
            t = if arrives { 0.0 } else { t + sign * far };
            v = self.correct(t);
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
            if away_from_start == 0 {
                return None;
            }
            ds = self.update(contact, before, along)?;
            crossed = Some((contact, before));
        }
        None
    }

    /// Returns the response to begin with where none is known (√J).
    fn unknown(&self) -> Vec<Vector2<f64>> {
        vec![Vector2::zeros(); self.s.len()]
    }

    /// The change of s, near ds, and of v, that answers p: such that nothing moves that is held.
    fn respond(&mut self, mut ds: Vec<Vector2<f64>>) -> Line {
        let Change { layout, drawn, perturbation } = self.change;
        let velocity = |ds: &[Vector2<f64>]| {
            let y = layout.pushed(vec![Vector3::zeros(); layout.grains()], ds);
            let of = layout.columns.iter().zip(ds).zip(perturbation);
            of.map(|((column, ds), p)| column.relative(&y) + drawn.epsilon * ds + p).collect()
        };
        let dv = self.matrix.settle(&layout.columns, &mut ds, velocity, |ds, _, left| {
            left <= ALONG * (norm(ds) + norm(perturbation))
        });
        Line { ds, dv }
    }

    /// Takes back what moves of that which is held, at t: round-off of the line that led there. Returns v (√J).
    fn correct(&mut self, t: f64) -> Vec<Vector2<f64>> {
        let change = self.change;
        let velocity = |s: &[Vector2<f64>]| change.velocity(s, t);
        let is_enough = |s: &[Vector2<f64>], _: &[_], left| change.layout.is_round_off(left, s);
        self.matrix.settle(&change.layout.columns, &mut self.s, velocity, is_enough)
    }

    /// Factorises the matrix of the statuses and reports whether it has an inverse.
    fn factorise(&mut self) -> bool {
        self.matrix.factorise(&self.change.layout.columns, &self.status, self.change.drawn.epsilon)
    }

    /// Updates the factor after a contact changed its status at the end of a line. Returns the response that follows from that of the line;
    /// `None` where the matrix has no inverse.
    fn update(&mut self, contact: usize, before: Status<2>, along: Line) -> Option<Vec<Vector2<f64>>> {
        if self.matrix.changes() >= CHANGES {
            return self.factorise().then(|| self.unknown());
        }
        let Line { mut ds, dv } = along;
        // Held velocities are −ε ds; their dv is round-off.
        let v =
            dv[contact] - before.unmet(ds[contact], dv[contact]) - self.change.drawn.epsilon * ds[contact];
        let columns = &self.change.layout.columns;
        self.matrix.change(columns, contact, self.status[contact], v, &mut ds).then_some(ds)
    }
}
