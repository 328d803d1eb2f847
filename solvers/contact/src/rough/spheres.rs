//! Spheres with friction: a grain translates and spins about any axis, a contact has a normal and two tangential unknowns.
//!
//! `v_t` = Tᵗ (`V_i` − `V_j` − (`R_i` `ω_i` + `R_j` `ω_j`) × n), with T = [t₁ t₂] of a frame chosen from n alone.

mod column;

pub use column::SphereColumn;

use super::{RoughContact, RoughMass, obeys_friction};
use crate::discs::{Contact, Spheres};
use crate::error::ProblemError;
use crate::gauge::Scaled;
use crate::mechanics::{Mass, Mechanics, Touch};
use crate::problem::ContactProblem;
use nalgebra::{Vector3, Vector6};

/// Spheres with friction. Velocities are [V, ω], impulses [`r_n`, `r_t1`, `r_t2`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoughSpheres;

impl Mechanics for RoughSpheres {
    type Place = Vector3<f64>;
    type Velocity = Vector6<f64>;
    type Mass = RoughMass;
    type Impulse = Vector3<f64>;
    type Contact = RoughContact<3>;
    type Column = SphereColumn;
    type Gauge = Scaled<Self>;

    const NAME: &'static str = "rough-spheres";
    const HAS_ONE_VELOCITY: bool = false;
}

/// The tangents t₁ and t₂ that make a right-handed frame with the unit normal n.
///
/// T. Duff et al., Building an orthonormal basis, revisited, J. Computer Graphics Techniques 6(1) (2017) 1-8.
#[inline]
pub fn frame(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [
        Vector3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vector3::new(b, sign + n.y * n.y * a, -n.y),
    ]
}

/// Translation and spin.
#[inline]
fn parts(v: &Vector6<f64>) -> [Vector3<f64>; 2] {
    [Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5])]
}

#[inline]
fn joined(translation: Vector3<f64>, spin: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(translation.x, translation.y, translation.z, spin.x, spin.y, spin.z)
}

impl Mass<Vector6<f64>> for RoughMass {
    fn fault(self) -> Option<(&'static str, f64, &'static str)> {
        self.fault_of()
    }

    fn inverse(self, times: f64) -> Self {
        self.each(|m| times / m)
    }

    fn root(self) -> Self {
        self.each(f64::sqrt)
    }

    fn times(self, v: Vector6<f64>) -> Vector6<f64> {
        let [translation, spin] = parts(&v);
        joined(translation * self.mass, spin * self.inertia)
    }

    fn divides(self, r: Vector6<f64>) -> Vector6<f64> {
        let [translation, spin] = parts(&r);
        joined(translation / self.mass, spin / self.inertia)
    }

    fn squared(self, v: Vector6<f64>) -> f64 {
        let [translation, spin] = parts(&v);
        self.mass * translation.norm_squared() + self.inertia * spin.norm_squared()
    }

    fn speed(self, y: Vector6<f64>) -> f64 {
        self.mass * parts(&y)[0].norm()
    }
}

impl RoughContact<3> {
    /// Hᵗ V of one grain, with the sign of its translation (m/s).
    fn of_grain(&self, v: &Vector6<f64>, arm: f64, sign: f64) -> Vector3<f64> {
        let ([translation, spin], [first, second]) = (parts(v), frame(&self.normal));
        let slip = translation * sign - (spin * arm).cross(&self.normal);
        Vector3::new(sign * self.normal.dot(&translation), first.dot(&slip), second.dot(&slip))
    }

    /// H r at one grain, with the sign of its translation (N·s, N·m·s).
    fn at_grain(&self, r: Vector3<f64>, arm: f64, sign: f64) -> Vector6<f64> {
        let [first, second] = frame(&self.normal);
        let along = first * r.y + second * r.z;
        joined((self.normal * r.x + along) * sign, self.normal.cross(&along) * -arm)
    }
}

impl Touch<RoughSpheres> for RoughContact<3> {
    const ADMISSIBLE: &'static str = super::ADMISSIBLE;

    fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self {
        Self { candidate, antagonist, ..self }
    }

    fn normal(&self) -> Vector3<f64> {
        self.normal
    }

    fn offset(&self) -> Vector3<f64> {
        self.offset
    }

    fn relative(&self, velocity: &[Vector6<f64>]) -> Vector3<f64> {
        let candidate = self.of_grain(&velocity[self.candidate as usize], self.arms.x, 1.0);
        let of = |j: u32| self.of_grain(&velocity[j as usize], self.arms.y, -1.0);
        self.antagonist.map_or(candidate, |j| candidate + of(j))
    }

    fn push(&self, r: Vector3<f64>, resultant: &mut [Vector6<f64>]) {
        resultant[self.candidate as usize] += self.at_grain(r, self.arms.x, 1.0);
        if let Some(antagonist) = self.antagonist {
            resultant[antagonist as usize] += self.at_grain(r, self.arms.y, -1.0);
        }
    }

    fn diagonal(&self, inverse_mass: impl Fn(u32) -> RoughMass) -> Vector3<f64> {
        let of = |grain: u32, arm: f64| {
            let RoughMass { mass, inertia } = inverse_mass(grain);
            let along = mass + arm * arm * inertia;
            Vector3::new(mass, along, along)
        };
        let candidate = of(self.candidate, self.arms.x);
        self.antagonist.map_or(candidate, |j| candidate + of(j, self.arms.y))
    }

    fn is_admissible(&self, r: Vector3<f64>) -> bool {
        obeys_friction(r, self.friction)
    }

    fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        self.fault_of()
    }
}

impl ContactProblem<RoughSpheres> {
    /// Returns the same grains and contacts without friction.
    ///
    /// # Errors
    /// None: what is left was valid before.
    pub fn without_friction(&self) -> Result<ContactProblem<Spheres>, ProblemError> {
        let contact = |at: &RoughContact<3>| Contact {
            candidate: at.candidate,
            antagonist: at.antagonist,
            normal: at.normal,
            offset: at.offset.x,
        };
        ContactProblem::new(
            self.mass().iter().map(|mass| mass.mass).collect(),
            self.free_velocity().iter().map(|v| parts(v)[0]).collect(),
            self.contacts().iter().map(contact).collect(),
        )
    }
}
