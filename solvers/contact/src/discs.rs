//! Discs and spheres without friction: a grain translates, a contact has one unknown, and 0 ≤ v ⊥ r ≥ 0.

mod gauge;

use crate::error::{is_not_negative, is_positive};
use crate::law;
use crate::mechanics::{Column, Mass, Mechanics, Touch};
use crate::scaled::ScaledContact;
use crate::vector::Numbers;
use gauge::Plain;
use nalgebra::{SVector, Vector2};

/// Grains without friction, in D dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smooth<const D: usize>;

/// Discs without friction.
pub type Discs = Smooth<2>;

/// Spheres without friction.
pub type Spheres = Smooth<3>;

impl<const D: usize> Mechanics for Smooth<D> {
    type Place = SVector<f64, D>;
    type Velocity = SVector<f64, D>;
    type Mass = f64;
    type Impulse = f64;
    type Contact = Contact<D>;
    type Column = ScaledContact<D>;
    type Gauge = Plain<D>;

    const NAME: &'static str = if D == 2 { "discs" } else { "spheres" };
    const HAS_ONE_VELOCITY: bool = true;
}

/// One contact α. v_α = n · (V_candidate − V_antagonist) + c_α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<const D: usize = 2> {
    /// Index of the candidate grain.
    pub candidate: u32,
    /// Index of the antagonist grain; `None` for a wall, whose motion is in `offset`.
    pub antagonist: Option<u32>,
    /// Unit normal n, from antagonist to candidate (–).
    pub normal: SVector<f64, D>,
    /// c_α: what the scene imposes: a wall's motion and the law's gap term (m/s).
    pub offset: f64,
}

impl<const D: usize> Touch<Smooth<D>> for Contact<D> {
    const ADMISSIBLE: &'static str = "finite and not negative";

    fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self {
        Self { candidate, antagonist, ..self }
    }

    fn normal(&self) -> SVector<f64, D> {
        self.normal
    }

    fn offset(&self) -> f64 {
        self.offset
    }

    #[inline]
    fn relative(&self, velocity: &[SVector<f64, D>]) -> f64 {
        let candidate = self.normal.dot(&velocity[self.candidate as usize]);
        self.antagonist.map_or(candidate, |j| candidate - self.normal.dot(&velocity[j as usize]))
    }

    #[inline]
    fn push(&self, r: f64, resultant: &mut [SVector<f64, D>]) {
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

    fn arms(&self) -> Vector2<f64> {
        Vector2::zeros()
    }

    fn friction(&self) -> f64 {
        0.0
    }

    fn is_admissible(&self, r: f64) -> bool {
        is_not_negative(r)
    }

    fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        None
    }
}

impl<const D: usize> Column<Smooth<D>> for ScaledContact<D> {
    type Single = ScaledContact<D, f32>;

    fn new(
        contact: &Contact<D>,
        places: (u32, Option<u32>),
        inverse_mass: impl Fn(u32) -> f64,
        scaled: bool,
    ) -> (Self, f64) {
        let (i, j) = (inverse_mass(contact.candidate), contact.antagonist.map_or(0.0, &inverse_mass));
        let (root, unit) = (i.sqrt(), if scaled { (i + j).sqrt() } else { 1.0 });
        let column = Self {
            candidate: places.0,
            antagonist: places.1.unwrap_or(places.0),
            normal: contact.normal * (root / unit),
            ratio: j.sqrt() / root,
        };
        (column, unit)
    }

    fn single(&self) -> ScaledContact<D, f32> {
        let Self { candidate, antagonist, normal, ratio } = *self;
        ScaledContact {
            candidate,
            antagonist,
            normal: Numbers::nearest(normal),
            ratio: Numbers::nearest(ratio),
        }
    }

    #[inline]
    fn residual(&self, s: f64, v: f64) -> f64 {
        -law::change(s, v, 1.0)
    }
}

impl<const D: usize> Mass<SVector<f64, D>> for f64 {
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

    fn times(self, velocity: SVector<f64, D>) -> SVector<f64, D> {
        velocity * self
    }

    fn divides(self, resultant: SVector<f64, D>) -> SVector<f64, D> {
        resultant / self
    }

    fn squared(self, velocity: SVector<f64, D>) -> f64 {
        self * velocity.norm_squared()
    }

    fn speed(self, y: SVector<f64, D>) -> f64 {
        self * y.norm()
    }
}
