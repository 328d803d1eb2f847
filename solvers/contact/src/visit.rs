//! A visit of a contact: its relative velocity, the impulse that the law has for it, and the change of the grains' velocities.

#![expect(
    clippy::inline_always,
    reason = "what visits are made of is called in two places, and a call would cost a third of a visit"
)]

use crate::lanes::Number;
use crate::law::Lawful;
use crate::vector::Numbers;
use bytemuck::Zeroable;
use pulp::Simd;
use std::fmt::Debug;

/// A contact as a sweep visits it: columns of H̃ = M^-½ H W_D^-½, one per unknown, and the law in these unknowns, in one precision.
pub trait Visited: Copy + Debug + PartialEq + Send + Sync {
    /// y of a grain.
    type Velocity: Numbers;
    /// s of a contact, or its relative velocity.
    type Impulse: Numbers;
    /// Law of the contact in these unknowns.
    type Law: Lawful<Self::Impulse>;

    /// Returns the places of candidate and antagonist in y; at a wall twice that of the candidate.
    fn places(&self) -> [u32; 2];

    /// H̃ᵗ y of the y of candidate and antagonist; the latter has no effect at a wall.
    fn between(&self, ends: [Self::Velocity; 2]) -> Self::Impulse;

    /// h̃_α s at candidate and antagonist; 0 at a wall.
    fn pushes(&self, s: Self::Impulse) -> [Self::Velocity; 2];

    /// (H̃ᵗ y)_α.
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
    #[inline(always)]
    fn push(&self, s: Self::Impulse, y: &mut [Self::Velocity]) {
        let ([i, j], [candidate, antagonist]) = (self.places(), self.pushes(s));
        y[i as usize] += candidate;
        y[j as usize] += antagonist;
    }

    /// Returns the law in these unknowns.
    fn law(&self) -> Self::Law;

    /// s⁺ − s of the law, see [`Lawful::change`].
    #[inline]
    fn change(&self, s: Self::Impulse, v: Self::Impulse, relaxation: f64) -> Self::Impulse {
        self.law().change(s, v, relaxation)
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

/// One contact as a sweep needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<C: Visited> {
    pub(crate) column: C,
    /// c/√`W_αα` (√J).
    pub(crate) offset: C::Impulse,
}

impl<C: Visited> Row<C> {
    /// (H̃ᵗ y)_α + c/√`W_αα` (√J).
    #[inline(always)]
    pub fn relative(&self, y: &[C::Velocity]) -> C::Impulse {
        self.column.relative(y) + self.offset
    }

    /// s⁺ − s of the law, at the relative velocity v/√`W_αα` (√J).
    #[inline(always)]
    pub fn change(&self, s: C::Impulse, v: C::Impulse, relaxation: f64) -> C::Impulse {
        self.column.change(s, v, relaxation)
    }

    /// y ← y + h̃_α Δs.
    #[inline(always)]
    pub fn push(&self, change: C::Impulse, y: &mut [C::Velocity]) {
        self.column.push(change, y);
    }

    /// v = Hᵗ V + c at α; r⁺ = max(0, r − ω v/`W_αα`), or what the law says; V ← V + M⁻¹ `h_α` (r⁺ − r). Returns √`W_αα` (r⁺ − r)
    /// (√J).
    #[inline(always)]
    pub fn solve(&self, s: &mut C::Impulse, y: &mut [C::Velocity], relaxation: f64) -> C::Impulse {
        let change = self.change(*s, self.relative(y), relaxation);
        self.push(change, y);
        *s += change;
        change
    }
}

/// Number of visits made at a time, where no two of them share a grain. A visit is a chain of operations, each of which waits for
/// the one before; a processor that has several of them at hand waits less, and [`Visited::visit`] may compute some at once. When it was
/// chosen, on 8,476 contacts between spheres with friction, a visit took 13.4 ns, in fours 15.9, in sixteens 13.0, of which small
/// subdomains have few; without AVX2 17.4; alone, 21.7.
pub const TOGETHER: usize = 8;

/// Adds H̃ s to velocities y, so many `times`.
pub(crate) fn push_all<C: Visited>(rows: &[Row<C>], s: &[C::Impulse], times: f64, y: &mut [C::Velocity]) {
    let times = Number::nearest(times);
    for (row, s) in rows.iter().zip(s) {
        row.push(s.scaled(times), y);
    }
}

/// Visits rows that share no grain: all velocities are read before any impulse is applied.
#[inline(always)]
pub(crate) fn look_then_push<C: Visited>(
    rows: &[Row<C>; TOGETHER],
    s: &mut [C::Impulse; TOGETHER],
    y: &mut [C::Velocity],
    relaxation: f64,
) {
    let mut changes = [C::Impulse::zeroed(); TOGETHER];
    for k in 0..TOGETHER {
        changes[k] = rows[k].change(s[k], rows[k].relative(y), relaxation);
    }
    for k in 0..TOGETHER {
        rows[k].push(changes[k], y);
        s[k] += changes[k];
    }
}
