//! Types of numbers for which the equations of a visit are written once: in one precision or another, of one contact or of
//! several at once.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use bytemuck::Pod;
use nalgebra::{
    ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, RealField, Scalar, Vector3,
};
use pulp::Simd;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// One number, or several side by side, to each of which an operation does what it does to one alone.
pub trait Lanes:
    Scalar + Copy + ClosedAddAssign + ClosedSubAssign + ClosedMulAssign + ClosedDivAssign + Neg<Output = Self>
{
    /// √.
    #[must_use]
    fn root(self) -> Self;

    /// `x`, as many times as there are numbers here.
    #[must_use]
    fn all(self, x: f64) -> Self;

    /// Returns the result of `then` where a > b, else `or`.
    #[must_use]
    fn where_greater(ab: [Self; 2], then: impl FnOnce() -> Self, or: Self) -> Self;
}

/// Number of one of the precisions of a sweep, with the instructions that take several of them at once.
pub trait Number: Lanes + RealField + Pod + Into<f64> {
    /// Several numbers side by side.
    type Side<S: Simd>: Pod + Debug;
    /// List of these numbers.
    type List: AsRef<[Self]>;

    /// Number of them.
    const SIDE: usize;

    /// Returns how many numbers a processor takes at once.
    fn lanes<S: Simd>() -> usize;

    /// Returns the nearest number of this precision.
    fn nearest(x: f64) -> Self;

    /// Takes the numbers `of` 0 to [`Number::SIDE`] − 1.
    fn gather<S: Simd>(simd: S, of: impl Fn(usize) -> Self) -> Self::Side<S>;

    /// Takes two numbers each `of` 0 to [`Number::SIDE`] − 1: where these lie side by side in memory, two shuffles in the place of many
    /// moves.
    fn gather_pairs<S: Simd>(simd: S, of: impl Fn(usize) -> [Self; 2]) -> [Self::Side<S>; 2];

    /// Returns the numbers one by one.
    fn list<S: Simd>(of: Self::Side<S>) -> Self::List;

    /// Returns `x` in every place.
    fn repeated<S: Simd>(simd: S, x: Self) -> Self::Side<S>;

    /// −a.
    fn negated<S: Simd>(simd: S, a: Self::Side<S>) -> Self::Side<S>;

    /// √a.
    fn roots<S: Simd>(simd: S, a: Self::Side<S>) -> Self::Side<S>;

    /// a + b.
    fn sum<S: Simd>(simd: S, a: Self::Side<S>, b: Self::Side<S>) -> Self::Side<S>;

    /// a − b.
    fn difference<S: Simd>(simd: S, a: Self::Side<S>, b: Self::Side<S>) -> Self::Side<S>;

    /// a b.
    fn product<S: Simd>(simd: S, a: Self::Side<S>, b: Self::Side<S>) -> Self::Side<S>;

    /// a/b.
    fn quotient<S: Simd>(simd: S, a: Self::Side<S>, b: Self::Side<S>) -> Self::Side<S>;

    /// Returns what of `then` is in the places where a > b, and of `or` elsewhere.
    fn where_above<S: Simd>(
        simd: S,
        ab: [Self::Side<S>; 2],
        then: Self::Side<S>,
        or: Self::Side<S>,
    ) -> Self::Side<S>;
}

/// The instructions of one precision: how many numbers they take, which of a gather are even and odd, and their names.
macro_rules! number {
    ($number:ident, $several:ident, $side:literal, $lanes:ident, [$($k:literal)*], [$($even:literal)*], [$($odd:literal)*],
        $splat:ident $neg:ident $sqrt:ident $add:ident $sub:ident $mul:ident $div:ident $greater:ident $select:ident
        $deinterleave:ident) => {
        impl Lanes for $number {
            #[inline(always)]
            fn root(self) -> Self {
                Self::sqrt(self)
            }

            #[inline(always)]
            fn all(self, x: f64) -> Self {
                x as Self
            }

            #[inline(always)]
            fn where_greater([a, b]: [Self; 2], then: impl FnOnce() -> Self, or: Self) -> Self {
                if a > b { then() } else { or }
            }
        }

        impl Number for $number {
            type Side<S: Simd> = S::$several;
            type List = [Self; $side];

            const SIDE: usize = $side;

            #[inline(always)]
            fn lanes<S: Simd>() -> usize {
                S::$lanes
            }

            #[inline(always)]
            fn nearest(x: f64) -> Self {
                x as Self
            }

            #[inline(always)]
            fn gather<S: Simd>(_: S, of: impl Fn(usize) -> Self) -> S::$several {
                bytemuck::cast([$(of($k)),*])
            }

            #[inline(always)]
            fn gather_pairs<S: Simd>(simd: S, of: impl Fn(usize) -> [Self; 2]) -> [S::$several; 2] {
                simd.$deinterleave([bytemuck::cast([$(of($even)),*]), bytemuck::cast([$(of($odd)),*])])
            }

            #[inline(always)]
            fn list<S: Simd>(of: S::$several) -> Self::List {
                bytemuck::cast(of)
            }

            #[inline(always)]
            fn repeated<S: Simd>(simd: S, x: Self) -> S::$several {
                simd.$splat(x)
            }

            #[inline(always)]
            fn negated<S: Simd>(simd: S, a: S::$several) -> S::$several {
                simd.$neg(a)
            }

            #[inline(always)]
            fn roots<S: Simd>(simd: S, a: S::$several) -> S::$several {
                simd.$sqrt(a)
            }

            #[inline(always)]
            fn sum<S: Simd>(simd: S, a: S::$several, b: S::$several) -> S::$several {
                simd.$add(a, b)
            }

            #[inline(always)]
            fn difference<S: Simd>(simd: S, a: S::$several, b: S::$several) -> S::$several {
                simd.$sub(a, b)
            }

            #[inline(always)]
            fn product<S: Simd>(simd: S, a: S::$several, b: S::$several) -> S::$several {
                simd.$mul(a, b)
            }

            #[inline(always)]
            fn quotient<S: Simd>(simd: S, a: S::$several, b: S::$several) -> S::$several {
                simd.$div(a, b)
            }

            #[inline(always)]
            fn where_above<S: Simd>(
                simd: S,
                [a, b]: [S::$several; 2],
                then: S::$several,
                or: S::$several,
            ) -> S::$several {
                simd.$select(simd.$greater(a, b), then, or)
            }
        }
    };
}

number!(
    f64, f64s, 4, F64_LANES, [0 1 2 3], [0 2], [1 3],
    splat_f64s neg_f64s sqrt_f64s add_f64s sub_f64s mul_f64s div_f64s greater_than_f64s select_f64s deinterleave_shfl_f64s
);
number!(
    f32, f32s, 8, F32_LANES, [0 1 2 3 4 5 6 7], [0 2 4 6], [1 3 5 7],
    splat_f32s neg_f32s sqrt_f32s add_f32s sub_f32s mul_f32s div_f32s greater_than_f32s select_f32s deinterleave_shfl_f32s
);

/// Several numbers, on a processor whose instructions take as many.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side<S: Simd, N: Number> {
    simd: S,
    numbers: N::Side<S>,
}

impl<S: Simd, N: Number> Side<S, N> {
    /// The numbers `of` each. It panics where [`Number::lanes`] is not [`Number::SIDE`]: who calls it has asked.
    #[inline(always)]
    pub(crate) fn new(simd: S, of: impl Fn(usize) -> N) -> Self {
        Self { simd, numbers: N::gather(simd, of) }
    }

    /// The first numbers `of` each, and the second. On 2,799 contacts between spheres with friction a visit takes 15.6 ns so, and 20.3
    /// number by number.
    #[inline(always)]
    pub(crate) fn pair(simd: S, of: impl Fn(usize) -> [N; 2]) -> [Self; 2] {
        N::gather_pairs(simd, of).map(|numbers| Self { simd, numbers })
    }

    /// The vectors `of` each.
    #[inline(always)]
    pub(crate) fn vector(simd: S, of: impl Fn(usize) -> [N; 3]) -> Vector3<Self> {
        let [x, y] = Self::pair(simd, |k| [of(k)[0], of(k)[1]]);
        Vector3::new(x, y, Self::new(simd, |k| of(k)[2]))
    }

    /// Returns the vectors one by one.
    #[inline(always)]
    pub(crate) fn apart(of: Vector3<Self>) -> impl Fn(usize) -> Vector3<N> {
        let [x, y, z] = [of.x, of.y, of.z].map(|numbers| N::list(numbers.numbers));
        move |k| Vector3::new(x.as_ref()[k], y.as_ref()[k], z.as_ref()[k])
    }
}

impl<S: Simd, N: Number> PartialEq for Side<S, N> {
    fn eq(&self, other: &Self) -> bool {
        N::list(self.numbers).as_ref() == N::list(other.numbers).as_ref()
    }
}

impl<S: Simd, N: Number> Lanes for Side<S, N> {
    #[inline(always)]
    fn root(self) -> Self {
        Self { numbers: N::roots(self.simd, self.numbers), ..self }
    }

    #[inline(always)]
    fn all(self, x: f64) -> Self {
        Self { numbers: N::repeated(self.simd, N::nearest(x)), ..self }
    }

    #[inline(always)]
    fn where_greater([a, b]: [Self; 2], then: impl FnOnce() -> Self, or: Self) -> Self {
        Self { numbers: N::where_above(a.simd, [a.numbers, b.numbers], then().numbers, or.numbers), ..a }
    }
}

impl<S: Simd, N: Number> Neg for Side<S, N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { numbers: N::negated(self.simd, self.numbers), ..self }
    }
}

macro_rules! operation {
    ($operator:ident::$of:ident, $assigned:ident::$assign:ident, $on_all:ident) => {
        impl<S: Simd, N: Number> $operator for Side<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $of(self, other: Self) -> Self {
                Self { numbers: N::$on_all(self.simd, self.numbers, other.numbers), ..self }
            }
        }

        impl<S: Simd, N: Number> $assigned for Side<S, N> {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                *self = (*self).$of(other);
            }
        }
    };
}

operation!(Add::add, AddAssign::add_assign, sum);
operation!(Sub::sub, SubAssign::sub_assign, difference);
operation!(Mul::mul, MulAssign::mul_assign, product);
operation!(Div::div, DivAssign::div_assign, quotient);
