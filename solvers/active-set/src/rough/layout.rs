//! A packing with friction in mass-scaled unknowns, where every `W_αα` is 1, and what contacts do in it.

use contact::law::{clip, non_negative};
use contact::scaled::scaled_velocity;
use contact::{Column, Mass, Packing, RoughColumn, RoughDiscs, Touch, Vector};
use nalgebra::{Vector2, Vector3};

/// The share of the terms that make v up which is round-off (–).
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// Status of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Status {
    Open,
    Stick,
    /// To the side where the tangential impulse has this sign.
    Slide(f64),
}

/// The packing: v = H̃ᵗ (`free` + H̃ s) + `offset`.
#[derive(Clone)]
pub(super) struct Layout {
    pub(super) columns: Vec<RoughColumn>,
    /// √`W_αα` (kg^-½).
    unit: Vec<Vector2<f64>>,
    /// c/√`W_αα` (√J).
    offset: Vec<Vector2<f64>>,
    /// M^½ `V_free` (√J).
    free: Vec<Vector3<f64>>,
    /// See [`terms_of_b`] (√J).
    terms_of_b: f64,
}

impl Layout {
    pub(super) fn new(problem: &Packing<RoughDiscs>) -> Self {
        let inverse_mass = |grain: u32| Mass::<Vector3<f64>>::inverse(problem.mass()[grain as usize], 1.0);
        let column = |contact| RoughColumn::new(contact, contact.ends(), inverse_mass, true);
        let (columns, unit): (Vec<_>, Vec<_>) = problem.contacts().iter().map(column).unzip();
        let offset: Vec<_> =
            problem.contacts().iter().zip(&unit).map(|(at, unit)| at.offset.component_div(unit)).collect();
        let free = scaled_velocity(problem, &vec![0.0; problem.impulse_count()]);
        let terms_of_b = terms_of_b(&columns, &offset, &free);
        Self { columns, unit, offset, free, terms_of_b }
    }

    /// See [`terms_of_b`] (√J).
    pub(super) fn terms_of_b(&self) -> f64 {
        self.terms_of_b
    }

    /// Grains.
    pub(super) fn grains(&self) -> usize {
        self.free.len()
    }

    /// The impulses `r` (N·s) as s (√J).
    pub(super) fn scaled(&self, r: &[f64]) -> Vec<Vector2<f64>> {
        self.unit.iter().enumerate().map(|(k, unit)| Vector2::at(r, k).component_mul(unit)).collect()
    }

    /// The nearest impulses to s that the law admits (N·s).
    pub(super) fn impulses(&self, s: &[Vector2<f64>], r: &mut [f64]) {
        for (k, ((s, unit), column)) in s.iter().zip(&self.unit).zip(&self.columns).enumerate() {
            admissible(*s, column.friction()).component_div(unit).put(r, k);
        }
    }

    /// H̃ s (√J).
    pub(super) fn pushed(&self, s: &[Vector2<f64>]) -> Vec<Vector3<f64>> {
        let mut y = vec![Vector3::zeros(); self.free.len()];
        for (column, s) in self.columns.iter().zip(s) {
            column.push(*s, &mut y);
        }
        y
    }

    /// v of s (√J).
    pub(super) fn velocity(&self, s: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        let mut y = self.free.clone();
        for (column, s) in self.columns.iter().zip(s) {
            column.push(*s, &mut y);
        }
        self.columns.iter().zip(&self.offset).map(|(column, c)| column.relative(&y) + c).collect()
    }

    /// Returns the residual of the law, weighed as energy: the natural map (√J).
    pub(super) fn left(&self, s: &[Vector2<f64>], v: &[Vector2<f64>]) -> f64 {
        let of = |((s, v), column): ((&Vector2<f64>, &Vector2<f64>), &RoughColumn)| {
            let bound = column.friction() * non_negative(s.x);
            let normal = if v.x >= s.x { s.x } else { v.x };
            let tangential = s.y - clip(s.y - v.y, bound);
            normal * normal + tangential * tangential
        };
        s.iter().zip(v).zip(&self.columns).map(of).sum::<f64>().sqrt()
    }

    /// Reports whether the residual `left` (√J) of the impulses s is round-off.
    pub(super) fn is_round_off(&self, left: f64, s: &[Vector2<f64>]) -> bool {
        left <= ROUND_OFF * (norm(s) + self.terms_of_b)
    }

    /// The statuses that s − v has.
    pub(super) fn statuses(&self, s: &[Vector2<f64>], v: &[Vector2<f64>]) -> Vec<Status> {
        let status = |((s, v), column): ((&Vector2<f64>, &Vector2<f64>), &RoughColumn)| {
            let moved = s - v;
            let bound = column.friction() * moved.x;
            if moved.x <= 0.0 {
                Status::Open
            } else if moved.y >= bound {
                Status::Slide(1.0)
            } else if moved.y <= -bound {
                Status::Slide(-1.0)
            } else {
                Status::Stick
            }
        };
        s.iter().zip(v).zip(&self.columns).map(status).collect()
    }
}

/// The impulse that acts against a relative velocity v: along the boundary of the cone where the contact slides, none where it is
/// open.
pub(super) fn against(status: Status, column: &RoughColumn, v: Vector2<f64>) -> Option<Vector2<f64>> {
    match status {
        Status::Open => None,
        Status::Stick => Some(v),
        Status::Slide(sign) => Some(Vector2::new(v.x, sign * column.friction() * v.x)),
    }
}

/// The part of a velocity that a contact must not have.
pub(super) fn held(status: Status, v: Vector2<f64>) -> Vector2<f64> {
    match status {
        Status::Open => Vector2::zeros(),
        Status::Stick => v,
        Status::Slide(_) => Vector2::new(v.x, 0.0),
    }
}

/// Returns the size of the velocities v that contacts with these statuses must not have (√J).
pub(super) fn moving(status: &[Status], v: &[Vector2<f64>]) -> f64 {
    norm(&v.iter().zip(status).map(|(v, status)| held(*status, *v)).collect::<Vec<_>>())
}

/// The nearest impulse of the cone along its own tangent.
pub(super) fn admissible(s: Vector2<f64>, friction: f64) -> Vector2<f64> {
    let normal = non_negative(s.x);
    Vector2::new(normal, clip(s.y, friction * normal))
}

/// √ of the sum of squares.
pub(super) fn norm(s: &[Vector2<f64>]) -> f64 {
    s.iter().map(Vector2::norm_squared).sum::<f64>().sqrt()
}

/// √ of the sum of squares of the terms of which b is the sum, M^½ `V_free` of the grains and c of the contacts (√J).
pub(super) fn terms_of_b(columns: &[RoughColumn], offset: &[Vector2<f64>], free: &[Vector3<f64>]) -> f64 {
    let of = |(column, c): (&RoughColumn, &Vector2<f64>)| {
        column.places().map(|place| free[place as usize].norm_squared()).iter().sum::<f64>()
            + c.norm_squared()
    };
    columns.iter().zip(offset).map(of).sum::<f64>().sqrt()
}
