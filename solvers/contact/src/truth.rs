//! What is known of a problem's solution: the truth that iterates are compared with, and the proof that there is none.

use crate::law;
use crate::problem::ContactProblem;
use nalgebra::Vector2;

/// What is unique of the solution of a problem: its velocity and its energy. Impulses need not be.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    pub(crate) velocity: Vec<Vector2<f64>>,
    pub(crate) energy: f64,
}

impl Truth {
    /// V* = `V_free` + M⁻¹ H r* and q* = q(r*) of impulses r* (N·s) that solve the problem. Whether they do is for
    /// their certificate to say, not for this type.
    pub fn new(problem: &ContactProblem, impulses: &[f64]) -> Self {
        let mut velocity = vec![Vector2::zeros(); problem.grain_count()];
        problem.velocity(impulses, &mut velocity);
        let mut v = vec![0.0; problem.contact_count()];
        problem.relative_velocity(&velocity, &mut v);
        let energy = ContactProblem::energy(impulses, &v, &problem.b());
        Self { velocity, energy }
    }

    /// V* (m/s).
    pub fn velocity(&self) -> &[Vector2<f64>] {
        &self.velocity
    }

    /// q* = −½ ‖V* − `V_free`‖²_M (J).
    pub fn energy(&self) -> f64 {
        self.energy
    }
}

/// How far, in units of the problem's own scale, a velocity must be from `V_free` to be called out of reach (–). A feasible
/// problem comes near it only where contacts leave a gap of some 1e-8 rad to escape through.
const OUT_OF_REACH: f64 = 1e8;

/// Round-off of H d relative to the size of its terms (–). A lever finer than this proves nothing.
const ROUND_OFF: f64 = 1e-14;

/// Whether the impulses `ray` prove that the problem has no solution (lemma of Farkas).
///
/// For d ≥ 0 and any admissible V, that is Hᵗ V + c ≥ 0, dᵗ (Hᵗ V + c) ≥ 0, hence
/// ‖V − `V_free`‖_M ≥ −bᵗ d / ‖H d‖_{M⁻¹}. If H d = 0 and bᵗ d < 0, there is no such V: the impulses d balance at every
/// grain, and on the whole they act against approach, whatever V. In floating point, this holds if the bound is above 1e8
/// √(Σ max(0, −b)²/`W_αα`), with ‖H d‖ raised by its round-off: no method, however slow, makes it hold on a problem whose
/// solution is nearer than that.
pub fn proves_infeasible(problem: &ContactProblem, ray: &[f64]) -> bool {
    let b = problem.b();
    let (mut work, mut scale, mut size) = (0.0, 0.0, 0.0);
    for ((d, b), w) in ray.iter().zip(&b).zip(problem.delassus_diagonal()) {
        work -= b * d;
        scale += law::non_negative(-b) * law::non_negative(-b) / w;
        size += w * d * d;
    }
    let mut resultant = vec![Vector2::zeros(); problem.grain_count()];
    problem.resultant(ray, &mut resultant);
    let squared = |(h_d, m): (&Vector2<f64>, &f64)| h_d.norm_squared() / m;
    let unbalanced = resultant.iter().zip(problem.mass()).map(squared).sum::<f64>().sqrt();
    let admissible = ray.iter().all(|d| *d >= 0.0);
    admissible && work > OUT_OF_REACH * f64::sqrt(scale) * (unbalanced + ROUND_OFF * f64::sqrt(size))
}
