//! Sums over contacts in eight lanes.
//!
//! Terms first, then their sums: a processor makes several of either at the same time, and a compiler sees that it may.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use super::Sums;
use crate::law;
use pulp::{Simd, WithSimd};

/// Contact k of a tile is summed up in lane k mod 8, whatever the processor can do at the same time.
const LANES: usize = 8;

/// Contacts whose terms stay in the nearest cache until they are summed up.
pub(crate) const TILE: usize = 256;

type Lane = [f64; LANES];

/// −DV = `W_αα` (r − r⁺) = min(`W_αα` r, v), which does not cancel where r is large: a problem without solution drives it there.
/// Written so that a NaN is taken.
#[inline(always)]
fn residual(wr: f64, v: f64) -> f64 {
    if v >= wr { wr } else { v }
}

/// The greater one; not a second that is NaN.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Constants of a contact: `W_αα` (1/kg), 1/`W_αα` (kg), and b (m/s), v without contact impulses.
#[derive(Clone, Copy)]
pub(crate) struct Known<'a> {
    pub(crate) delassus: &'a [f64],
    pub(crate) inverse: &'a [f64],
    pub(crate) b: &'a [f64],
}

/// `W_αα` (r − r⁺)² of a contact (J).
#[inline(always)]
pub(crate) fn natural_map(r: f64, v: f64, w: f64, inverse: f64) -> f64 {
    let dv = residual(w * r, v);
    dv * dv * inverse
}

/// Sums, lane by lane, of the contacts of one tile after the other.
pub(crate) struct Lanes {
    change: Lane,
    product: Lane,
    natural_map: Lane,
    dv: Lane,
    wr_twice: Lane,
    greatest_dv: Lane,
    active: Lane,
    energy_twice: Lane,
    rates: Sums,
    /// The terms of one sum.
    terms: [f64; TILE],
}

impl Default for Lanes {
    fn default() -> Self {
        let lane = Lane::default();
        Self {
            change: lane,
            product: lane,
            natural_map: lane,
            dv: lane,
            wr_twice: lane,
            greatest_dv: lane,
            active: lane,
            energy_twice: lane,
            rates: Sums::default(),
            terms: [0.0; TILE],
        }
    }
}

/// Puts each of the `terms` into its lane, as `join` says.
#[inline(always)]
fn each(lane: &mut Lane, terms: &[f64], join: impl Fn(f64, f64) -> f64) {
    let mut sums = *lane;
    let (whole, rest) = terms.as_chunks::<LANES>();
    for terms in whole {
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum = join(*sum, *term);
        }
    }
    *lane = sums;
    for (sum, term) in lane.iter_mut().zip(rest) {
        *sum = join(*sum, *term);
    }
}

#[inline(always)]
fn add(lane: &mut Lane, terms: &[f64]) {
    each(lane, terms, |sum, term| sum + term);
}

#[inline(always)]
fn sum([a, b, c, d, e, f, g, h]: Lane) -> f64 {
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}

impl Lanes {
    /// Makes the term of each contact from two of its values.
    #[inline(always)]
    fn terms(&mut self, a: &[f64], b: &[f64], term: impl Fn(f64, f64) -> f64) -> usize {
        for (out, (a, b)) in self.terms.iter_mut().zip(a.iter().zip(b)) {
            *out = term(*a, *b);
        }
        a.len()
    }

    #[inline(always)]
    pub(crate) fn natural_map(&mut self, r: &[f64], v: &[f64], known: &Known) {
        let known = known.delassus.iter().zip(known.inverse);
        for (term, ((r, v), (w, inverse))) in self.terms.iter_mut().zip(r.iter().zip(v).zip(known)) {
            *term = natural_map(*r, *v, *w, *inverse);
        }
        add(&mut self.natural_map, &self.terms[..r.len()]);
    }

    #[inline(always)]
    pub(crate) fn others(&mut self, r: &[f64], v: &[f64], known: &Known) {
        let mut pressed = [0.0; TILE];
        let wr = &mut pressed[..r.len()];
        wr.iter_mut().zip(r.iter().zip(known.delassus)).for_each(|(wr, (r, w))| *wr = w * r);
        let n = self.terms(wr, v, |wr, v| residual(wr, v) * residual(wr, v));
        add(&mut self.dv, &self.terms[..n]);
        let n = self.terms(wr, v, |wr, v| residual(wr, v).abs());
        each(&mut self.greatest_dv, &self.terms[..n], greater);
        // W_αα r⁺ = max(0, W_αα r − v)
        let plus = |wr: f64, v: f64| law::non_negative(wr - v);
        let n = self.terms(wr, v, |wr, v| wr * wr + plus(wr, v) * plus(wr, v));
        add(&mut self.wr_twice, &self.terms[..n]);
        let n = self.terms(wr, v, |wr, v| if wr + plus(wr, v) > 0.0 { 1.0 } else { 0.0 });
        add(&mut self.active, &self.terms[..n]);
        for (term, (r, (v, b))) in self.terms.iter_mut().zip(r.iter().zip(v.iter().zip(known.b))) {
            *term = r * (v + b);
        }
        add(&mut self.energy_twice, &self.terms[..n]);
    }

    /// The greatest −v of the contacts from `first` on: which it is, is only sought where there is a new one, or a NaN.
    #[inline(always)]
    pub(crate) fn rate(&mut self, v: &[f64], first: usize) {
        let mut least = Lane::default();
        each(&mut least, v, |least, v| if v < least { v } else { least });
        let greatest = -least.into_iter().fold(0.0, f64::min);
        if greatest > self.rates.penetration_rate || sum(self.natural_map).is_nan() {
            v.iter().zip(first..).for_each(|(v, contact)| self.rates.take_rate(-v, Some(contact)));
        }
    }

    /// Adds the terms of ζ.
    #[inline(always)]
    fn change(&mut self, before: &[f64], r: &[f64]) {
        let n = self.terms(before, r, |before, r| (r - before) * (r - before));
        add(&mut self.change, &self.terms[..n]);
        let n = self.terms(before, r, |before, r| r * before);
        add(&mut self.product, &self.terms[..n]);
    }

    pub(crate) fn sums(self) -> Sums {
        Sums {
            change: sum(self.change),
            product: sum(self.product),
            natural_map: sum(self.natural_map),
            dv: sum(self.dv),
            wr_twice: sum(self.wr_twice),
            greatest_dv: self.greatest_dv.into_iter().fold(0.0, greater),
            active: sum(self.active),
            energy_twice: sum(self.energy_twice),
            ..self.rates
        }
    }
}

/// Σ r².
#[inline(always)]
pub(crate) fn squared(r: &[f64]) -> f64 {
    let mut lane = Lane::default();
    each(&mut lane, r, |sum, r| sum + r * r);
    sum(lane)
}

/// Terms of ζ.
pub(super) struct Change<'a> {
    pub(super) before: &'a [f64],
    pub(super) r: &'a [f64],
}

impl WithSimd for Change<'_> {
    type Output = Sums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Sums {
        let mut lanes = Lanes::default();
        self.before.chunks(TILE).zip(self.r.chunks(TILE)).for_each(|(before, r)| lanes.change(before, r));
        lanes.sums()
    }
}

const _: () = assert!(TILE.is_multiple_of(LANES), "a tile begins in the first lane");
