//! Sums that the measures are computed from, over contacts in eight lanes.
//!
//! Terms first, then their sums: a processor makes several of either at the same time, and a compiler sees that it may.

use super::BLOCK;
use crate::law;
use crate::measures::Measures;
use pulp::{Arch, Simd, WithSimd};

/// Contact k of a tile is summed up in lane k mod 8, whatever the processor can do at the same time.
pub(super) const LANES: usize = 8;

/// Contacts whose terms stay in the nearest cache until they are summed up.
pub(super) const TILE: usize = 256;

type Lane = [f64; LANES];

/// Sums that the measures are computed from, over some contacts.
#[derive(Clone, Copy, Default)]
pub struct Sums {
    /// Σ (rᵢ − rᵢ₋₁)².
    pub change: f64,
    /// Σ rᵢ rᵢ₋₁.
    pub product: f64,
    /// Σ `W_αα` (r − r⁺)².
    pub natural_map: f64,
    /// Σ DV².
    pub dv: f64,
    /// Σ (WR² + WR⁺²).
    pub wr_twice: f64,
    /// max |DV|.
    pub greatest_dv: f64,
    /// Number of contacts with r or r⁺ above 0.
    pub active: f64,
    /// The greatest approach velocity (m/s).
    pub penetration_rate: f64,
    /// Its contact; `None` where none approaches.
    pub worst_contact: Option<usize>,
    /// Σ r (v + b).
    pub energy_twice: f64,
    /// Greatest disagreement of copies before gluing (m/s).
    pub velocity_jump: f64,
}

impl Sums {
    /// Number of sums.
    pub const NUMBERS: usize = 11;

    /// Returns the measures with the `scale` of the problem (J), without those that need a solution.
    pub fn measures(&self, scale: f64) -> Measures {
        let (energy, wr) = (0.5 * self.energy_twice, 0.5 * self.wr_twice);
        Measures {
            zeta: self.zeta(),
            natural_map: self.natural_map(scale),
            penetration_rate: self.penetration_rate,
            worst_contact: self.worst_contact,
            quad_dv: ratio(self.dv.sqrt(), wr.sqrt()),
            max_dv: ratio(self.greatest_dv, (wr / self.active.max(1.0)).sqrt()),
            velocity_error: f64::NAN,
            energy_gap: f64::NAN,
            velocity_jump: self.velocity_jump,
            energy,
        }
    }

    /// Returns the natural map with the `scale` of the problem (J).
    pub fn natural_map(&self, scale: f64) -> f64 {
        ratio(self.natural_map.sqrt(), scale.sqrt())
    }

    /// Adds those of other contacts; theirs are numbered from 0 on where these have the `numbers`.
    pub fn join(&mut self, other: &Self, number: impl FnOnce(usize) -> usize) {
        self.change += other.change;
        self.product += other.product;
        self.natural_map += other.natural_map;
        self.dv += other.dv;
        self.wr_twice += other.wr_twice;
        self.greatest_dv = law::greatest([self.greatest_dv, other.greatest_dv].into_iter());
        self.active += other.active;
        self.take_rate(other.penetration_rate, other.worst_contact.map(number));
        self.energy_twice += other.energy_twice;
        self.velocity_jump = law::greatest([self.velocity_jump, other.velocity_jump].into_iter());
    }

    /// Adds the change of the impulses from `before` to `r`, lists of some contacts.
    pub fn take_change(&mut self, before: &[f64], r: &[f64]) {
        let change = Arch::new().dispatch(Change { before, r });
        self.change += change.change;
        self.product += change.product;
    }

    /// ζ; NaN from r = 0.
    fn zeta(&self) -> f64 {
        if self.product > 0.0 { (self.change / self.product).sqrt() } else { f64::NAN }
    }

    /// Takes a rate that is greater than that so far, or NaN, which stays.
    pub(super) fn take_rate(&mut self, rate: f64, contact: Option<usize>) {
        if !(rate <= self.penetration_rate) && !self.penetration_rate.is_nan() {
            (self.penetration_rate, self.worst_contact) = (rate, contact);
        }
    }
}

/// Numbers as ranks send them.
impl From<Sums> for [f64; Sums::NUMBERS] {
    fn from(sums: Sums) -> Self {
        let Sums { change, product, natural_map, dv, wr_twice, greatest_dv, .. } = sums;
        let Sums { active, penetration_rate, worst_contact, energy_twice, velocity_jump, .. } = sums;
        // Exact below 2⁵³.
        let worst = worst_contact.map_or(-1.0, |contact| contact as f64);
        [
            change,
            product,
            natural_map,
            dv,
            wr_twice,
            greatest_dv,
            active,
            penetration_rate,
            worst,
            energy_twice,
            velocity_jump,
        ]
    }
}

impl From<[f64; Self::NUMBERS]> for Sums {
    fn from(numbers: [f64; Self::NUMBERS]) -> Self {
        let [
            change,
            product,
            natural_map,
            dv,
            wr_twice,
            greatest_dv,
            active,
            rate,
            worst,
            energy_twice,
            jump,
        ] = numbers;
        Self {
            change,
            product,
            natural_map,
            dv,
            wr_twice,
            greatest_dv,
            active,
            penetration_rate: rate,
            worst_contact: (worst >= 0.0).then_some(worst as usize),
            energy_twice,
            velocity_jump: jump,
        }
    }
}

/// ζ = √(|r − before|²/(rᵗ before)) (–) of two iterates; NaN from r = 0, or from none.
pub fn zeta(before: &[f64], r: &[f64]) -> f64 {
    let mut sums = Sums::default();
    before.chunks(BLOCK).zip(r.chunks(BLOCK)).for_each(|(before, r)| sums.take_change(before, r));
    sums.zeta()
}

/// A residual over its scale; 0 where there is nothing left, whatever the scale.
pub fn ratio(residual: f64, scale: f64) -> f64 {
    if residual == 0.0 { 0.0 } else { residual / scale }
}

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
pub(super) struct Known<'a> {
    pub(super) delassus: &'a [f64],
    pub(super) inverse: &'a [f64],
    pub(super) b: &'a [f64],
}

/// `W_αα` (r − r⁺)² of a contact (J).
#[inline(always)]
pub(super) fn natural_map(r: f64, v: f64, w: f64, inverse: f64) -> f64 {
    let dv = residual(w * r, v);
    dv * dv * inverse
}

/// Sums, lane by lane, of the contacts of one tile after the other.
pub(super) struct Lanes {
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
    pub(super) fn natural_map(&mut self, r: &[f64], v: &[f64], known: &Known) {
        let known = known.delassus.iter().zip(known.inverse);
        for (term, ((r, v), (w, inverse))) in self.terms.iter_mut().zip(r.iter().zip(v).zip(known)) {
            *term = natural_map(*r, *v, *w, *inverse);
        }
        add(&mut self.natural_map, &self.terms[..r.len()]);
    }

    #[inline(always)]
    pub(super) fn others(&mut self, r: &[f64], v: &[f64], known: &Known) {
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
    pub(super) fn rate(&mut self, v: &[f64], first: usize) {
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

    pub(super) fn sums(self) -> Sums {
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
pub(super) fn squared(r: &[f64]) -> f64 {
    let mut lane = Lane::default();
    each(&mut lane, r, |sum, r| sum + r * r);
    sum(lane)
}

/// Terms of ζ.
struct Change<'a> {
    before: &'a [f64],
    r: &'a [f64],
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
