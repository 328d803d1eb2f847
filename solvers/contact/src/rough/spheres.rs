//! Spheres with friction: a grain spins about any axis.

mod column;

pub use column::SphereColumn;

use super::{Frictional, RoughContact, RoughMass, RoughSpheres};
use crate::gauge::Scaled;
use crate::lanes::Number;
use crate::mechanics::Mechanics;
use nalgebra::{Vector3, Vector6};

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
fn parts<N: Number>(v: &Vector6<N>) -> [Vector3<N>; 2] {
    [Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5])]
}

#[inline]
fn joined<N: Number>(translation: Vector3<N>, spin: Vector3<N>) -> Vector6<N> {
    Vector6::new(translation.x, translation.y, translation.z, spin.x, spin.y, spin.z)
}

impl Frictional<3> for RoughSpheres {
    fn of_grain(contact: &RoughContact<3>, v: &Vector6<f64>, arm: f64, sign: f64) -> Vector3<f64> {
        let (n, [translation, spin], [first, second]) = (&contact.normal, parts(v), frame(&contact.normal));
        let slip = translation * sign - (spin * arm).cross(n);
        Vector3::new(sign * n.dot(&translation), first.dot(&slip), second.dot(&slip))
    }

    fn at_grain(contact: &RoughContact<3>, r: Vector3<f64>, arm: f64, sign: f64) -> Vector6<f64> {
        let (n, [first, second]) = (&contact.normal, frame(&contact.normal));
        let along = first * r.y + second * r.z;
        joined((n * r.x + along) * sign, n.cross(&along) * -arm)
    }
}
