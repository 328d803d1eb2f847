//! Upper bounds of the greatest eigenvalues of W and of W_D⁻¹ W, in one pass over the contacts: cheap enough for a method to
//! take its step length from.

use contact::{
    Contact, ContactProblem, Frictional, Mechanics, Place, Rough, RoughDiscs, RoughSpheres, Smooth, Touch,
    greatest,
};
use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

/// Λ ≥ λmax(W_D⁻¹ W), in one pass over the contacts (–).
///
/// Both matrices are sums over grains: rᵗ W r = `Σ_i` |`Σ_α` n_α r_α|²/`m_i` and rᵗ W_D r = `Σ_i` `Σ_α` r_α²/`m_i`, α over
/// the contacts of grain i. Grain by grain the first is at most μ_i times the second, with μ_i the greatest eigenvalue of the
/// matrix `Σ_α` n nᵗ; so Λ = `max_i` μ_i. On a triangular crystal both are 3.
pub fn scaled_delassus_bound<const D: usize>(problem: &ContactProblem<Smooth<D>>) -> f64 {
    if D == 2 { in_plane(problem) } else { in_space(problem) }
}

fn in_plane<const D: usize>(problem: &ContactProblem<Smooth<D>>) -> f64 {
    // Σ n nᵗ as its trace k and its deviator (Σ cos 2φ, Σ sin 2φ): μ = (k + |deviator|)/2.
    let mut sums = vec![(0.0, Vector2::zeros()); problem.grain_count()];
    for contact in problem.contacts() {
        let n = contact.normal;
        let [x, y, _] = n.space();
        let deviator = Vector2::new(x * x - y * y, 2.0 * x * y);
        for grain in contact.grains() {
            let (trace, sum) = &mut sums[grain as usize];
            *trace += n.norm_squared();
            *sum += deviator;
        }
    }
    sums.iter().map(|(trace, deviator)| 0.5 * (trace + deviator.norm())).fold(0.0, f64::max)
}

fn in_space<const D: usize>(problem: &ContactProblem<Smooth<D>>) -> f64 {
    let mut sums = vec![Matrix3::zeros(); problem.grain_count()];
    for contact in problem.contacts() {
        let n = Vector3::from(contact.normal.space());
        contact.grains().for_each(|grain| sums[grain as usize] += n * n.transpose());
    }
    sums.iter().map(|sum| sum.symmetric_eigenvalues().max()).fold(0.0, f64::max)
}

/// Λ = `max_α` (`k_i/m_i` + `k_j/m_j`) ≥ λmax(W), where `k_i` contacts hold grain i: Gershgorin's circles, with
/// |`W_αβ`| ≤ 1/m for contacts that share a grain of mass m (1/kg).
pub fn delassus_bound<const D: usize>(problem: &ContactProblem<Smooth<D>>) -> f64 {
    let mut row = vec![0.0; problem.grain_count()];
    for contact in problem.contacts() {
        for grain in contact.grains() {
            row[grain as usize] += 1.0 / problem.mass()[grain as usize];
        }
    }
    let of_contact = |contact: &Contact<D>| {
        row[contact.candidate as usize] + contact.antagonist.map_or(0.0, |j| row[j as usize])
    };
    problem.contacts().iter().map(of_contact).fold(0.0, f64::max)
}

/// A mechanics in which λmax(W_D⁻¹ W) has a bound that costs one pass over the contacts.
pub trait Bounded: Mechanics {
    /// Λ ≥ λmax(W_D⁻¹ W) (–).
    fn scaled_delassus_bound(problem: &ContactProblem<Self>) -> f64;

    /// Λ ≥ λmax(W) (1/kg).
    fn delassus_bound(problem: &ContactProblem<Self>) -> f64 {
        Self::scaled_delassus_bound(problem) * greatest(problem.delassus_diagonal().into_iter())
    }
}

impl<const D: usize> Bounded for Smooth<D> {
    fn scaled_delassus_bound(problem: &ContactProblem<Self>) -> f64 {
        scaled_delassus_bound(problem)
    }

    fn delassus_bound(problem: &ContactProblem<Self>) -> f64 {
        delassus_bound(problem)
    }
}

impl Bounded for RoughDiscs {
    fn scaled_delassus_bound(problem: &ContactProblem<Self>) -> f64 {
        bound(problem, |sum| sum.symmetric_eigenvalues().max())
    }
}

impl Bounded for RoughSpheres {
    fn scaled_delassus_bound(problem: &ContactProblem<Self>) -> f64 {
        bound(problem, |sum| sum.symmetric_eigenvalues().max())
    }
}

/// Bound with friction, from the `greatest` eigenvalue of a matrix of a grain, as without friction: rᵗ W_D r =
/// `Σ_i` `Σ_α` (`r_n²` + (1 + m R²/I) `r_t²`)/`m_i`, so the matrix of grain i is the sum over its contacts of n nᵗ and, for each tangent,
/// h hᵗ/(1 + m R²/I), with n and h what an impulse along either does to the grain, its spin in units of √(m/I).
fn bound<const D: usize, const N: usize>(
    problem: &ContactProblem<Rough<D>>,
    greatest: impl Fn(&SMatrix<f64, N, N>) -> f64,
) -> f64
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    let mut sums = vec![SMatrix::zeros(); problem.grain_count()];
    for contact in problem.contacts() {
        for (k, grain) in contact.grains().enumerate() {
            let mass = problem.mass()[grain as usize];
            let arm = contact.arms[k] * (mass.mass / mass.inertia).sqrt();
            let sign = if k == 0 { 1.0 } else { -1.0 };
            for unknown in 0..D {
                let h = Rough::at_grain(
                    contact,
                    SVector::from_fn(|k, _| f64::from(u8::from(k == unknown))),
                    arm,
                    sign,
                );
                let weight = if unknown == 0 { 1.0 } else { 1.0 + arm * arm };
                sums[grain as usize] += h * h.transpose() / weight;
            }
        }
    }
    sums.iter().map(greatest).fold(0.0, f64::max)
}
