//! Algebra of the second-order cone x₀ ≥ |x₁|, in one dimension or more: the product x ∘ z = (x · z, x₀ z₁ + z₀ x₁), and the
//! scaling of Nesterov and Todd, with which an interior point treats impulses and velocities alike.
//!
//! Yu. E. Nesterov, M. J. Todd, Self-scaled barriers and interior-point methods for convex programming, Math. Oper. Res. 22 (1997)
//! 1-42; in the form of L. Vandenberghe, The CVXOPT linear and quadratic cone program solvers (2010).

use contact::law::tangential;
use nalgebra::{SMatrix, SVector};

/// x₀² − |x₁|², in a form that does not cancel at the boundary.
fn determinant<const D: usize>(x: &SVector<f64, D>) -> f64 {
    let size = tangential(*x).1;
    (x[0] - size) * (x[0] + size)
}

/// x₀ z₀ − x₁ · z₁.
fn form<const D: usize>(x: &SVector<f64, D>, z: &SVector<f64, D>) -> f64 {
    2.0 * x[0] * z[0] - x.dot(z)
}

/// x ∘ z.
pub(crate) fn product<const D: usize>(x: &SVector<f64, D>, z: &SVector<f64, D>) -> SVector<f64, D> {
    let mut product = x * z[0] + z * x[0];
    product[0] = x.dot(z);
    product
}

/// Returns the z with x ∘ z = `product`, for x within the cone.
pub(crate) fn quotient<const D: usize>(product: &SVector<f64, D>, x: &SVector<f64, D>) -> SVector<f64, D> {
    let first = form(x, product) / determinant(x);
    let mut quotient = (product - x * first) / x[0];
    quotient[0] = first;
    quotient
}

/// Returns the length at which x + length × `change` leaves the cone.
pub(crate) fn reach<const D: usize>(x: &SVector<f64, D>, change: &SVector<f64, D>) -> f64 {
    let (square, half, constant) = (form(change, change), form(x, change), determinant(x));
    let root = (half * half - square * constant).max(0.0).sqrt();
    // Of both roots without cancelling.
    let sum = if half < 0.0 { root - half } else { -half - root };
    let leaves = |length: f64| length > 0.0 && length.is_finite();
    let of_first = if change[0] < 0.0 { -x[0] / change[0] } else { f64::INFINITY };
    [sum / square, constant / sum].into_iter().filter(|length| leaves(*length)).fold(of_first, f64::min)
}

/// The symmetric W with W z = W⁻¹ x = λ.
pub(crate) struct Scaling<const D: usize> {
    /// W/β = [w₀ w₁ᵗ; w₁ 1 + w₁ w₁ᵗ/(1 + w₀)], with w₀² − |w₁|² = 1.
    w: SVector<f64, D>,
    beta: f64,
}

impl<const D: usize> Scaling<D> {
    /// Returns the scaling of two points within the cone.
    pub(crate) fn new(x: &SVector<f64, D>, z: &SVector<f64, D>) -> Self {
        let [of_x, of_z] = [x, z].map(determinant);
        let (x, z) = (x / of_x.sqrt(), z / of_z.sqrt());
        let mut w = (x - z) / (2.0 + 2.0 * x.dot(&z)).sqrt();
        w[0] = tangential(w).1.hypot(1.0);
        Self { w, beta: (of_x / of_z).sqrt().sqrt() }
    }

    /// W x.
    pub(crate) fn times(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        rotate(&self.w, x) * self.beta
    }

    /// W⁻¹ x.
    pub(crate) fn inverse_times(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        let mut w = -self.w;
        w[0] = -w[0];
        rotate(&w, x) / self.beta
    }

    /// W².
    pub(crate) fn square(&self) -> SMatrix<f64, D, D> {
        let mut square = 2.0 * self.w * self.w.transpose() + SMatrix::identity();
        square[(0, 0)] -= 2.0;
        square * (self.beta * self.beta)
    }
}

/// W x/β of the scaling with this w.
fn rotate<const D: usize>(w: &SVector<f64, D>, x: &SVector<f64, D>) -> SVector<f64, D> {
    let first = w.dot(x);
    let mut rotated = x + w * (x[0] + (first - w[0] * x[0]) / (1.0 + w[0]));
    rotated[0] = first;
    rotated
}

#[cfg(test)]
mod tests {
    use super::{Scaling, product, quotient, reach};
    use nalgebra::{SVector, Vector2, Vector3};

    fn near<const D: usize>(a: SVector<f64, D>, b: SVector<f64, D>) -> bool {
        (a - b).norm() < 1e-12 * (a.norm() + b.norm())
    }

    #[test]
    fn a_scaling_takes_one_point_and_the_other_to_the_same() {
        let (x, z) = (Vector3::new(2.0, 0.3, -1.7), Vector3::new(0.5, -0.1, 0.45));
        let scaling = Scaling::new(&x, &z);
        let lambda = scaling.times(&z);
        assert!(near(lambda, scaling.inverse_times(&x)));
        assert!(near(scaling.square() * z, x));
        assert!((lambda.dot(&lambda) - x.dot(&z)).abs() < 1e-12);
        assert!(near(quotient(&product(&x, &z), &x), z));
    }

    #[test]
    fn a_reach_ends_on_the_boundary() {
        let x = Vector2::new(1.0, 0.5);
        for change in [
            Vector2::new(-1.0, 0.2),
            Vector2::new(1.0, 3.0),
            Vector2::new(0.0, -1.0),
            Vector2::new(-1.0, 1.0),
        ] {
            let end = x + reach(&x, &change) * change;
            assert!((end.x - end.y.abs()).abs() < 1e-12 && end.x >= 0.0, "{change}: {end}");
        }
        assert_eq!(reach(&x, &Vector2::new(1.0, 0.1)), f64::INFINITY);
    }
}
