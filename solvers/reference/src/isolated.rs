//! Isolation of a solution with friction: none other is near it.
//!
//! A contact is open, sticks, or slides in some direction, and as long as none changes, the law is a smooth system: in the plane a linear
//! one. Where each does so strictly and the derivative of that system is regular, the solution is the only one around with these
//! statuses, and those with others are away. In space a direction may turn, which bends the system; the theorem of Kantorovich
//! says how near a solution must be then.
//!
//! L. V. Kantorovich, G. P. Akilov, Functional Analysis, Pergamon (1982), chapter XVIII.

use cholesky::General;
use contact::law::tangential;
use contact::status::{Status, unit};
use contact::{Column, Cone, Frictional, Mass, Mechanics, Packing, Rough, Touch, Vector, Visited};
use nalgebra::SVector;

/// Measures of the isolation of a solution from others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isolation {
    /// The least change of an impulse or velocity that changes the status of a contact, in mass-scaled unknowns over the problem's
    /// scale (–).
    pub margin: f64,
    /// Impulses of contacts that are closed: as many as dimensions where one sticks, one less where it slides.
    pub unknowns: usize,
    /// The least singular value of the derivative, where `W_αα` = 1 (–); 0 where it is singular.
    pub least_singular_value: f64,
    /// Bound β on the norm of the inverse of the derivative of all of s − v (–); infinite where it is singular.
    pub inverse: f64,
    /// Bound L on the change of the derivative over that of s − v, times the problem's scale (–): 0 in the plane.
    pub curvature: f64,
    /// Bound on the residual of v(s(ξ)) − s(ξ) + ξ = 0, with ξ = s − v and s(ξ) of the law: of the natural map, which is known to round-off,
    /// times ‖W − 1‖ (–).
    pub left: f64,
}

/// Steps of inverse iteration: the value is known to some digits where it is far from the next, and its size where not.
const STEPS: u32 = 30;

/// Bound on the second derivative of a unit vector ξ/|ξ|, times |ξ|²: the golden ratio (–).
const TURNING: f64 = 1.618_033_988_749_895;

impl Isolation {
    /// Returns twice β times what is left, over the problem's scale (–): the greatest distance to a solution by the theorem of Kantorovich,
    /// which asks that β L times that be at most 1.
    pub fn error(&self) -> f64 {
        2.0 * self.inverse * self.left
    }

    /// Reports whether a solution is near that is the only one around: that within its error, where the next change of status is
    /// farther.
    pub fn is_isolated(&self) -> bool {
        self.margin > self.error() && self.inverse * self.curvature * self.error() <= 1.0
    }
}

/// An unknown impulse of a contact that is closed: what it does to the contact's grains, the velocity of theirs that it keeps, and
/// its own weight beside that.
struct Unknown<const N: usize> {
    push: [SVector<f64, N>; 2],
    pull: [SVector<f64, N>; 2],
    own: f64,
}

/// Returns the isolation of the solution `r` (N·s) of `problem` from others.
///
/// # Panics
/// If there are not as many numbers per contact as dimensions.
pub fn isolation<const D: usize, const N: usize>(problem: &Packing<Rough<D>>, r: &[f64]) -> Isolation
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    assert_eq!(r.len(), problem.impulse_count(), "as many numbers per contact as dimensions");
    let y = problem.scaled_velocity(r);
    let inverse_mass = |grain: u32| Mass::<SVector<f64, N>>::inverse(problem.mass()[grain as usize], 1.0);
    let (mut margin, mut left) = (f64::INFINITY, 0.0);
    let (mut turning, mut edge) = (0.0_f64, 1.0_f64);
    let mut unknowns: Vec<([u32; 2], Unknown<N>)> = Vec::new();
    // ‖W‖ is at most twice the greatest of these sums of squares of columns at a grain, since (a + b)² ≤ 2 a² + 2 b².
    let mut at_grain = vec![0.0; y.len()];
    for (k, contact) in problem.contacts().iter().enumerate() {
        let (column, own) = <Rough<D> as Mechanics>::Column::new(contact, contact.ends(), inverse_mass, true);
        let s = SVector::<f64, D>::at(r, k).component_mul(&own);
        let v = column.relative(&y) + contact.offset.component_div(&own);
        left += column.residual(s, v).norm_squared();
        let [i, j] = column.places();
        for unknown in 0..D {
            let [first, second] = column.pushes(unit(unknown));
            at_grain[i as usize] += first.norm_squared();
            at_grain[j as usize] += if i == j { 0.0 } else { second.norm_squared() };
        }
        let (moved, friction) = (s - v, column.friction());
        margin = margin.min(moved[0].abs());
        let size = tangential(moved).1;
        let mut add = |push: SVector<f64, D>, pull: SVector<f64, D>, own: f64| {
            let [push, pull] = [push, pull].map(|of| column.pushes(of));
            unknowns.push((column.places(), Unknown { push, pull, own }));
        };
        match Status::of(s, v, friction) {
            Status::Open => continue,
            Status::Stick => (0..D).for_each(|of| add(unit(of), unit(of), 0.0)),
            Status::Slide(slide) => {
                let along = slide.along;
                add(unit(0) + friction * along, unit(0), 0.0);
                if D == 3 && friction > 0.0 {
                    // ρ v + (1 − ρ) s = 0 across the direction, with ρ = μ s_n/|ξ_t| and ξ = s − v.
                    let share = friction * moved[0] / size;
                    let mut across = SVector::zeros();
                    (across[1], across[D - 1]) = (-along[D - 1], along[1]);
                    add(across * share, across, 1.0 - share);
                    turning = turning.max((friction + TURNING) / size);
                }
            }
        }
        if friction > 0.0 {
            margin = margin.min((size - friction * moved[0]).abs() / friction.hypot(1.0));
        }
        edge = edge.max(friction.hypot(1.0));
    }
    let scale = problem.scale().sqrt();
    let freedom = N * problem.grain_count();
    let value = if unknowns.len() > freedom { None } else { least_singular_value(&unknowns, y.len()) };
    let norm = 2.0 * at_grain.into_iter().fold(0.0, f64::max);
    // The derivative is [A 0; B 1]: A of the unknowns, and ‖B‖ ≤ (1 + ‖W‖) ‖∂s/∂ξ‖.
    let inverse = value.map_or(f64::INFINITY, |value| 1.0 + (1.0 + (1.0 + norm) * edge) / value);
    Isolation {
        margin: margin / scale,
        unknowns: unknowns.len(),
        least_singular_value: value.unwrap_or(0.0),
        inverse,
        curvature: (1.0 + norm) * turning * scale,
        left: norm.max(1.0) * (left.sqrt() / scale).max(f64::EPSILON),
    }
}

/// Returns the least singular value of the matrix pullᵗ push with the own weights on its diagonal, by inverse iteration; `None` if it is
/// singular.
fn least_singular_value<const N: usize>(unknowns: &[([u32; 2], Unknown<N>)], grains: usize) -> Option<f64> {
    let mut around = vec![Vec::new(); grains];
    for (k, ([i, j], _)) in unknowns.iter().enumerate() {
        around[*i as usize].push((k, 0));
        if i != j {
            around[*j as usize].push((k, 1));
        }
    }
    let mut entries: Vec<_> = unknowns.iter().enumerate().map(|(k, (_, of))| (k, k, of.own)).collect();
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
