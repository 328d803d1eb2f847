//! Coulomb's law at one contact with a full `W_αα`: 0 ≤ v_n ⊥ r_n ≥ 0, |r_t| ≤ μ r_n, v_t = 0 or r_t against it at its bound.
//!
//! The statuses are tried in turn: open, stick, slide. There is a solution, since `W_αα` is positive definite; where there are
//! several, the first one is taken.

use crate::quartic::{Quartic, roots};
use nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector3};

/// A contact whose own impulse is sought, all others kept.
pub(crate) struct Own<const D: usize> {
    /// `W_αα` (1/kg).
    w: SMatrix<f64, D, D>,
    /// `W_αα`⁻¹ (kg).
    inverse: SMatrix<f64, D, D>,
    /// μ (–).
    friction: f64,
    /// λ of [`against`] when it last slid, or 0.
    last: f64,
}

/// Exact solution of Coulomb's law at a contact with so many unknowns.
pub(crate) trait Exact<const D: usize> {
    /// Returns its impulse (N·s), where its relative velocity without it is `q` (m/s).
    fn impulse(&mut self, q: &SVector<f64, D>) -> SVector<f64, D>;
}

impl<const D: usize> Own<D> {
    /// A contact with a positive definite `W_αα` and μ.
    pub(crate) fn new(w: SMatrix<f64, D, D>, friction: f64) -> Self {
        let unit = |k: usize| SVector::from_fn(|row, _| f64::from(row == k));
        let columns: [SVector<f64, D>; D] = std::array::from_fn(|k| solved(&w, unit(k)));
        Self { w, inverse: SMatrix::from_columns(&columns), friction, last: 0.0 }
    }

    /// Returns the impulse that stops the contact point.
    fn stick(&self, q: &SVector<f64, D>) -> SVector<f64, D> {
        -(self.inverse * q)
    }
}

/// Without tangents: r = max(0, −q/w).
impl Exact<1> for Own<1> {
    fn impulse(&mut self, q: &SVector<f64, 1>) -> SVector<f64, 1> {
        SVector::<f64, 1>::new(if q[0] < 0.0 { -q[0] / self.w[0] } else { 0.0 })
    }
}

/// One tangent: sliding has two sides.
impl Exact<2> for Own<2> {
    fn impulse(&mut self, q: &Vector2<f64>) -> Vector2<f64> {
        if q.x >= 0.0 {
            return Vector2::zeros();
        }
        let (stick, Self { w, friction, .. }) = (self.stick(q), &*self);
        if sticks(stick.x, stick.y.abs(), *friction) {
            return stick;
        }
        let slide = |side: f64| {
            let sum = w[(0, 0)] + side * friction * w[(0, 1)];
            let r = Vector2::new(1.0, side * friction) * (-q.x / sum);
            // Which must be against the side.
            let along = side * (w * r + q).y;
            (r, if sum > 0.0 { along } else { f64::INFINITY })
        };
        let side = stick.y.signum();
        let (first, second) = (slide(side), slide(-side));
        // The least also where round-off leaves neither.
        if first.1 <= 0.0 || first.1 <= second.1 { first.0 } else { second.0 }
    }
}

/// Two tangents. With `r_t` = μ `r_n` e, |e| = 1, v_n = 0 gives `r_n` = −`q_n`/d(e), d = `w_nn` + μ `w_nT` · e; and d v_T = a + B e,
/// with a = `w_nn` `q_T` − `q_n` `w_Tn`, B = μ (`q_T` `w_nT` − `q_n` `W_TT`), must be against e.
///
/// Of several such e the one with the least λ is taken, [`against`]; where that finds none, the directions are roots of a quartic.
/// (O. Bonnefon, G. Daviet, Quartic formulation of Coulomb 3D frictional contact, INRIA technical report RT-0400 (2011).)
impl Exact<3> for Own<3> {
    fn impulse(&mut self, q: &Vector3<f64>) -> Vector3<f64> {
        if q.x >= 0.0 {
            return Vector3::zeros();
        }
        let stick = self.stick(q);
        let tangential = Vector2::new(stick.y, stick.z);
        if sticks(stick.x, tangential.norm(), self.friction) {
            return stick;
        }
        let Self { w, friction, last, .. } = self;
        let (w_nt, w_tn) = (Vector2::new(w[(0, 1)], w[(0, 2)]), Vector2::new(w[(1, 0)], w[(2, 0)]));
        let (w_tt, q_t) = (w.fixed_view::<2, 2>(1, 1).into_owned(), Vector2::new(q.y, q.z));
        let a = q_t * w[(0, 0)] - w_tn * q.x;
        let b = (q_t * w_nt.transpose() - w_tt * q.x) * *friction;
        let sum = |e: Vector2<f64>| w[(0, 0)] + *friction * w_nt.dot(&e);
        let slide = |e: Vector2<f64>| Vector3::new(1.0, *friction * e.x, *friction * e.y) * (-q.x / sum(e));
        if let Some((e, lambda)) = against(&a, &b, *last).filter(|(e, _)| sum(*e) > 0.0) {
            *last = lambda;
            return slide(e);
        }
        let mut best: Option<(f64, Vector2<f64>)> = None;
        for half in [1.0, -1.0] {
            // e = ±[1 − t², 2t]/(1 + t²)
            let (found, count) = roots(&across(&(a * half), &b));
            for t in &found[..count] {
                let e = Vector2::new(1.0 - t * t, 2.0 * t) * (half / (1.0 + t * t));
                let along = e.dot(&(a + b * e));
                if sum(e) > 0.0 && best.is_none_or(|(least, _)| along < least) {
                    best = Some((along, e));
                }
            }
        }
        // All directions are roots where nothing moves along the tangents.
        let else_along = || tangential.try_normalize(0.0).unwrap_or_else(Vector2::x);
        slide(best.map_or_else(else_along, |(_, e)| e))
    }
}

/// Returns the e, |e| = 1, with a + B e = λ e for the one λ ≤ 0 below which the symmetric part of B − λ is positive definite, and λ; `None`
/// where there is none, as where |B⁻¹ a| is below 1. All other e have a greater λ. The search begins at `last`.
///
/// |x| of x = −(B − λ)⁻¹ a rises from 0 with λ up to the least eigenvalue of the symmetric part, since d|x|²/dλ = 2 xᵗ (B − λ)⁻¹ x > 0, and
/// is 1 at most once. 1/|x| is nearly a line: Newton's method on it takes a few steps, within |a| of the upper end. (J. J. Moré, D. C.
/// Sorensen, Computing a trust region step, SIAM J. Sci. Stat. Comput. 4 (1983) 553-572.) It works with x det(B − λ), which takes no
/// division.
fn against(a: &Vector2<f64>, b: &Matrix2<f64>, last: f64) -> Option<(Vector2<f64>, f64)> {
    let both = b[(0, 1)] + b[(1, 0)];
    let is_definite = b[(0, 0)] > 0.0 && b[(0, 0)] * b[(1, 1)] > 0.25 * both * both;
    let least = || 0.5 * (b[(0, 0)] + b[(1, 1)] - (b[(0, 0)] - b[(1, 1)]).hypot(both));
    let top = if is_definite { 0.0 } else { f64::min(0.0, least()) };
    let (mut low, mut high) = (top - a.norm(), top);
    let mut lambda = if last > low && last < top { last } else { top };
    // Halving alone would take as many steps as a number has bits.
    for _ in 0..100 {
        let (first, second) = (b[(0, 0)] - lambda, b[(1, 1)] - lambda);
        let determinant = first * second - b[(0, 1)] * b[(1, 0)];
        let x = Vector2::new(b[(0, 1)] * a.y - second * a.x, b[(1, 0)] * a.x - first * a.y);
        let squared = x.norm_squared();
        let size = squared.sqrt();
        if lambda == top && !(size >= determinant) {
            return None;
        }
        if size > determinant {
            high = lambda;
        } else {
            low = lambda;
        }
        // xᵗ (B − λ)⁻¹ x det(B − λ)
        let slope = second * x.x * x.x - both * x.x * x.y + first * x.y * x.y;
        let newton = lambda + squared * (determinant - size) / slope;
        let next = if newton > low && newton < high {
            newton
        } else if newton >= top && high == top {
            top
        } else {
            0.5 * (low + high)
        };
        if (next - lambda).abs() <= 2.0 * f64::EPSILON * lambda.abs() || size == determinant {
            return Some((x / size, lambda));
        }
        lambda = next;
    }
    None
}

/// (1 + t²)² times the part of a + B e across e, e = [1 − t², 2t]/(1 + t²).
fn across(a: &Vector2<f64>, b: &Matrix2<f64>) -> Quartic {
    let (b12, b21, both) = (b[(0, 1)], b[(1, 0)], b[(1, 1)] - b[(0, 0)]);
    [a.y + b21, 2.0 * (both - a.x), -4.0 * b12 - 2.0 * b21, -2.0 * (both + a.x), b21 - a.y]
}

/// Returns `W_αα`⁻¹ q by elimination, whose pivots are positive.
fn solved<const D: usize>(w: &SMatrix<f64, D, D>, q: SVector<f64, D>) -> SVector<f64, D> {
    let (mut w, mut r) = (*w, q);
    for k in 0..D {
        for row in k + 1..D {
            let factor = w[(row, k)] / w[(k, k)];
            for column in k..D {
                w[(row, column)] -= factor * w[(k, column)];
            }
            r[row] -= factor * r[k];
        }
    }
    for k in (0..D).rev() {
        let known: f64 = (k + 1..D).map(|column| w[(k, column)] * r[column]).sum();
        r[k] = (r[k] - known) / w[(k, k)];
    }
    r
}

fn sticks(normal: f64, along: f64, friction: f64) -> bool {
    normal >= 0.0 && along <= friction * normal
}
