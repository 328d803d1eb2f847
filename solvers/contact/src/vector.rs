//! Short lists of numbers: impulses, velocities and places, of any precision and dimension.

use crate::error::shown;
use crate::lanes::Number;
use bytemuck::Pod;
use nalgebra::{ArrayStorage, SVector};
use pulp::{Arch, Simd, WithSimd};
use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub, SubAssign};

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
        self.components().fold(0.0, Add::add)
    }

    /// Returns the components, the first one first.
    fn components(self) -> impl Iterator<Item = f64> {
        (0..Self::LEN).map(move |k| bytemuck::cast_slice(std::slice::from_ref(&self))[k])
    }

    /// Reports whether no component is infinite or NaN.
    fn is_finite(self) -> bool {
        self.components().all(f64::is_finite)
    }

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

    fn text(self) -> String {
        let numbers: Vec<String> = self.iter().map(|x| shown(*x)).collect();
        format!("[{}]", numbers.join(", "))
    }
}

/// r = s/√`W_αα`, or whatever the `unit` is, of each of some `contacts` of a problem, in the problem's order (N·s).
pub fn unscale<N: Number>(scaled: (&[N], &[f64]), contacts: &[u32], r: &mut [f64]) {
    Arch::new().dispatch(Unscale { scaled, contacts, r });
}

struct Unscale<'a, N> {
    scaled: (&'a [N], &'a [f64]),
    contacts: &'a [u32],
    r: &'a mut [f64],
}

/// Divisions at the same time.
const LANES: usize = 4;

impl<N: Number> WithSimd for Unscale<'_, N> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "else the processor's instructions are not those chosen")]
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { scaled: (s, unit), contacts, r } = self;
        let ((s, last_s), (unit, last_unit)) = (s.as_chunks::<LANES>(), unit.as_chunks::<LANES>());
        let (contacts, last) = contacts.as_chunks::<LANES>();
        for ((s, unit), contacts) in s.iter().zip(unit).zip(contacts) {
            let quotients: [f64; LANES] = std::array::from_fn(|k| s[k].into() / unit[k]);
            contacts.iter().zip(quotients).for_each(|(contact, r_of)| r[*contact as usize] = r_of);
        }
        for ((s, unit), contact) in last_s.iter().zip(last_unit).zip(last) {
            r[*contact as usize] = (*s).into() / unit;
        }
    }
}
