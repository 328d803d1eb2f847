//! H, Hᵗ, W and its diagonal, eq. (1). W is never assembled.

use crate::law;
use crate::mechanics::{Mass, Mechanics, Touch};
use crate::problem::ContactProblem;
use crate::vector::Vector;

impl<M: Mechanics> ContactProblem<M> {
    /// R = H r: the resultant of the contact impulses `r` on each grain (N·s).
    pub fn resultant(&self, r: &[f64], resultant: &mut [M::Velocity]) {
        resultant.fill(M::Velocity::ZERO);
        for (k, contact) in self.contacts().iter().enumerate() {
            contact.push(M::Impulse::at(r, k), resultant);
        }
    }

    /// V = `V_free` + M⁻¹ H r (m/s).
    pub fn velocity(&self, r: &[f64], velocity: &mut [M::Velocity]) {
        self.resultant(r, velocity);
        for ((v, m), v_free) in velocity.iter_mut().zip(self.mass()).zip(self.free_velocity()) {
            *v = *v_free + m.divides(*v);
        }
    }

    /// Returns y = M^½ (`V_free` + M⁻¹ H r) of the grains (√J).
    pub fn scaled_velocity(&self, r: &[f64]) -> Vec<M::Velocity> {
        let mut y = vec![M::Velocity::ZERO; self.grain_count()];
        self.velocity(r, &mut y);
        y.iter_mut().zip(self.mass()).for_each(|(y, mass)| *y = mass.root().times(*y));
        y
    }

    /// v = Hᵗ V + c (m/s).
    pub fn relative_velocity(&self, velocity: &[M::Velocity], v: &mut [f64]) {
        for (k, contact) in self.contacts().iter().enumerate() {
            (contact.relative(velocity) + contact.offset()).put(v, k);
        }
    }

    /// b = Hᵗ `V_free` + c: the relative velocities without contact impulses (m/s).
    pub fn b(&self) -> Vec<f64> {
        let mut b = vec![0.0; self.impulse_count()];
        self.relative_velocity(self.free_velocity(), &mut b);
        b
    }

    /// W p = Hᵗ M⁻¹ (H p): two passes over the contacts. `scratch` has one value per grain.
    pub fn delassus_product(&self, p: &[f64], product: &mut [f64], scratch: &mut [M::Velocity]) {
        self.resultant(p, scratch);
        for (v, m) in scratch.iter_mut().zip(self.mass()) {
            *v = m.divides(*v);
        }
        for (k, contact) in self.contacts().iter().enumerate() {
            contact.relative(scratch).put(product, k);
        }
    }

    /// `W_αα` = `1/m_i` + `1/m_j`, or `1/m_i` at a wall, and so for each unknown of a contact (1/kg).
    pub fn delassus_diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.impulse_count()];
        for (k, contact) in self.contacts().iter().enumerate() {
            contact.diagonal(|grain| self.mass()[grain as usize].inverse(1.0)).put(&mut diagonal, k);
        }
        diagonal
    }

    /// Σ max(0, −b)²/`W_αα` of the normals (J): the scale of the impulses' work, fixed by the problem. It is 0 where no contact
    /// pushes: the solution is then r = 0.
    pub fn scale(&self) -> f64 {
        let squared = |(b, w): (&f64, &f64)| law::non_negative(-b) * law::non_negative(-b) / w;
        let (b, w) = (self.b(), self.delassus_diagonal());
        b.iter().zip(&w).step_by(M::Impulse::LEN).map(squared).sum()
    }

    /// q(r) = ½ rᵗ W r + bᵗ r, from v = W r + b: ½ rᵗ (v + b) (J).
    pub fn energy(r: &[f64], v: &[f64], b: &[f64]) -> f64 {
        0.5 * r.iter().zip(v).zip(b).map(|((r, v), b)| r * (v + b)).sum::<f64>()
    }

    /// ‖V − U‖_M of two velocity fields (√J).
    pub fn velocity_distance(&self, velocity: &[M::Velocity], other: &[M::Velocity]) -> f64 {
        let squared = |((v, u), m): ((&M::Velocity, &M::Velocity), &M::Mass)| m.squared(*v - *u);
        velocity.iter().zip(other).zip(self.mass()).map(squared).sum::<f64>().sqrt()
    }
}
