//! One contact as a sweep needs it.

use contact::ContactProblem;
use nalgebra::Vector2;

pub(crate) struct Row {
    candidate: u32,
    /// A wall is the last "grain", of infinite mass and at rest: its own motion is in `offset`.
    antagonist: u32,
    normal: Vector2<f64>,
    offset: f64,
    /// 1/`W_αα` (kg).
    pub(crate) inverse_delassus: f64,
    /// 1/mass of candidate and antagonist (1/kg).
    inverse_mass: [f64; 2],
}

impl Row {
    pub(crate) fn new(problem: &ContactProblem, contact: u32) -> Self {
        let contact = &problem.contacts()[contact as usize];
        let inverse_mass = [
            1.0 / problem.mass()[contact.candidate as usize],
            contact.antagonist.map_or(0.0, |j| 1.0 / problem.mass()[j as usize]),
        ];
        Self {
            candidate: contact.candidate,
            antagonist: contact.antagonist.unwrap_or(problem.grain_count() as u32),
            normal: contact.normal,
            offset: contact.offset,
            inverse_delassus: 1.0 / (inverse_mass[0] + inverse_mass[1]),
            inverse_mass,
        }
    }

    /// v = Hᵗ V + c at this contact.
    #[inline]
    pub(crate) fn relative(&self, velocity: &[Vector2<f64>]) -> f64 {
        let (i, j) = (self.candidate as usize, self.antagonist as usize);
        self.normal.dot(&(velocity[i] - velocity[j])) + self.offset
    }

    /// V ← V + M⁻¹ `h_α` Δr.
    #[inline]
    pub(crate) fn push(&self, change: f64, velocity: &mut [Vector2<f64>]) {
        let (i, j) = (self.candidate as usize, self.antagonist as usize);
        let impulse = self.normal * change;
        velocity[i] += impulse * self.inverse_mass[0];
        velocity[j] -= impulse * self.inverse_mass[1];
    }
}

/// V = `V_free` + M⁻¹ H r of the grains, and a wall's rest as the last.
pub(crate) fn start_velocity(problem: &ContactProblem, r: &[f64]) -> Vec<Vector2<f64>> {
    let grains = problem.grain_count();
    let mut velocity = vec![Vector2::zeros(); grains + 1];
    problem.velocity(r, &mut velocity[..grains]);
    velocity
}
