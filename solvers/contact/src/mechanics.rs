//! Types of a scene's grains and contacts: the number of unknowns of a contact, the motion of a grain, and the law.
//!
//! Nothing of a larger mechanics is stored, computed or branched on in a smaller one. Outside the kernels, impulses and relative
//! velocities are flat lists, [`Vector::LEN`] numbers of [`Mechanics::Impulse`] a contact, the normal one first.

use crate::error::shown;
use crate::gauge::Gauge;
use crate::lanes::Number;
use crate::law::Lawful;
use crate::scaled::unscale;
use crate::sweep::{Row, TOGETHER, look_then_push};
use bytemuck::{Pod, Zeroable};
use nalgebra::{ArrayStorage, SVector};
use pulp::Simd;
use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub, SubAssign};

/// One of the mechanics of a scene.
pub trait Mechanics: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Position of a grain (m), or direction of a contact: two or three components.
    type Place: Place;
    /// Velocity of a grain: translation (m/s), then spin (rad/s), if any.
    type Velocity: Vector;
    /// Inertia of a grain: mass (kg), and moment of inertia (kg m²), if there is a spin.
    type Mass: Mass<Self::Velocity>;
    /// Impulse at a contact (N·s), or relative velocity there (m/s).
    type Impulse: Vector + Lawful;
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

/// A short list of numbers that are added up and scaled together, in double precision.
pub trait Vector:
    Numbers<Number = f64, Double = Self>
    + Sum
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + SubAssign
{
    /// Number of components.
    const LEN: usize;

    /// All of them 0.
    const ZERO: Self;

    /// Reads the components of one item of a flat list.
    fn at(list: &[f64], index: usize) -> Self;

    /// Puts them into a flat list.
    fn put(self, list: &mut [f64], index: usize);

    /// Component by component, with those of another.
    #[must_use]
    fn with(self, other: Self, join: impl Fn(f64, f64) -> f64) -> Self;

    /// The first: of an impulse, the normal one.
    fn first(self) -> f64;

    /// The sum of the products, component by component.
    fn dot_product(self, other: Self) -> f64;

    /// The sum of the components.
    fn total(self) -> f64 {
        let mut total = 0.0;
        self.each(&mut |number| total += number);
        total
    }

    /// Each number.
    fn each(self, number: &mut dyn FnMut(f64));

    /// Reports whether no component is infinite or NaN.
    fn is_finite(self) -> bool;

    /// As it is shown in an error.
    fn text(self) -> String;
}

/// A short list of numbers of one precision, as a sweep adds and scales them.
pub trait Numbers:
    Copy + Debug + PartialEq + Send + Sync + Add<Output = Self> + Sub<Output = Self> + AddAssign + Pod
{
    /// One of them.
    type Number: Number;
    /// List of them in double precision.
    type Double: Vector;

    /// Returns the numbers, so many `times`.
    #[must_use]
    fn scaled(self, times: Self::Number) -> Self;

    /// Returns the list in double precision.
    fn double(self) -> Self::Double;

    /// Returns the nearest list of this precision.
    fn nearest(double: Self::Double) -> Self;

    /// Puts r = s/unit of each of some `contacts` of a problem into its flat list.
    fn unscale((s, unit): (&[Self], &[Self::Double]), contacts: &[u32], r: &mut [f64]) {
        for ((s, unit), contact) in s.iter().zip(unit).zip(contacts) {
            s.double().with(*unit, |s, unit| s / unit).put(r, *contact as usize);
        }
    }
}

impl<N: Number> Numbers for N {
    type Number = N;
    type Double = f64;

    #[inline]
    fn scaled(self, times: N) -> N {
        self * times
    }

    #[inline]
    fn double(self) -> f64 {
        self.into()
    }

    #[inline]
    fn nearest(double: f64) -> N {
        Number::nearest(double)
    }

    fn unscale(scaled: (&[N], &[f64]), contacts: &[u32], r: &mut [f64]) {
        unscale(scaled, contacts, r);
    }
}

impl<T: Number, const N: usize> Numbers for SVector<T, N> {
    type Number = T;
    type Double = SVector<f64, N>;

    #[inline]
    fn scaled(self, times: T) -> Self {
        self * times
    }

    #[inline]
    fn double(self) -> SVector<f64, N> {
        self.map(Into::into)
    }

    #[inline]
    fn nearest(double: SVector<f64, N>) -> Self {
        double.map(Number::nearest)
    }
}

/// A point of the plane or of space, or a direction there: x to the right, y upwards and, in space, z towards who looks.
pub trait Place: Vector + Index<usize, Output = f64> {
    /// From its components, of which the plane has no z.
    fn of(space: [f64; 3]) -> Self;

    /// Its components; in the plane z = 0.
    fn space(self) -> [f64; 3] {
        std::array::from_fn(|axis| if axis < Self::LEN { self[axis] } else { 0.0 })
    }

    /// Its length.
    #[inline]
    fn length(self) -> f64 {
        self.dot_product(self).sqrt()
    }

    /// The least box around `places`, by its least and greatest corner; upside down without any.
    fn extent(places: impl Iterator<Item = Self>) -> [Self; 2] {
        let corner = |x: f64| Self::of([x; 3]);
        places.fold([corner(f64::INFINITY), corner(f64::NEG_INFINITY)], |[low, high], x| {
            [low.with(x, f64::min), high.with(x, f64::max)]
        })
    }
}

impl<const D: usize> Place for SVector<f64, D> {
    fn of(space: [f64; 3]) -> Self {
        Self::from_fn(|axis, _| space[axis])
    }
}

impl Vector for f64 {
    const LEN: usize = 1;
    const ZERO: Self = 0.0;

    #[inline]
    fn at(list: &[f64], index: usize) -> Self {
        list[index]
    }

    #[inline]
    fn put(self, list: &mut [f64], index: usize) {
        list[index] = self;
    }

    #[inline]
    fn with(self, other: Self, join: impl Fn(f64, f64) -> f64) -> Self {
        join(self, other)
    }

    #[inline]
    fn first(self) -> f64 {
        self
    }

    #[inline]
    fn dot_product(self, other: Self) -> f64 {
        self * other
    }

    fn each(self, number: &mut dyn FnMut(f64)) {
        number(self);
    }

    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }

    fn text(self) -> String {
        shown(self)
    }
}

impl<const N: usize> Vector for SVector<f64, N> {
    const LEN: usize = N;
    const ZERO: Self = Self::from_array_storage(ArrayStorage([[0.0; N]]));

    #[inline]
    fn at(list: &[f64], index: usize) -> Self {
        Self::from_column_slice(&list[N * index..N * (index + 1)])
    }

    #[inline]
    fn put(self, list: &mut [f64], index: usize) {
        list[N * index..N * (index + 1)].copy_from_slice(self.as_slice());
    }

    #[inline]
    fn with(self, other: Self, join: impl Fn(f64, f64) -> f64) -> Self {
        self.zip_map(&other, join)
    }

    #[inline]
    fn first(self) -> f64 {
        self[0]
    }

    #[inline]
    fn dot_product(self, other: Self) -> f64 {
        self.dot(&other)
    }

    fn each(self, number: &mut dyn FnMut(f64)) {
        self.iter().for_each(|x| number(*x));
    }

    fn is_finite(self) -> bool {
        self.iter().all(|x| x.is_finite())
    }

    fn text(self) -> String {
        let numbers: Vec<String> = self.iter().map(|x| shown(*x)).collect();
        format!("[{}]", numbers.join(", "))
    }
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

    /// μ (–); 0 without friction.
    fn friction(&self) -> f64 {
        0.0
    }

    /// Reports whether the law admits r, up to round-off of a bound (N·s).
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

/// A contact as a sweep visits it: columns of H̃ = M^-½ H W_D^-½, one per unknown, and the law in these unknowns, in one precision.
pub trait Visited: Copy + Debug + PartialEq + Send + Sync {
    /// y of a grain.
    type Velocity: Numbers;
    /// s of a contact, or its relative velocity.
    type Impulse: Lawful;

    /// Returns the places of candidate and antagonist in y; at a wall twice that of the candidate.
    fn places(&self) -> [u32; 2];

    /// H̃ᵗ y of the y of candidate and antagonist; the latter has no effect at a wall.
    fn between(&self, ends: [Self::Velocity; 2]) -> Self::Impulse;

    /// h̃_α s at candidate and antagonist; 0 at a wall.
    fn pushes(&self, s: Self::Impulse) -> [Self::Velocity; 2];

    /// (H̃ᵗ y)_α.
    #[expect(clippy::inline_always, reason = "it lies in the innermost loop of every method")]
    #[inline(always)]
    fn relative(&self, y: &[Self::Velocity]) -> Self::Impulse {
        let [i, j] = self.places();
        self.between([y[i as usize], y[j as usize]])
    }

    /// Returns what one grain adds to (H̃ᵗ y)_α, from its `place` in y and its y.
    #[inline]
    fn relative_of(&self, place: u32, y: Self::Velocity) -> Self::Impulse {
        let none = Self::Velocity::zeroed();
        self.between(if place == self.places()[0] { [y, none] } else { [none, y] })
    }

    /// y ← y + h̃_α s.
    #[expect(clippy::inline_always, reason = "it lies in the innermost loop of every method")]
    #[inline(always)]
    fn push(&self, s: Self::Impulse, y: &mut [Self::Velocity]) {
        let ([i, j], [candidate, antagonist]) = (self.places(), self.pushes(s));
        y[i as usize] += candidate;
        y[j as usize] += antagonist;
    }

    /// Returns the coefficient of friction in these unknowns, if there is friction.
    fn coefficient(&self) -> <Self::Impulse as Lawful>::Friction;

    /// s⁺ − s of the law, see [`Lawful::change`].
    #[inline]
    fn change(&self, s: Self::Impulse, v: Self::Impulse, relaxation: f64) -> Self::Impulse {
        s.change(v, self.coefficient(), relaxation)
    }

    /// Visits of contacts that share no grain, with the bits of one visit after the other.
    #[inline]
    fn visit<S: Simd>(
        _: S,
        rows: &[Row<Self>; TOGETHER],
        s: &mut [Self::Impulse; TOGETHER],
        y: &mut [Self::Velocity],
        relaxation: f64,
    ) {
        look_then_push(rows, s, y, relaxation);
    }
}

/// A contact of a mechanics as a sweep visits it, whatever the precision.
pub trait VisitedIn<M: Mechanics>:
    Visited<Velocity: Numbers<Double = M::Velocity>, Impulse: Lawful<Double = M::Impulse>>
{
}

impl<M: Mechanics, C> VisitedIn<M> for C where
    C: Visited<Velocity: Numbers<Double = M::Velocity>, Impulse: Lawful<Double = M::Impulse>>
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
