//! Discs with friction; a contact in mass-scaled unknowns is 64 bytes.

use super::{Cone, Frictional, RoughContact, RoughDiscs, RoughMass};
use crate::gauge::Scaled;
use crate::law;
use crate::mechanics::{Column, Mechanics, Touch};
use nalgebra::{Vector2, Vector3};

impl Mechanics for RoughDiscs {
    type Place = Vector2<f64>;
    type Velocity = Vector3<f64>;
    type Mass = RoughMass;
    type Impulse = Vector2<f64>;
    type Contact = RoughContact;
    type Column = RoughColumn;
    type Gauge = Scaled<Self>;

    const NAME: &'static str = "rough-discs";
    const HAS_ONE_VELOCITY: bool = false;
}

impl Frictional<2> for RoughDiscs {
    #[inline]
    fn of_grain(contact: &RoughContact, v: &Vector3<f64>, arm: f64, sign: f64) -> Vector2<f64> {
        let (n, t) = (contact.normal.dot(&v.xy()), tangent(contact.normal).dot(&v.xy()));
        Vector2::new(sign * n, sign * t - arm * v.z)
    }

    #[inline]
    fn at_grain(contact: &RoughContact, r: Vector2<f64>, arm: f64, sign: f64) -> Vector3<f64> {
        let impulse = contact.normal * r.x + tangent(contact.normal) * r.y;
        Vector3::new(sign * impulse.x, sign * impulse.y, -arm * r.y)
    }
}

/// (−`n_y`, `n_x`).
#[inline]
fn tangent(n: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-n.y, n.x)
}

/// The two columns of H̃ of a contact: along its normal, and along its tangent with the spins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughColumn {
    candidate: u32,
    /// At a wall the candidate itself, which a ratio and an arm of 0 leave out.
    antagonist: u32,
    /// n/√(`m_candidate` `w_n`) (–).
    normal: Vector2<f64>,
    /// √(`m_candidate`/`m_antagonist`) (–); 0 at a wall.
    ratio: f64,
    /// √(`w_n`/`w_t`) (–).
    slant: f64,
    /// `R_i`/√(`I_i` `w_t`), and of j likewise (–); 0 at a wall.
    arms: [f64; 2],
    /// μ √(`w_t`/`w_n`) (–): a circular cone stays circular.
    friction: f64,
}

impl Cone for RoughColumn {
    #[inline]
    fn friction(&self) -> f64 {
        self.friction
    }
}

impl Column<RoughDiscs> for RoughColumn {
    fn new(
        contact: &RoughContact,
        places: (u32, Option<u32>),
        inverse_mass: impl Fn(u32) -> RoughMass,
        scaled: bool,
    ) -> (Self, Vector2<f64>) {
        let none = RoughMass { mass: 0.0, inertia: 0.0 };
        let i = inverse_mass(contact.candidate);
        let j = contact.antagonist.map_or(none, &inverse_mass);
        let unit = if scaled { contact.diagonal(inverse_mass).map(f64::sqrt) } else { Vector2::repeat(1.0) };
        let root = i.mass.sqrt();
        let column = Self {
            candidate: places.0,
            antagonist: places.1.unwrap_or(places.0),
            normal: contact.normal * (root / unit.x),
            ratio: j.mass.sqrt() / root,
            slant: unit.x / unit.y,
            arms: [contact.arms.x * i.inertia.sqrt() / unit.y, contact.arms.y * j.inertia.sqrt() / unit.y],
            friction: contact.friction * (unit.y / unit.x),
        };
        (column, unit)
    }

    #[inline]
    fn places(&self) -> [u32; 2] {
        [self.candidate, self.antagonist]
    }

    #[inline]
    fn between(&self, [i, j]: [Vector3<f64>; 2]) -> Vector2<f64> {
        let (x, y) = (i.x - self.ratio * j.x, i.y - self.ratio * j.y);
        let normal = self.normal.x * x + self.normal.y * y;
        let across = self.normal.x * y - self.normal.y * x;
        Vector2::new(normal, self.slant * across - (self.arms[0] * i.z + self.arms[1] * j.z))
    }

    #[inline]
    fn pushes(&self, s: Vector2<f64>) -> [Vector3<f64>; 2] {
        let along = self.slant * s.y;
        let (x, y) =
            (self.normal.x * s.x - self.normal.y * along, self.normal.y * s.x + self.normal.x * along);
        [
            Vector3::new(x, y, -(self.arms[0] * s.y)),
            Vector3::new(-(self.ratio * x), -(self.ratio * y), -(self.arms[1] * s.y)),
        ]
    }

    /// `s_n⁺` = max(0, `s_n` − ω `v_n`), then `s_t⁺` = clip(`s_t` − ω `v_t`, μ̃ `s_n⁺`): the two lines solve (2′), since `W_αα` is
    /// diagonal.
    #[inline]
    fn change(&self, s: Vector2<f64>, v: Vector2<f64>, relaxation: f64) -> Vector2<f64> {
        let normal = law::change(s.x, v.x, relaxation);
        let bound = self.friction * (s.x + normal);
        Vector2::new(normal, law::clip(s.y - relaxation * v.y, bound) - s.y)
    }

    #[inline]
    fn residual(&self, s: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
        let normal = if v.x >= s.x { s.x } else { v.x };
        // s_t − clip(s_t − v_t, μ s_n): between what leads to either bound.
        let bound = self.friction * law::non_negative(s.x);
        let (to_upper, to_lower) = (s.y - bound, s.y + bound);
        let tangential = if v.y < to_upper {
            to_upper
        } else if v.y > to_lower {
            to_lower
        } else {
            v.y
        };
        Vector2::new(normal, tangential)
    }
}
