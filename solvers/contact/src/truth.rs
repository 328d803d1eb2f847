//! The truth that iterates are compared with.

use crate::problem::ContactProblem;
use nalgebra::Vector2;

/// What is unique of the solution of a problem: its velocity and its energy. Impulses need not be.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    velocity: Vec<Vector2<f64>>,
    energy: f64,
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
