//! Types of a scene's grains and contacts: the number of unknowns of a contact, the motion of a grain, the law, and the kernels.
//!
//! Nothing of a larger mechanics is stored, computed or branched on in a smaller one. Outside the kernels, impulses and relative
//! velocities are flat lists, [`Vector::LEN`] numbers of [`Mechanics::Impulse`] a contact, the normal one first.

use crate::sums::Sums;
use crate::vector::{Numbers, Place, Vector};
use crate::visit::Visited;
use nalgebra::Vector2;
use std::fmt::Debug;
use std::ops::Range;

/// One of the mechanics of a scene.
pub trait Mechanics: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Position of a grain (m), or direction of a contact: two or three components.
    type Place: Place;
    /// Velocity of a grain: translation (m/s), then spin (rad/s), if any.
    type Velocity: Vector;
    /// Inertia of a grain: mass (kg), and moment of inertia (kg m²), if there is a spin.
    type Mass: Mass<Self::Velocity>;
    /// Impulse at a contact (N·s), or relative velocity there (m/s).
    type Impulse: Vector;
    /// One contact of a problem.
    type Contact: Touch<Self>;
    /// One contact in mass-scaled unknowns.
    type Column: Column<Self>;
    /// Kernel of the measures of an iterate.
    type Gauge: Gauge<Self>;

    /// Name in files.
    const NAME: &'static str;

    /// True where contacts have friction, as a scene with friction requires.
    const HAS_FRICTION: bool = Self::Impulse::LEN > 1;

    /// True where all solutions of a problem have the same velocity: far from a known one is then far from any.
    const HAS_ONE_VELOCITY: bool;
}

/// Lists the results of a function for each mechanics. To add one: its name here.
#[macro_export]
macro_rules! of_each_mechanics {
    ($of:ident) => {
        [
            $of::<$crate::RoughDiscs>(),
            $of::<$crate::Discs>(),
            $of::<$crate::Spheres>(),
            $of::<$crate::RoughSpheres>(),
        ]
    };
}

/// Inertia of a grain; or its inverse, which is of the same kind.
pub trait Mass<V>: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Returns the fault of the inertia, if any: the key, the value, and what is expected.
    fn fault(self) -> Option<(&'static str, f64, &'static str)>;

    /// M⁻¹, so many times.
    #[must_use]
    fn inverse(self, times: f64) -> Self;

    /// M^½.
    #[must_use]
    fn root(self) -> Self;

    /// M V.
    fn times(self, velocity: V) -> V;

    /// M⁻¹ R.
    fn divides(self, resultant: V) -> V;

    /// Vᵗ M V (J).
    fn squared(self, velocity: V) -> f64;

    /// The greatest component of a translation (m/s), of a velocity whose y = M^½ V this is, where `self` is M^-½.
    fn speed(self, y: V) -> f64;
}

/// One contact of a problem, with its own numbers of impulse, velocity and law.
pub trait Touch<M: Mechanics>: Copy + Debug + PartialEq + Send + Sync {
    /// Candidate and antagonist; `None` for a wall.
    fn ends(&self) -> (u32, Option<u32>);

    /// Returns the same contact between other grains, numbered as where these are.
    #[must_use]
    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self;

    /// Unit normal n, from antagonist to candidate (–).
    fn normal(&self) -> M::Place;

    /// c: what the scene imposes on the relative velocity (m/s).
    fn offset(&self) -> M::Impulse;

    /// (Hᵗ V)_α (m/s).
    fn relative(&self, velocity: &[M::Velocity]) -> M::Impulse;

    /// R ← R + H r of this contact (N·s).
    fn push(&self, r: M::Impulse, resultant: &mut [M::Velocity]);

    /// `W_αα`, which is diagonal since normals pass through the centres (1/kg), with the inverse of the masses.
    fn diagonal(&self, inverse_mass: impl Fn(u32) -> M::Mass) -> M::Impulse;

    /// `R_i` and `R_j`, the distances of the centres from the contact (m), where grains have a spin; else 0.
    fn arms(&self) -> Vector2<f64>;

    /// μ (–); 0 without friction.
    fn friction(&self) -> f64;

    /// Reports whether r is finite and the law admits it, up to round-off of a bound (N·s).
    fn is_admissible(&self, r: M::Impulse) -> bool;

    /// Description of an admissible impulse, in words.
    const ADMISSIBLE: &'static str;

    /// Returns the fault of the law's own numbers, if any: the key, the value, and what is expected.
    fn fault(&self) -> Option<(&'static str, f64, &'static str)>;

    /// The one or two grains that touch.
    fn grains(&self) -> impl Iterator<Item = u32> + Clone {
        let (candidate, antagonist) = self.ends();
        std::iter::once(candidate).chain(antagonist)
    }
}

/// A contact of a mechanics as a sweep visits it, whatever the precision.
pub trait VisitedIn<M: Mechanics>:
    Visited<Velocity: Numbers<Double = M::Velocity>, Impulse: Numbers<Double = M::Impulse>>
{
}

impl<M: Mechanics, C> VisitedIn<M> for C where
    C: Visited<Velocity: Numbers<Double = M::Velocity>, Impulse: Numbers<Double = M::Impulse>>
{
}

/// A contact of a mechanics in mass-scaled unknowns.
pub trait Column<M: Mechanics>: Visited<Velocity = M::Velocity, Impulse = M::Impulse> {
    /// Column in single precision.
    type Single: VisitedIn<M>;

    /// A contact between two `places` of y, or one place and a wall, with the `inverse_mass` of its grains (1/kg); and its unit:
    /// √`W_αα` (kg^-½), or 1 if it is not `scaled`.
    fn new(
        contact: &M::Contact,
        places: (u32, Option<u32>),
        inverse_mass: impl Fn(u32) -> M::Mass,
        scaled: bool,
    ) -> (Self, M::Impulse);

    /// Returns the contact in single precision.
    fn single(&self) -> Self::Single;

    /// s − s⁺ of the natural map, in a form that does not cancel where s is large; a bound is that of the normal part of s itself.
    fn residual(&self, s: M::Impulse, v: M::Impulse) -> M::Impulse;
}

/// Places of the candidate and the antagonist of a contact among the grains of a gauge; `None` for a wall.
pub type Ends = (u32, Option<u32>);

/// Kernel of the measures of some contacts of a problem, between some grains: a subdomain, or all.
pub trait Gauge<M: Mechanics>: Sized + Send + Sync {
    /// Takes the inertia `mass` and the free velocity (m/s) of all grains of a problem and its contacts, `of` which some `contacts` are
    /// given, each by its index and its ends among the `grains`, which are given by their indices.
    fn new(
        mass: &[M::Mass],
        free_velocity: &[M::Velocity],
        of: &[M::Contact],
        contacts: impl Iterator<Item = (usize, Ends)> + Clone,
        grains: impl ExactSizeIterator<Item = usize>,
    ) -> Self;

    /// Length of y: the grains, and a wall if the kernel has a place for it.
    fn places(&self) -> usize;

    /// Computes y from the impulses `r` (N·s).
    fn push(&self, r: &[f64], y: &mut [M::Velocity]);

    /// Returns y of one place alone.
    fn gather(&self, place: usize, r: &[f64]) -> M::Velocity;

    /// Sums up a range of contacts with the impulses `r` (N·s) of all contacts; only the natural map, if `alone`.
    fn sums(&self, contacts: Range<usize>, r: &[f64], y: &[M::Velocity], alone: bool) -> Sums;

    /// Returns the natural map's term (J) and the approach velocity −`v_n` (m/s) of a contact whose grains are evaluated alone.
    fn alone(&self, contact: usize, r: &[f64]) -> (f64, f64);

    /// Returns a bound of |s| = (Σ `W_αα` r²)^½ (√J).
    fn size(&self, r: &[f64]) -> f64;

    /// Returns (Σ b²/`W_αα`)^½ (√J).
    fn size_of_b(&self) -> f64;

    /// Returns a velocity of a grain of inertia `mass` (m/s) in the unit of y.
    fn scaled(mass: M::Mass, velocity: M::Velocity) -> M::Velocity;

    /// Returns the squared size of a grain's y (J).
    fn squared(&self, grain: usize, y: M::Velocity) -> f64;
}
