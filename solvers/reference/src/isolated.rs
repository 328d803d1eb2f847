//! Isolation of a solution with friction: none other is near it.
//!
//! A contact is open, sticks, or slides to one side, and as long as none changes, the law is a linear system. Where each does so
//! strictly and the matrix of that system is regular, the solution is the only one with these statuses, and those with others are
//! away.

use cholesky::General;
use contact::{Column, Cone, Mass, Packing, RoughColumn, RoughDiscs, Touch, Vector, Visited};
use nalgebra::{Vector2, Vector3};

/// Measures of the isolation of a solution from others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isolation {
    /// The least change of an impulse or velocity that changes the status of a contact, in mass-scaled unknowns over the problem's
    /// scale (–).
    pub margin: f64,
    /// Impulses of contacts that are closed: two where one sticks, one where it slides.
    pub unknowns: usize,
    /// The least singular value of the matrix of these statuses, where `W_αα` = 1 (–); 0 where it is singular.
    pub least_singular_value: f64,
    /// Residual of the solution: its natural map (–).
    pub left: f64,
}

/// Factor by which a change of status must be beyond the error of the solution (–).
const BEYOND: f64 = 10.0;

/// Steps of inverse iteration: the value is known to some digits where it is far from the next, and its size where not.
const STEPS: u32 = 30;

impl Isolation {
    /// Reports whether a solution is near that is the only one around: the impulses are away from it by what they leave of the law, which
    /// is known to round-off, over the least singular value, and the next change of status is farther.
    pub fn is_isolated(&self) -> bool {
        self.margin * self.least_singular_value > BEYOND * self.left.max(f64::EPSILON)
    }
}

/// An unknown impulse of a contact that is closed: what it does to the contact's grains, and the velocity of theirs that it keeps.
struct Unknown {
    push: [Vector3<f64>; 2],
    pull: [Vector3<f64>; 2],
}

/// Returns the isolation of the solution `r` (N·s) of `problem` from others.
///
/// # Panics
/// If there are not two numbers per contact.
pub fn isolation(problem: &Packing<RoughDiscs>, r: &[f64]) -> Isolation {
    assert_eq!(r.len(), problem.impulse_count(), "two numbers per contact");
    let y = problem.scaled_velocity(r);
    let inverse_mass = |grain: u32| Mass::<Vector3<f64>>::inverse(problem.mass()[grain as usize], 1.0);
    let (mut margin, mut left) = (f64::INFINITY, 0.0);
    let mut unknowns: Vec<([u32; 2], Unknown)> = Vec::new();
    for (k, contact) in problem.contacts().iter().enumerate() {
        let (column, unit) = RoughColumn::new(contact, contact.ends(), inverse_mass, true);
        let s = Vector2::at(r, k).component_mul(&unit);
        let v = column.relative(&y) + contact.offset.component_div(&unit);
        left += (column.change(s, v, 1.0)).norm_squared();
        let (moved, friction) = (s - v, column.friction());
        margin = margin.min(moved.x.abs());
        if moved.x <= 0.0 {
            continue;
        }
        let [normal, tangent] = [Vector2::x(), Vector2::y()].map(|s| column.pushes(s));
        let bound = friction * moved.x;
        if friction > 0.0 {
            margin = margin.min((moved.y.abs() - bound).abs());
        }
        if moved.y.abs() < bound {
            unknowns.push((column.places(), Unknown { push: normal, pull: normal }));
            unknowns.push((column.places(), Unknown { push: tangent, pull: tangent }));
        } else {
            let push = column.pushes(Vector2::new(1.0, moved.y.signum() * friction));
            unknowns.push((column.places(), Unknown { push, pull: normal }));
        }
    }
    let scale = problem.scale().sqrt();
    let freedom = 3 * problem.grain_count();
    let value = if unknowns.len() > freedom { None } else { least_singular_value(&unknowns, y.len()) };
    Isolation {
        margin: margin / scale,
        unknowns: unknowns.len(),
        least_singular_value: value.unwrap_or(0.0),
        left: left.sqrt() / scale,
    }
}

/// Returns the least singular value of the matrix pullᵗ push, by inverse iteration; `None` if it is singular.
fn least_singular_value(unknowns: &[([u32; 2], Unknown)], grains: usize) -> Option<f64> {
    let mut around = vec![Vec::new(); grains];
    for (k, ([i, j], _)) in unknowns.iter().enumerate() {
        around[*i as usize].push((k, 0));
        if i != j {
            around[*j as usize].push((k, 1));
        }
    }
    let mut entries = Vec::new();
    for around in &around {
        for (row, side) in around {
            for (col, other) in around {
                let value = unknowns[*row].1.pull[*side].dot(&unknowns[*col].1.push[*other]);
                entries.push((*row, *col, value));
            }
        }
    }
    let count = unknowns.len();
    if count == 0 {
        return Some(1.0);
    }
    let factor = General::new(count, entries).ok()?;
    // Some vector that no symmetry of the packing has.
    let mut x: Vec<f64> = (0..count).map(|k| 1.0 + (k as f64 * 0.618_033_988_749_895).fract()).collect();
    let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut inverse = f64::NAN;
    for _ in 0..STEPS {
        let size = length(&x);
        for x in &mut x {
            *x /= size;
        }
        factor.solve_transposed(&mut x);
        factor.solve(&mut x);
        inverse = length(&x).sqrt();
    }
    let value = inverse.recip();
    value.is_finite().then_some(value)
}
