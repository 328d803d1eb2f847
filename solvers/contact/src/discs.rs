//! Discs without friction: a grain translates, a contact has one unknown, and 0 ≤ v ⊥ r ≥ 0.

use crate::error::{is_not_negative, is_positive};
use crate::law;
use crate::mechanics::{Associated, Mass, Mechanics, Touch};
use crate::meter::Meter;
use crate::scaled::ScaledContact;
use nalgebra::Vector2;

/// Discs without friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Discs;

impl Mechanics for Discs {
    type Velocity = Vector2<f64>;
    type Mass = f64;
    type Impulse = f64;
    type Contact = Contact;
    type Column = ScaledContact;
    type Meter<'p> = Meter<'p>;

    const NAME: &'static str = "discs";
    const HAS_ONE_VELOCITY: bool = true;
}

impl Associated for Discs {}

/// One contact α. v_α = n · (V_candidate − V_antagonist) + c_α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the candidate grain.
    pub candidate: u32,
    /// Index of the antagonist grain; `None` for a wall, whose motion is in `offset`.
    pub antagonist: Option<u32>,
    /// Unit normal n, from antagonist to candidate (–).
    pub normal: Vector2<f64>,
    /// c_α: what the scene imposes: a wall's motion and the law's gap term (m/s).
    pub offset: f64,
}

impl Contact {
    /// (Hᵗ V)_α = n · (V_candidate − V_antagonist) (m/s).
    #[inline]
    pub fn relative(&self, velocity: &[Vector2<f64>]) -> f64 {
        let candidate = self.normal.dot(&velocity[self.candidate as usize]);
        self.antagonist.map_or(candidate, |j| candidate - self.normal.dot(&velocity[j as usize]))
    }

    /// Candidate and antagonist.
    pub fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    /// The one or two grains that touch.
    pub fn grains(&self) -> impl Iterator<Item = u32> + Clone {
        Touch::grains(self)
    }
}

impl Touch<Discs> for Contact {
    const ADMISSIBLE: &'static str = "finite and not negative";

    fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self {
        Self { candidate, antagonist, ..self }
    }

    fn normal(&self) -> Vector2<f64> {
        self.normal
    }

    fn offset(&self) -> f64 {
        self.offset
    }

    #[inline]
    fn relative(&self, velocity: &[Vector2<f64>]) -> f64 {
        Self::relative(self, velocity)
    }

    #[inline]
    fn push(&self, r: f64, resultant: &mut [Vector2<f64>]) {
        let impulse = self.normal * r;
        resultant[self.candidate as usize] += impulse;
        if let Some(j) = self.antagonist {
            resultant[j as usize] -= impulse;
        }
    }

    fn diagonal(&self, inverse_mass: impl Fn(u32) -> f64) -> f64 {
        let candidate = inverse_mass(self.candidate);
        self.antagonist.map_or(candidate, |j| candidate + inverse_mass(j))
    }

    fn admissible(&self, r: f64, v: f64, diagonal: f64) -> f64 {
        law::non_negative(r - v / diagonal)
    }

    fn is_admissible(&self, r: f64) -> bool {
        is_not_negative(r)
    }

    fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        None
    }
}

impl Mass<Vector2<f64>> for f64 {
    fn fault(self) -> Option<(&'static str, f64, &'static str)> {
        let expected = if !is_positive(self) {
            "positive and finite"
        } else if !self.recip().is_finite() {
            // A problem needs 1/m: that of 1e-320 kg is infinite.
            "at least 5.6e-309, or its inverse overflows"
        } else {
            return None;
        };
        Some(("grains.mass", self, expected))
    }

    fn inverse(self, times: f64) -> Self {
        times / self
    }

    fn root(self) -> Self {
        self.sqrt()
    }

    fn times(self, velocity: Vector2<f64>) -> Vector2<f64> {
        velocity * self
    }

    fn divides(self, resultant: Vector2<f64>) -> Vector2<f64> {
        resultant / self
    }

    fn squared(self, velocity: Vector2<f64>) -> f64 {
        self * velocity.norm_squared()
    }

    fn speed(self, y: Vector2<f64>) -> f64 {
        self * y.norm()
    }
}
