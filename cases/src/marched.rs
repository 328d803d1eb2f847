//! What a march needs to know of a mechanics.

use crate::detect::{DetectedContact, Side};
use crate::sample::Disc;
use analysis::Refutable;
use contact::{Contact, Discs, RoughContact, RoughDiscs, RoughMass};
use nalgebra::{Vector2, Vector3};

/// A mechanics that scenes march with.
pub trait Marched: Refutable {
    /// Whether contacts have friction: a scene that has may not march without.
    const HAS_FRICTION: bool;

    /// What resists the motion of a homogeneous disc.
    fn mass(disc: &Disc) -> Self::Mass;

    /// Its mass alone (kg).
    fn weight(mass: Self::Mass) -> f64;

    /// A motion without spin (m/s).
    fn translating(velocity: Vector2<f64>) -> Self::Velocity;

    /// The translation of a motion (m/s).
    fn translation(velocity: Self::Velocity) -> Vector2<f64>;

    /// The contact of a pair, with what the motion of a wall adds to its normal and tangential relative velocity (m/s), and μ between
    /// grains and at walls.
    fn contact(pair: &DetectedContact, radius: &[f64], offset: [f64; 2], friction: [f64; 2])
    -> Self::Contact;

    /// Adds a law's gap term to the offset of a contact (m/s).
    fn widen(contact: &mut Self::Contact, gap_offset: f64);
}

impl Marched for Discs {
    const HAS_FRICTION: bool = false;

    fn mass(disc: &Disc) -> f64 {
        disc.mass
    }

    fn weight(mass: f64) -> f64 {
        mass
    }

    fn translating(velocity: Vector2<f64>) -> Vector2<f64> {
        velocity
    }

    fn translation(velocity: Vector2<f64>) -> Vector2<f64> {
        velocity
    }

    fn contact(pair: &DetectedContact, _: &[f64], [offset, _]: [f64; 2], _: [f64; 2]) -> Contact {
        Contact { candidate: pair.candidate, antagonist: grain(pair.antagonist), normal: pair.normal, offset }
    }

    fn widen(contact: &mut Contact, gap_offset: f64) {
        contact.offset += gap_offset;
    }
}

impl Marched for RoughDiscs {
    const HAS_FRICTION: bool = true;

    /// I = ½ m R².
    fn mass(disc: &Disc) -> RoughMass {
        RoughMass { mass: disc.mass, inertia: 0.5 * disc.mass * disc.radius * disc.radius }
    }

    fn weight(mass: RoughMass) -> f64 {
        mass.mass
    }

    fn translating(velocity: Vector2<f64>) -> Vector3<f64> {
        Vector3::new(velocity.x, velocity.y, 0.0)
    }

    fn translation(velocity: Vector3<f64>) -> Vector2<f64> {
        velocity.xy()
    }

    fn contact(pair: &DetectedContact, radius: &[f64], offset: [f64; 2], friction: [f64; 2]) -> RoughContact {
        let antagonist = grain(pair.antagonist);
        let arm = |grain: u32| radius[grain as usize];
        RoughContact {
            candidate: pair.candidate,
            antagonist,
            normal: pair.normal,
            arms: Vector2::new(arm(pair.candidate), antagonist.map_or(0.0, arm)),
            offset: offset.into(),
            friction: friction[usize::from(antagonist.is_none())],
        }
    }

    fn widen(contact: &mut RoughContact, gap_offset: f64) {
        contact.offset.x += gap_offset;
    }
}

/// The grain that an antagonist is, unless it is a wall.
fn grain(antagonist: Side) -> Option<u32> {
    if let Side::Grain(j) = antagonist { Some(j) } else { None }
}
