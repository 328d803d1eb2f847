//! Exact proximal points in the plane: a path leads from one to the next.

use super::newton::Newton;
use super::path::{Change, Path};
use super::points::{PointSolver, Progress};
use crate::layout::{Drawn, Layout};
use contact::status::Status;
use nalgebra::Vector2;

/// A solution of the law with v in the place of `v(s)`.
pub(super) struct Exact {
    /// √J.
    s: Vec<Vector2<f64>>,
    /// √J.
    v: Vec<Vector2<f64>>,
    status: Vec<Status<2>>,
}

impl Exact {
    /// Takes the statuses of s − v; the law holds for the nearest admissible impulses to s − v, with the velocities that lead there.
    fn of(layout: &Layout<2, 3>, s: &[Vector2<f64>], v: &[Vector2<f64>]) -> Self {
        let moved: Vec<_> = s.iter().zip(v).map(|(s, v)| s - v).collect();
        let status = layout.statuses(s, v);
        let s = layout.admitted(&moved);
        let v = s.iter().zip(&moved).map(|(s, moved)| s - moved).collect();
        Self { s, v, status }
    }
}

impl PointSolver<2, 3> for Exact {
    fn begin(newton: &Newton<2, 3>, s: &[Vector2<f64>]) -> Self {
        Self::of(&newton.layout, s, &newton.layout.velocity(s))
    }

    fn advance(&mut self, newton: &mut Newton<2, 3>, epsilon: f64) -> Progress {
        let Some((layout, matrix)) = newton.parts() else { return Progress::Missed };
        let drawn = Drawn { epsilon, centre: Some(&self.s) };
        let of_s = layout.velocity(&self.s);
        let perturbation: Vec<_> = self.v.iter().zip(&of_s).map(|(v, of_s)| v - of_s).collect();
        let (s, status) = (self.s.clone(), self.status.clone());
        let change = Change { layout, drawn, perturbation: &perturbation };
        let mut path = Path { change, matrix, status, s };
        let Some(steps) = path.follow() else { return Progress::Missed };
        *self = Self::of(layout, &path.s, &change.velocity(&path.s, 0.0));
        Progress::Reached { steps }
    }

    fn s(&self) -> &[Vector2<f64>] {
        &self.s
    }
}
