//! Discs with Tresca's law: what slides is bounded by a given impulse, not by μ times the normal one. It is Coulomb's law with its
//! coupling cut, and has a minimum: a method may descend on it, and a solution of Coulomb's law solves it with the bounds μ `r_n` of its
//! own normal impulses.

use super::meter::{RoughMeter, Rubbing};
use super::{RoughColumn, RoughContact, RoughDiscs, RoughMass};
use crate::error::{ProblemError, is_not_negative};
use crate::law;
use crate::mechanics::{Associated, Column, Mechanics, Touch, Vector};
use crate::packing::Packing;
use nalgebra::{Vector2, Vector3};

/// Discs with Tresca's law. Velocities and impulses are those of [`RoughDiscs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrescaDiscs;

impl Mechanics for TrescaDiscs {
    type Place = Vector2<f64>;
    type Velocity = Vector3<f64>;
    type Mass = RoughMass;
    type Impulse = Vector2<f64>;
    type Contact = TrescaContact;
    type Column = TrescaColumn;
    type Meter<'p> = RoughMeter<'p, Self>;

    const NAME: &'static str = "tresca-discs";
    const HAS_ONE_VELOCITY: bool = true;
}

impl Associated for TrescaDiscs {}

/// One contact α: 0 ≤ `v_n` ⊥ `r_n` ≥ 0,  |`r_t`| ≤ g,  `v_t` = 0 or (|`r_t`| = g and `r_t` against `v_t`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrescaContact {
    /// Who touches, and where; its μ counts for nothing.
    pub touch: RoughContact,
    /// g (N·s).
    pub bound: f64,
}

impl Touch<TrescaDiscs> for TrescaContact {
    const ADMISSIBLE: &'static str =
        "finite, with a normal part that is not negative and a tangential part within its bound";

    fn ends(&self) -> (u32, Option<u32>) {
        self.touch.ends()
    }

    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self {
        Self { touch: self.touch.between(candidate, antagonist), ..self }
    }

    fn normal(&self) -> Vector2<f64> {
        self.touch.normal
    }

    fn offset(&self) -> Vector2<f64> {
        self.touch.offset
    }

    fn relative(&self, velocity: &[Vector3<f64>]) -> Vector2<f64> {
        self.touch.relative(velocity)
    }

    fn push(&self, r: Vector2<f64>, resultant: &mut [Vector3<f64>]) {
        self.touch.push(r, resultant);
    }

    fn diagonal(&self, inverse_mass: impl Fn(u32) -> RoughMass) -> Vector2<f64> {
        self.touch.diagonal(inverse_mass)
    }

    fn is_admissible(&self, r: Vector2<f64>) -> bool {
        is_not_negative(r.x) && r.y.abs() <= (1.0 + 1e-9) * self.bound
    }

    fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        let bound = (!is_not_negative(self.bound)).then_some(("contacts.bound", self.bound));
        self.touch.fault().or(bound.map(|(key, value)| (key, value, "finite and not negative")))
    }
}

/// The same in mass-scaled unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrescaColumn {
    column: RoughColumn,
    /// g √`w_t` (√J).
    bound: f64,
}

impl Column<TrescaDiscs> for TrescaColumn {
    fn new(
        contact: &TrescaContact,
        places: (u32, Option<u32>),
        inverse_mass: impl Fn(u32) -> RoughMass,
        scaled: bool,
    ) -> (Self, Vector2<f64>) {
        let (column, unit) =
            <RoughColumn as Column<RoughDiscs>>::new(&contact.touch, places, inverse_mass, scaled);
        (Self { column, bound: contact.bound * unit.y }, unit)
    }

    fn relative(&self, y: &[Vector3<f64>]) -> Vector2<f64> {
        self.column.relative(y)
    }

    fn push(&self, s: Vector2<f64>, y: &mut [Vector3<f64>]) {
        self.column.push(s, y);
    }

    /// The projection on 0 ≤ `s_n`, |`s_t`| ≤ g: the minimum at the contact, since `W_αα` is diagonal.
    fn change(&self, s: Vector2<f64>, v: Vector2<f64>, relaxation: f64) -> Vector2<f64> {
        let tangential = law::clip(s.y - relaxation * v.y, self.bound);
        Vector2::new(law::change(s.x, v.x, relaxation), tangential - s.y)
    }

    fn residual(&self, s: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
        -self.change(s, v, 1.0)
    }
}

impl Rubbing for TrescaDiscs {
    fn places(column: &TrescaColumn) -> [u32; 2] {
        column.column.places()
    }

    fn between(column: &TrescaColumn, ends: [Vector3<f64>; 2]) -> Vector2<f64> {
        column.column.between(ends)
    }

    fn push_at(column: &TrescaColumn, grain: u32, s: Vector2<f64>) -> Vector3<f64> {
        column.column.push_at(grain, s)
    }
}

impl Packing<RoughDiscs> {
    /// The same grains and contacts with Tresca's law, whose bounds are μ times the normal impulses of `r` (N·s).
    ///
    /// # Errors
    /// Names the bound that is not finite or negative.
    pub fn with_bounds_of(&self, r: &[f64]) -> Result<Packing<TrescaDiscs>, ProblemError> {
        let contact = |(k, touch): (usize, &RoughContact)| TrescaContact {
            touch: *touch,
            bound: touch.friction * Vector2::at(r, k).x,
        };
        Packing::new(
            self.mass().to_vec(),
            self.position().to_vec(),
            self.free_velocity().to_vec(),
            self.contacts().iter().enumerate().map(contact).collect(),
        )
    }
}
