//! Discs with friction; a contact in mass-scaled unknowns is 64 bytes.

use super::{Cone, Frictional, RoughContact, RoughDiscs, RoughMass};
use crate::gauge::Scaled;
use crate::lanes::Number;
use crate::law::{self, Coulomb};
use crate::mechanics::{Column, Mechanics, Touch};
use crate::vector::Numbers;
use crate::visit::Visited;
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
pub struct RoughColumn<N = f64> {
    candidate: u32,
    /// At a wall the candidate itself, which a ratio and an arm of 0 leave out.
    antagonist: u32,
    /// n/√(`m_candidate` `w_n`) (–).
    normal: Vector2<N>,
    /// √(`m_candidate`/`m_antagonist`) (–); 0 at a wall.
    ratio: N,
    /// √(`w_n`/`w_t`) (–).
    slant: N,
    /// `R_i`/√(`I_i` `w_t`), and of j likewise (–); 0 at a wall.
    arms: [N; 2],
    /// μ √(`w_t`/`w_n`) (–): a circular cone stays circular.
    friction: N,
}

impl Cone for RoughColumn {
    #[inline]
    fn friction(&self) -> f64 {
        self.friction
    }
}

impl<N: Number> Visited for RoughColumn<N> {
    type Velocity = Vector3<N>;
    type Impulse = Vector2<N>;
    type Law = Coulomb<N>;

    #[inline]
    fn places(&self) -> [u32; 2] {
        [self.candidate, self.antagonist]
    }

    #[inline]
    fn between(&self, [i, j]: [Vector3<N>; 2]) -> Vector2<N> {
        let (x, y) = (i.x - self.ratio * j.x, i.y - self.ratio * j.y);
        let normal = self.normal.x * x + self.normal.y * y;
        let across = self.normal.x * y - self.normal.y * x;
        Vector2::new(normal, self.slant * across - (self.arms[0] * i.z + self.arms[1] * j.z))
    }

    #[inline]
    fn pushes(&self, s: Vector2<N>) -> [Vector3<N>; 2] {
        let along = self.slant * s.y;
        let (x, y) =
            (self.normal.x * s.x - self.normal.y * along, self.normal.y * s.x + self.normal.x * along);
        [
            Vector3::new(x, y, -(self.arms[0] * s.y)),
            Vector3::new(-(self.ratio * x), -(self.ratio * y), -(self.arms[1] * s.y)),
        ]
    }

    #[inline]
    fn law(&self) -> Coulomb<N> {
        Coulomb(self.friction)
    }
}

impl Column<RoughDiscs> for RoughColumn {
    type Single = RoughColumn<f32>;

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

    fn single(&self) -> RoughColumn<f32> {
        RoughColumn {
            candidate: self.candidate,
            antagonist: self.antagonist,
            normal: Numbers::nearest(self.normal),
            ratio: Numbers::nearest(self.ratio),
            slant: Numbers::nearest(self.slant),
            arms: self.arms.map(Numbers::nearest),
            friction: Numbers::nearest(self.friction),
        }
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
