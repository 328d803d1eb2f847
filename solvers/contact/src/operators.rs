//! H, Hᵗ, W and its diagonal, eq. (1). W is never assembled.

use crate::law;
use crate::problem::{Contact, ContactProblem};
use nalgebra::Vector2;

impl Contact {
    /// Candidate and antagonist.
    pub fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    /// The one or two grains that touch.
    pub fn grains(&self) -> impl Iterator<Item = u32> + Clone {
        std::iter::once(self.candidate).chain(self.antagonist)
    }

    /// (Hᵗ V)_α = n · (V_candidate − V_antagonist) (m/s).
    #[inline]
    pub fn relative(&self, velocity: &[Vector2<f64>]) -> f64 {
        let candidate = self.normal.dot(&velocity[self.candidate as usize]);
        self.antagonist.map_or(candidate, |j| candidate - self.normal.dot(&velocity[j as usize]))
    }
}

impl ContactProblem {
    /// R = H r: the resultant of the contact impulses `r` on each grain (N·s).
    pub fn resultant(&self, r: &[f64], resultant: &mut [Vector2<f64>]) {
        resultant.fill(Vector2::zeros());
        for (contact, r) in self.contacts().iter().zip(r) {
            let impulse = contact.normal * *r;
            resultant[contact.candidate as usize] += impulse;
            if let Some(j) = contact.antagonist {
                resultant[j as usize] -= impulse;
            }
        }
    }

    /// V = `V_free` + M⁻¹ H r (m/s).
    pub fn velocity(&self, r: &[f64], velocity: &mut [Vector2<f64>]) {
        self.resultant(r, velocity);
        for ((v, m), v_free) in velocity.iter_mut().zip(self.mass()).zip(self.free_velocity()) {
            *v = v_free + *v / *m;
        }
    }

    /// v = Hᵗ V + c (m/s).
    pub fn relative_velocity(&self, velocity: &[Vector2<f64>], v: &mut [f64]) {
        for (v, contact) in v.iter_mut().zip(self.contacts()) {
            *v = contact.relative(velocity) + contact.offset;
        }
    }

    /// b = Hᵗ `V_free` + c: the relative velocities without contact impulses (m/s).
    pub fn b(&self) -> Vec<f64> {
        let mut b = vec![0.0; self.contact_count()];
        self.relative_velocity(self.free_velocity(), &mut b);
        b
    }

    /// W p = Hᵗ M⁻¹ (H p): two passes over the contacts. `scratch` has one value per grain.
    pub fn delassus_product(&self, p: &[f64], product: &mut [f64], scratch: &mut [Vector2<f64>]) {
        self.resultant(p, scratch);
        for (v, m) in scratch.iter_mut().zip(self.mass()) {
            *v /= *m;
        }
        for (product, contact) in product.iter_mut().zip(self.contacts()) {
            *product = contact.relative(scratch);
        }
    }

    /// `W_αα` = `1/m_i` + `1/m_j`, or `1/m_i` at a wall (1/kg).
    pub fn delassus_diagonal(&self) -> Vec<f64> {
        self.contacts()
            .iter()
            .map(|contact| {
                let candidate = 1.0 / self.mass()[contact.candidate as usize];
                contact.antagonist.map_or(candidate, |j| candidate + 1.0 / self.mass()[j as usize])
            })
            .collect()
    }

    /// Σ max(0, −b)²/`W_αα` (J): the scale of the impulses' work, fixed by the problem. It is 0 where no contact pushes: the
    /// solution is then r = 0.
    pub fn scale(&self) -> f64 {
        let squared = |(b, w): (&f64, f64)| law::non_negative(-b) * law::non_negative(-b) / w;
        self.b().iter().zip(self.delassus_diagonal()).map(squared).sum()
    }

    /// q(r) = ½ rᵗ W r + bᵗ r, from v = W r + b: ½ rᵗ (v + b) (J).
    pub fn energy(r: &[f64], v: &[f64], b: &[f64]) -> f64 {
        0.5 * r.iter().zip(v).zip(b).map(|((r, v), b)| r * (v + b)).sum::<f64>()
    }

    /// ‖V − U‖_M of two velocity fields (√J).
    pub fn velocity_distance(&self, velocity: &[Vector2<f64>], other: &[Vector2<f64>]) -> f64 {
        let squared = |((v, u), m): ((&Vector2<f64>, &Vector2<f64>), &f64)| m * (v - u).norm_squared();
        velocity.iter().zip(other).zip(self.mass()).map(squared).sum::<f64>().sqrt()
    }
}
