//! The truth that iterates are compared with.

use crate::discs::Discs;
use crate::mechanics::Mechanics;
use crate::problem::ContactProblem;
use crate::vector::Vector;

/// Unique part of the solution of a problem: its velocity and its energy. Impulses need not be. With friction neither is: this
/// is then one of the solutions.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth<M: Mechanics = Discs> {
    velocity: Vec<M::Velocity>,
    energy: f64,
}

impl<M: Mechanics> Truth<M> {
    /// V* = `V_free` + M⁻¹ H r* and q* = q(r*) of impulses r* (N·s) that solve the problem. Whether they do is for
    /// their certificate to say, not for this type.
    pub fn new(problem: &ContactProblem<M>, impulses: &[f64]) -> Self {
        let mut velocity = vec![M::Velocity::ZERO; problem.grain_count()];
        problem.velocity(impulses, &mut velocity);
        let mut v = vec![0.0; problem.impulse_count()];
        problem.relative_velocity(&velocity, &mut v);
        let energy = ContactProblem::<M>::energy(impulses, &v, &problem.b());
        Self { velocity, energy }
    }

    /// V* (m/s).
    pub fn velocity(&self) -> &[M::Velocity] {
        &self.velocity
    }

    /// q* = −½ ‖V* − `V_free`‖²_M (J).
    pub fn energy(&self) -> f64 {
        self.energy
    }
}
