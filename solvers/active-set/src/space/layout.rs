//! A packing of spheres with friction in mass-scaled unknowns, where every `W_αα` is 1, and what contacts do in it.

use contact::law::{non_negative, tangential};
use contact::scaled::scaled_velocity;
use contact::{Column, Mass, Packing, RoughSpheres, SphereColumn, Touch, Vector};
use nalgebra::{Vector3, Vector6};

/// The share of the terms that make v up which is round-off (–).
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// Status of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Status {
    Open,
    Stick,
    Slide(Slide),
}

/// Tangents and stiffness of a sliding contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slide {
    /// d: the unit vector of the tangential part of s − v; none without friction and motion.
    pub(super) along: Vector3<f64>,
    /// e: the tangent across it.
    pub(super) across: Vector3<f64>,
    /// 1/κ_e = |`v_d`|/(μ `s_n`): an impulse against the velocity has `s_e`/κ_e + `v_e` = 0 (–). Infinite where nothing is to turn.
    pub(super) stiff: f64,
}

/// The packing: v = H̃ᵗ (`free` + H̃ s) + `offset`.
pub(super) struct Layout {
    pub(super) columns: Vec<SphereColumn>,
    /// √`W_αα` (kg^-½).
    unit: Vec<Vector3<f64>>,
    /// c/√`W_αα` (√J).
    offset: Vec<Vector3<f64>>,
    /// M^½ `V_free` (√J).
    free: Vec<Vector6<f64>>,
    /// √ of the sum of squares of the terms of which b is the sum, M^½ `V_free` of the grains and c of the contacts (√J).
    terms_of_b: f64,
}

impl Layout {
    pub(super) fn new(problem: &Packing<RoughSpheres>) -> Self {
        let inverse_mass = |grain: u32| Mass::<Vector6<f64>>::inverse(problem.mass()[grain as usize], 1.0);
        let column = |contact| SphereColumn::new(contact, contact.ends(), inverse_mass, true);
        let (columns, unit): (Vec<_>, Vec<_>) = problem.contacts().iter().map(column).unzip();
        let offset: Vec<_> =
            problem.contacts().iter().zip(&unit).map(|(at, unit)| at.offset.component_div(unit)).collect();
        let free = scaled_velocity(problem, &vec![0.0; problem.impulse_count()]);
        let of = |(column, c): (&SphereColumn, &Vector3<f64>)| {
            let terms = column.places().map(|place| free[place as usize].norm_squared());
            terms.iter().sum::<f64>() + c.norm_squared()
        };
        let terms_of_b = columns.iter().zip(&offset).map(of).sum::<f64>().sqrt();
        Self { columns, unit, offset, free, terms_of_b }
    }

    /// Grains.
    pub(super) fn grains(&self) -> usize {
        self.free.len()
    }

    /// The impulses `r` (N·s) as s (√J).
    pub(super) fn scaled(&self, r: &[f64]) -> Vec<Vector3<f64>> {
        self.unit.iter().enumerate().map(|(k, unit)| Vector3::at(r, k).component_mul(unit)).collect()
    }

    /// The nearest impulses to s that the law admits (N·s).
    pub(super) fn impulses(&self, s: &[Vector3<f64>], r: &mut [f64]) {
        for (k, ((s, unit), column)) in s.iter().zip(&self.unit).zip(&self.columns).enumerate() {
            admissible(*s, column.friction()).component_div(unit).put(r, k);
        }
    }

    /// y = M^½ `V_free` + H̃ s (√J).
    fn pushed(&self, s: &[Vector3<f64>]) -> Vec<Vector6<f64>> {
        let mut y = self.free.clone();
        for (column, s) in self.columns.iter().zip(s) {
            column.push(*s, &mut y);
        }
        y
    }

    /// v of s (√J).
    pub(super) fn velocity(&self, s: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let y = self.pushed(s);
        self.columns.iter().zip(&self.offset).map(|(column, c)| column.relative(&y) + c).collect()
    }

    /// Sweeps of non-linear Gauss-Seidel, with v + ε (s − centre) in the place of v:
    ///
    /// s⁺ of the law at a contact where v = `v_others` + (1 + ε) s, which is that of s − v/(1 + ε)
    pub(super) fn sweep(
        &self,
        epsilon: f64,
        centre: Option<&[Vector3<f64>]>,
        s: &mut [Vector3<f64>],
        sweeps: u32,
    ) {
        let mut y = self.pushed(s);
        let relaxation = (1.0 + epsilon).recip();
        for _ in 0..sweeps {
            for (k, (column, c)) in self.columns.iter().zip(&self.offset).enumerate() {
                let drawn = centre.map_or_else(Vector3::zeros, |centre| epsilon * (s[k] - centre[k]));
                let change = column.change(s[k], column.relative(&y) + c + drawn, relaxation);
                s[k] += change;
                column.push(change, &mut y);
            }
        }
    }

    /// Returns the residual of the law, weighed as energy: the natural map (√J).
    pub(super) fn left(&self, s: &[Vector3<f64>], v: &[Vector3<f64>]) -> f64 {
        let of = |((s, v), column): ((&Vector3<f64>, &Vector3<f64>), &SphereColumn)| {
            column.residual(*s, *v).norm_squared()
        };
        s.iter().zip(v).zip(&self.columns).map(of).sum::<f64>().sqrt()
    }

    /// Reports whether the residual `left` (√J) of the impulses s is round-off.
    pub(super) fn is_round_off(&self, left: f64, s: &[Vector3<f64>]) -> bool {
        left <= ROUND_OFF * (norm(s) + self.terms_of_b)
    }

    /// The statuses that s − v has.
    pub(super) fn statuses(&self, s: &[Vector3<f64>], v: &[Vector3<f64>]) -> Vec<Status> {
        s.iter().zip(v).zip(&self.columns).map(|((s, v), column)| status(*s, *v, column.friction())).collect()
    }
}

/// The status that s − v has.
fn status(s: Vector3<f64>, v: Vector3<f64>, friction: f64) -> Status {
    let moved = s - v;
    let (along, size) = tangential(moved);
    if moved.x <= 0.0 {
        return Status::Open;
    }
    if size < friction * moved.x {
        return Status::Stick;
    }
    if size == 0.0 {
        let none = Vector3::zeros();
        return Status::Slide(Slide { along: none, across: none, stiff: f64::INFINITY });
    }
    let along = along / size;
    // ρ = μ s_n/|ξ_t|, ξ = s − v; with s_t = μ s_n d, |ξ_t| = μ s_n + |v_d|, so that 1/κ_e = (1 − ρ)/ρ.
    let share = (friction * non_negative(s.x) / size).min(1.0);
    Status::Slide(Slide { along, across: Vector3::new(0.0, -along.z, along.y), stiff: (1.0 - share) / share })
}

/// The nearest impulse of the cone along its own tangent.
pub(super) fn admissible(s: Vector3<f64>, friction: f64) -> Vector3<f64> {
    let normal = non_negative(s.x);
    let (mut along, size) = tangential(s);
    if size > friction * normal {
        along *= friction * normal / size;
    }
    along.x = normal;
    along
}

/// √ of the sum of squares.
pub(super) fn norm(s: &[Vector3<f64>]) -> f64 {
    s.iter().map(Vector3::norm_squared).sum::<f64>().sqrt()
}
