//! What a march needs to know of a mechanics.

use crate::detect::{DetectedContact, Grain, Side};
use crate::scene::walls::WallMotion;
use contact::{Contact, Mechanics, RoughContact, RoughDiscs, RoughMass, RoughSpheres, Smooth, Touch, frame};
use nalgebra::{SVector, Vector2, Vector3, Vector6};

/// A mechanics that scenes march with.
pub trait Marched: Mechanics {
    /// Whether contacts have friction: a scene that has may not march without.
    const HAS_FRICTION: bool;

    /// What resists the motion of a homogeneous grain.
    fn mass(grain: &Grain<Self::Place>) -> Self::Mass;

    /// Its mass alone (kg).
    fn weight(mass: Self::Mass) -> f64;

    /// The same mass of a body that does not turn.
    #[must_use]
    fn unturned(mass: Self::Mass) -> Self::Mass {
        mass
    }

    /// A motion without spin (m/s).
    fn translating(velocity: Self::Place) -> Self::Velocity;

    /// The translation of a motion (m/s).
    fn translation(velocity: Self::Velocity) -> Self::Place;

    /// The contact of a pair, with the motion of its wall, if it has one, and μ between grains and at walls.
    fn contact(
        pair: &DetectedContact<Self::Place>,
        radius: &[f64],
        motion: &WallMotion<Self::Place>,
        friction: [f64; 2],
    ) -> Self::Contact;

    /// Adds a law's own term to the offset of a contact along its normal (m/s).
    fn widen(contact: &mut Self::Contact, term: f64);

    /// What an impulse gives to the candidate (N·s).
    fn to_candidate(contact: &Self::Contact, r: Self::Impulse) -> Self::Place;

    /// An impulse as it is kept for the next time step, in which the contact may face another way (N·s).
    fn kept(_: &Self::Contact, r: Self::Impulse) -> Self::Impulse {
        r
    }

    /// What is kept of the time step before, as an impulse that the contact admits (N·s).
    fn recalled(contact: &Self::Contact, kept: Self::Impulse) -> Self::Impulse;
}

impl<const D: usize> Marched for Smooth<D> {
    const HAS_FRICTION: bool = false;

    fn mass(grain: &Grain<SVector<f64, D>>) -> f64 {
        grain.mass
    }

    fn weight(mass: f64) -> f64 {
        mass
    }

    fn translating(velocity: SVector<f64, D>) -> SVector<f64, D> {
        velocity
    }

    fn translation(velocity: SVector<f64, D>) -> SVector<f64, D> {
        velocity
    }

    fn contact(
        pair: &DetectedContact<SVector<f64, D>>,
        _: &[f64],
        motion: &WallMotion<SVector<f64, D>>,
        _: [f64; 2],
    ) -> Contact<D> {
        let DetectedContact { candidate, antagonist, normal, .. } = *pair;
        Contact { candidate, antagonist: grain(antagonist), normal, offset: motion.opening }
    }

    fn widen(contact: &mut Contact<D>, term: f64) {
        contact.offset += term;
    }

    fn to_candidate(contact: &Contact<D>, r: f64) -> SVector<f64, D> {
        contact.normal * r
    }

    /// To the bit where the solver's start is admitted.
    fn recalled(_: &Contact<D>, kept: f64) -> f64 {
        if kept < 0.0 { 0.0 } else { kept }
    }
}

impl Marched for RoughDiscs {
    const HAS_FRICTION: bool = true;

    /// I = ½ m R².
    fn mass(grain: &Grain<Vector2<f64>>) -> RoughMass {
        RoughMass { mass: grain.mass, inertia: 0.5 * grain.mass * grain.radius * grain.radius }
    }

    fn weight(mass: RoughMass) -> f64 {
        mass.mass
    }

    fn unturned(mass: RoughMass) -> RoughMass {
        RoughMass { inertia: mass.inertia * UNTURNED, ..mass }
    }

    fn translating(velocity: Vector2<f64>) -> Vector3<f64> {
        Vector3::new(velocity.x, velocity.y, 0.0)
    }

    fn translation(velocity: Vector3<f64>) -> Vector2<f64> {
        velocity.xy()
    }

    fn contact(
        pair: &DetectedContact<Vector2<f64>>,
        radius: &[f64],
        motion: &WallMotion<Vector2<f64>>,
        friction: [f64; 2],
    ) -> RoughContact {
        let antagonist = grain(pair.antagonist);
        let arm = |grain: u32| radius[grain as usize];
        let mut contact = RoughContact {
            candidate: pair.candidate,
            antagonist,
            normal: pair.normal,
            arms: Vector2::new(arm(pair.candidate), antagonist.map_or(0.0, arm)),
            offset: Vector2::new(motion.opening, 0.0),
            friction: friction[usize::from(!matches!(pair.antagonist, Side::Grain(_)))],
        };
        if antagonist.is_none() {
            contact.offset.y = -contact.tangent().dot(&motion.sliding);
        }
        contact
    }

    fn widen(contact: &mut RoughContact, term: f64) {
        contact.offset.x += term;
    }

    fn to_candidate(contact: &RoughContact, r: Vector2<f64>) -> Vector2<f64> {
        contact.normal * r.x + contact.tangent() * r.y
    }

    /// Where a contact opens, round-off of what it was before can be more than μ times what is left.
    fn recalled(contact: &RoughContact, kept: Vector2<f64>) -> Vector2<f64> {
        let bound = contact.friction * kept.x.max(0.0);
        // To the bit where the solver's start is admitted.
        if contact.is_admissible(kept) {
            kept
        } else {
            Vector2::new(kept.x.max(0.0), kept.y.clamp(-bound, bound))
        }
    }
}

impl Marched for RoughSpheres {
    const HAS_FRICTION: bool = true;

    /// I = ⅖ m R².
    fn mass(grain: &Grain<Vector3<f64>>) -> RoughMass {
        RoughMass { mass: grain.mass, inertia: 0.4 * grain.mass * grain.radius * grain.radius }
    }

    fn weight(mass: RoughMass) -> f64 {
        mass.mass
    }

    fn translating(velocity: Vector3<f64>) -> Vector6<f64> {
        Vector6::new(velocity.x, velocity.y, velocity.z, 0.0, 0.0, 0.0)
    }

    fn translation(velocity: Vector6<f64>) -> Vector3<f64> {
        Vector3::new(velocity[0], velocity[1], velocity[2])
    }

    fn contact(
        pair: &DetectedContact<Vector3<f64>>,
        radius: &[f64],
        motion: &WallMotion<Vector3<f64>>,
        friction: [f64; 2],
    ) -> RoughContact<3> {
        let antagonist = grain(pair.antagonist);
        let arm = |grain: u32| radius[grain as usize];
        let [first, second] = frame(&pair.normal);
        let along = |t: Vector3<f64>| if antagonist.is_none() { -t.dot(&motion.sliding) } else { 0.0 };
        RoughContact {
            candidate: pair.candidate,
            antagonist,
            normal: pair.normal,
            arms: Vector2::new(arm(pair.candidate), antagonist.map_or(0.0, arm)),
            offset: Vector3::new(motion.opening, along(first), along(second)),
            friction: friction[usize::from(antagonist.is_none())],
        }
    }

    fn widen(contact: &mut RoughContact<3>, term: f64) {
        contact.offset.x += term;
    }

    fn to_candidate(contact: &RoughContact<3>, r: Vector3<f64>) -> Vector3<f64> {
        let [first, second] = frame(&contact.normal);
        contact.normal * r.x + first * r.y + second * r.z
    }

    /// As a vector in space: the tangents of another normal are others.
    fn kept(contact: &RoughContact<3>, r: Vector3<f64>) -> Vector3<f64> {
        Self::to_candidate(contact, r)
    }

    fn recalled(contact: &RoughContact<3>, kept: Vector3<f64>) -> Vector3<f64> {
        let normal = contact.normal.dot(&kept).max(0.0);
        let [y, z] = frame(&contact.normal).map(|t| t.dot(&kept));
        let (bound, size) = (contact.friction * normal, y.hypot(z));
        let factor = if size > bound { bound / size } else { 1.0 };
        Vector3::new(normal, factor * y, factor * z)
    }
}

/// 2¹⁰⁰: a body with so many times its moment of inertia turns by less than round-off shows.
const UNTURNED: f64 = (1_u128 << 100) as f64;

/// The grain, the lid or the driven segment that an antagonist is, unless it is a wall.
fn grain(antagonist: Side) -> Option<u32> {
    if let Side::Grain(j) | Side::Lid(j, _) | Side::Driven(j, _) = antagonist { Some(j) } else { None }
}

#[cfg(test)]
mod tests {
    use super::Marched;
    use contact::{RoughContact, RoughDiscs, Touch};
    use nalgebra::Vector2;

    #[test]
    fn round_off_of_a_contact_that_opened_is_admitted_in_the_next_time_step() {
        let contact = RoughContact {
            candidate: 0,
            antagonist: None,
            normal: Vector2::new(0.0, 1.0),
            arms: Vector2::new(1.0, 0.0),
            offset: Vector2::zeros(),
            friction: 0.5,
        };
        let recalled = |r: [f64; 2]| RoughDiscs::recalled(&contact, Vector2::from(r));
        // As Gauss-Seidel left it of impulses of 1 N·s.
        let left = recalled([1.776_6e-16, 8.883_5e-17]);
        assert!(contact.is_admissible(left) && left.x == 1.776_6e-16, "{left}");
        for inside in [[2.0, 1.0], [2.0, -0.3], [0.0, 0.0]] {
            assert_eq!(recalled(inside), Vector2::from(inside));
        }
    }
}
