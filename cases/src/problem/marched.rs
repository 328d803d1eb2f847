//! Interface of a mechanics to the time march, and what a march does in any of them.

use crate::detect::{DetectedContact, Grain, Side};
use crate::scene::walls::WallMotion;
use contact::{
    Contact, Frictional, Mechanics, Place, Rough, RoughContact, RoughMass, Smooth, Touch, Vector, frame,
};
use nalgebra::{SVector, Vector3};
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A mechanics that scenes march with, and that files hold.
pub trait Marched: Mechanics<Place: Listed, Velocity: Listed, Impulse: Listed, Mass: Inertia> {
    /// Returns the contact with these numbers, of which it takes those that it has.
    fn contact(parts: &Parts<Self::Place>) -> Self::Contact;

    /// Returns the mass of a grain alone (kg).
    fn weight(mass: Self::Mass) -> f64 {
        mass.mass()
    }
}

/// A point, a direction, a velocity or an impulse as it stands in files.
pub trait Listed: Vector {
    /// Its components.
    type List: Copy + JsonSchema + Serialize + DeserializeOwned;

    /// Returns its components for a file.
    fn list(self) -> Self::List;

    /// Builds it from those of a file.
    fn of_list(list: Self::List) -> Self;
}

impl Listed for f64 {
    type List = Self;

    fn list(self) -> Self {
        self
    }

    fn of_list(list: Self) -> Self {
        list
    }
}

impl<const N: usize> Listed for SVector<f64, N>
where
    [f64; N]: Copy + JsonSchema + Serialize + DeserializeOwned,
{
    type List = [f64; N];

    fn list(self) -> [f64; N] {
        self.into()
    }

    fn of_list(list: [f64; N]) -> Self {
        list.into()
    }
}

/// The numbers of a contact in any mechanics.
#[derive(Clone, Copy, Debug)]
pub struct Parts<P> {
    /// Index of the candidate grain.
    pub candidate: u32,
    /// Index of the antagonist grain; `None` for a wall.
    pub antagonist: Option<u32>,
    /// Unit normal, from antagonist to candidate (–).
    pub normal: P,
    /// Distances from the centres of candidate and antagonist to the contact point (m).
    pub arms: [f64; 2],
    /// Relative velocity imposed along the normal and the tangents (m/s).
    pub offset: [f64; 3],
    /// μ (–).
    pub friction: f64,
}

/// Mass of a grain, and its moment of inertia where it spins.
pub trait Inertia {
    /// Returns the inertia of a mass (kg) with a moment (kg m²).
    fn of(mass: f64, moment: f64) -> Self;

    /// Mass (kg).
    fn mass(self) -> f64;

    /// Moment of inertia (kg m²), if it spins.
    fn moment(self) -> Option<f64>;
}

impl Inertia for f64 {
    fn of(mass: f64, _: f64) -> Self {
        mass
    }

    fn mass(self) -> f64 {
        self
    }

    fn moment(self) -> Option<f64> {
        None
    }
}

impl Inertia for RoughMass {
    fn of(mass: f64, inertia: f64) -> Self {
        Self { mass, inertia }
    }

    fn mass(self) -> f64 {
        self.mass
    }

    fn moment(self) -> Option<f64> {
        Some(self.inertia)
    }
}

impl<const D: usize> Marched for Smooth<D>
where
    SVector<f64, D>: Listed,
{
    fn contact(parts: &Parts<SVector<f64, D>>) -> Contact<D> {
        let Parts { candidate, antagonist, normal, offset, .. } = *parts;
        Contact { candidate, antagonist, normal, offset: offset[0] }
    }
}

impl<const D: usize> Marched for Rough<D>
where
    Rough<D>: Frictional<D, Velocity: Listed>,
    SVector<f64, D>: Listed,
{
    fn contact(parts: &Parts<SVector<f64, D>>) -> RoughContact<D> {
        let Parts { candidate, antagonist, normal, arms, offset, friction } = *parts;
        RoughContact {
            candidate,
            antagonist,
            normal,
            arms: arms.into(),
            offset: Vector::at(&offset, 0),
            friction,
        }
    }
}

/// 2¹⁰⁰: a body with so many times its moment of inertia turns by less than round-off shows.
const UNTURNED: f64 = (1_u128 << 100) as f64;

/// Returns the inertia of a homogeneous grain: I = ½ m R² of a disc, ⅖ m R² of a sphere. A body that is not `turned` does not spin.
pub(crate) fn inertia<M: Marched>(grain: &Grain<M::Place>, turned: bool) -> M::Mass {
    let of_shape = if M::Place::LEN > 2 { 0.4 } else { 0.5 };
    let moment = of_shape * grain.mass * grain.radius * grain.radius;
    M::Mass::of(grain.mass, if turned { moment } else { moment * UNTURNED })
}

/// A motion without spin (m/s).
pub(crate) fn translating<M: Marched>(velocity: M::Place) -> M::Velocity {
    resized(velocity)
}

/// The translation of a motion (m/s).
pub(crate) fn translation<M: Marched>(velocity: M::Velocity) -> M::Place {
    resized(velocity)
}

/// The first components of a vector, or all of them and then zeros.
fn resized<A: Vector, B: Vector>(vector: A) -> B {
    let mut list = [0.0; 6];
    vector.put(&mut list, 0);
    B::at(&list, 0)
}

/// The tangents of a contact with this normal (–); in the plane the first alone.
fn tangents<P: Place>(normal: P) -> [P; 2] {
    if P::LEN > 2 {
        frame(&Vector3::from(normal.space())).map(|tangent| P::of(tangent.into()))
    } else {
        [P::of([-normal[1], normal[0], 0.0]), P::ZERO]
    }
}

/// The numbers of the contact of a pair, with the motion of its wall, if it has one, and its μ.
pub(crate) fn parts<M: Marched>(
    pair: &DetectedContact<M::Place>,
    radius: &[f64],
    motion: &WallMotion<M::Place>,
    friction: f64,
) -> Parts<M::Place> {
    let DetectedContact { candidate, antagonist, normal, .. } = *pair;
    // The grain, the lid or the driven segment, unless it is a wall.
    let antagonist = match antagonist {
        Side::Grain(j) | Side::Lid(j, _) | Side::Driven(j, _) => Some(j),
        _ => None,
    };
    let arm = |grain: u32| radius[grain as usize];
    let mut offset = [motion.opening, 0.0, 0.0];
    if M::HAS_FRICTION && antagonist.is_none() {
        for (along, tangent) in offset[1..].iter_mut().zip(tangents(normal)) {
            *along = -tangent.dot_product(motion.sliding);
        }
    }
    let arms = [arm(candidate), antagonist.map_or(0.0, arm)];
    Parts { candidate, antagonist, normal, arms, offset, friction }
}

/// Returns an impulse as the vector that acts on the candidate (N·s).
pub fn to_candidate<M: Marched>(contact: &M::Contact, r: M::Impulse) -> M::Place {
    let normal = contact.normal();
    let mut list = [0.0; 3];
    r.put(&mut list, 0);
    let along = normal * list[0];
    let tangential = list[1..M::Impulse::LEN].iter().zip(tangents(normal));
    tangential.fold(along, |sum, (r, tangent)| sum + tangent * *r)
}

/// Reports whether a contact that pushes slides: its tangential impulse is nearer to its bound than a `share` of that.
pub fn slides<M: Marched>(contact: &M::Contact, r: M::Impulse, share: f64) -> bool {
    let mut list = [0.0; 3];
    r.put(&mut list, 0);
    let bound = contact.friction() * list[0];
    list[0] > 0.0 && !(list[1].hypot(list[2]) < (1.0 - share) * bound)
}

/// An impulse as it is kept for the next time step, in which the contact may face another way (N·s): in space as a vector there, since
/// the tangents of another normal are others.
pub(crate) fn kept<M: Marched>(contact: &M::Contact, r: M::Impulse) -> M::Impulse {
    if M::Impulse::LEN > 2 { resized(to_candidate::<M>(contact, r)) } else { r }
}

/// Returns an impulse `kept` from the time step before, clipped to those that the contact admits (N·s): at a contact that opens,
/// round-off of the earlier impulse can exceed μ times the remaining normal impulse.
pub(crate) fn recalled<M: Marched>(contact: &M::Contact, kept: M::Impulse) -> M::Impulse {
    let mut r = [0.0; 3];
    kept.put(&mut r, 0);
    let bound = |normal: f64| contact.friction() * normal;
    match M::Impulse::LEN {
        // To the bit where the solver's start is admitted.
        1 if r[0] < 0.0 => r[0] = 0.0,
        2 if !contact.is_admissible(kept) => {
            r[0] = r[0].max(0.0);
            r[1] = r[1].clamp(-bound(r[0]), bound(r[0]));
        }
        3 => {
            let vector = M::Place::of(r);
            let normal = contact.normal().dot_product(vector).max(0.0);
            let [y, z] = tangents(contact.normal()).map(|tangent| tangent.dot_product(vector));
            let size = y.hypot(z);
            let factor = if size > bound(normal) { bound(normal) / size } else { 1.0 };
            r = [normal, factor * y, factor * z];
        }
        _ => {}
    }
    M::Impulse::at(&r, 0)
}

#[cfg(test)]
mod tests;
