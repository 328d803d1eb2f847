//! The contact law, eq. (2): 0 ≤ v ⊥ r ≥ 0, as a fixed point; and maxima that do not hide a NaN.

use crate::lanes::{Lanes, Number};
use crate::vector::Numbers;
use nalgebra::{SVector, Vector2, Vector3};
use std::fmt::Debug;

/// max(0, s), the projection on admissible impulses, which hands a NaN on instead of hiding it as `f64::max` does.
#[inline]
pub fn non_negative(s: f64) -> f64 {
    if 0.0 > s { 0.0 } else { s }
}

/// r⁺ = max(0, r − ω v / `W_αα`): with ω = 1, the impulse that solves (2) at one contact when all others are kept.
/// `inverse_delassus` is 1/`W_αα` (kg), `relaxation` is ω (–).
#[inline]
pub fn update(r: f64, v: f64, inverse_delassus: f64, relaxation: f64) -> f64 {
    non_negative(r - relaxation * v * inverse_delassus)
}

/// r⁺ − r = max(−r, −ω v) of [`update`] where `W_αα` = 1, which waits for v one addition less; r plus this is NaN where r or v
/// is.
#[expect(clippy::inline_always, reason = "else it lacks the instructions that its caller is made for")]
#[inline(always)]
pub fn change<N: Lanes>(r: N, v: N, relaxation: f64) -> N {
    let change = v.all(-relaxation) * v;
    N::where_greater([-r, change], || -r, change)
}

/// s, or the nearest value of at most `bound` in size, which is not negative; a NaN is handed on.
///
/// A minimum and a maximum: which contacts slide is hard to predict, and among 202,094 contacts of discs branches took 12 of the 20 ns
/// of a visit.
#[inline]
pub fn clip<N: Number>(s: N, bound: N) -> N {
    let below = if s > bound { bound } else { s };
    if below < -bound { -bound } else { below }
}

/// The tangential part of an impulse, or the nearest one of at most `bound` in size.
#[expect(clippy::inline_always, reason = "else it lacks the instructions that its caller is made for")]
#[inline(always)]
fn clipped<N: Lanes>([first, second]: [N; 2], bound: N) -> [N; 2] {
    let squared = first * first + second * second;
    // A NaN is handed on.
    let factor = N::where_greater([squared, bound * bound], || bound / squared.root(), bound.all(1.0));
    [factor * first, factor * second]
}

/// s⁺ − s between spheres: `s_n⁺` = max(0, `s_n` − ω `v_n`), then `s_t⁺` = clip(`s_t` − ω `v_t`, μ̃ `s_n⁺`) to the disc of that radius.
/// The two lines solve (2′), since `W_αα` is diagonal and the same along both tangents.
#[expect(clippy::inline_always, reason = "else it lacks the instructions that its caller is made for")]
#[inline(always)]
pub(crate) fn change_in_space<N: Lanes>(
    s: Vector3<N>,
    v: Vector3<N>,
    friction: N,
    relaxation: f64,
) -> Vector3<N> {
    let normal = change(s.x, v.x, relaxation);
    let moved = s - v * v.x.all(relaxation);
    let [first, second] = clipped([moved.y, moved.z], friction * (s.x + normal));
    Vector3::new(normal, first - s.y, second - s.z)
}

/// Law of a contact in mass-scaled unknowns, for impulses `I`.
pub trait Lawful<I: Numbers>: Copy + Debug + PartialEq + Send + Sync {
    /// s⁺ − s, where the diagonal of `W_αα` is 1 and with the relaxation ω (–), of the impulse that solves the law at the contact when all
    /// others are kept.
    #[must_use]
    fn change(self, s: I, v: I, relaxation: f64) -> I;
}

/// The Signorini condition, 0 ≤ v ⊥ s ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signorini;

/// Coulomb's law, with its μ √(`w_t`/`w_n`) (–).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<N>(pub N);

impl<N: Number> Lawful<N> for Signorini {
    #[inline]
    fn change(self, s: N, v: N, relaxation: f64) -> N {
        change(s, v, relaxation)
    }
}

impl<N: Number> Lawful<Vector2<N>> for Coulomb<N> {
    /// `s_n⁺` = max(0, `s_n` − ω `v_n`), then `s_t⁺` = clip(`s_t` − ω `v_t`, μ̃ `s_n⁺`): the two lines solve (2′), since `W_αα` is
    /// diagonal.
    #[inline]
    fn change(self, s: Vector2<N>, v: Vector2<N>, relaxation: f64) -> Vector2<N> {
        let normal = change(s.x, v.x, relaxation);
        let bound = self.0 * (s.x + normal);
        Vector2::new(normal, clip(s.y - N::nearest(relaxation) * v.y, bound) - s.y)
    }
}

impl<N: Number> Lawful<Vector3<N>> for Coulomb<N> {
    #[inline]
    fn change(self, s: Vector3<N>, v: Vector3<N>, relaxation: f64) -> Vector3<N> {
        change_in_space(s, v, self.0, relaxation)
    }
}

/// The tangential part of what has its normal component first, and its size.
#[inline]
pub fn tangential<const D: usize>(mut s: SVector<f64, D>) -> (SVector<f64, D>, f64) {
    s[0] = 0.0;
    (s, s.norm())
}

/// The nearest impulse of the cone along its own tangent, of one with its normal component first.
#[inline]
pub fn admissible<const D: usize>(s: SVector<f64, D>, friction: f64) -> SVector<f64, D> {
    let normal = non_negative(s[0]);
    let bound = friction * normal;
    let (mut r, size) = tangential(s);
    if D == 2 {
        r[1] = clip(s[1], bound);
    } else if size > bound {
        r *= bound / size;
    }
    r[0] = normal;
    r
}

/// The greatest value; NaN if there is one, 0 for none.
pub fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |greatest: f64, x| if greatest.is_nan() || x <= greatest { greatest } else { x })
}

#[cfg(test)]
mod tests;
