//! That an iterate does not end a run, from less than all its measures.
//!
//! Most measures are sums of squares, or maxima: a few contacts, taken from all over the packing, prove that the whole is
//! above a tolerance, long before it comes near. Nothing is assumed of how a measure falls.

use super::passes::Columns;
use super::sums::{Sums, natural_map, squared, zeta};
use super::{BLOCK, Known, Meter};
use crate::discs::Smooth;
use crate::measure::Measure;
use crate::problem::ContactProblem;
use pulp::{Arch, Simd, WithSimd};

/// One of so many contacts or grains is looked at, at most. More are no cheaper than all.
const SHARE: usize = 16;

/// Nearer to the tolerance than this (–), some of [`SHARE`] seldom prove anything: its root, and a margin.
pub(crate) const FAR: f64 = 5.0;

/// Relative margin by which round-off may make a sum over all less than that over a part (–).
const ROUND_OFF: f64 = 1e-6;

/// Below this, squares lose digits.
const TINY: f64 = 1e-290;

/// Data of the problem that bound the size of an iterate's energy.
pub(super) struct Size {
    /// λmax(W_D⁻¹W) is at most the trace, the number of contacts.
    contacts: f64,
    /// The greatest `W_αα` (1/kg).
    delassus: f64,
    /// √(Σ b²/`W_αα`) (√J).
    b: f64,
    /// Strides from one contact, or grain, to the next one that is checked.
    strides: [usize; 2],
}

impl Size {
    pub(super) fn new<const D: usize>(columns: &Columns<D>, problem: &ContactProblem<Smooth<D>>) -> Self {
        Self {
            contacts: problem.contact_count() as f64,
            delassus: columns.greatest_delassus(),
            b: columns.size_of_b(),
            strides: [problem.contact_count(), problem.grain_count()].map(stride),
        }
    }
}

impl<const D: usize> Meter<'_, D> {
    /// Reports whether the iterate `r` (N·s), which comes after `before`, is proved to have a measure `on` that is above `tolerance`, or is
    /// NaN, and an energy of at most `energy` (J) and a natural map that is finite. It is as [`Meter::measure_after`] would say, and most
    /// often costs a fraction of it; `false` says nothing.
    pub fn goes_on(
        &mut self,
        on: Measure,
        tolerance: f64,
        energy: f64,
        (before, r): (&[f64], &[f64]),
    ) -> bool {
        self.energy_at_most(r) <= energy.min(f64::MAX)
            && match on {
                Measure::NaturalMap => {
                    self.natural_map > FAR * tolerance && self.natural_map_of_some(tolerance, r) || {
                        self.push(r);
                        let sums = self.pull((&[], r), true);
                        self.natural_map(&sums) > tolerance
                    }
                }
                Measure::Zeta => !(Arch::new().dispatch(Change { before, r }).zeta() <= tolerance),
                Measure::PenetrationRate => self.rate_of_some(tolerance, r),
                Measure::VelocityError => {
                    let known = self.truth.take();
                    let above = known.as_ref().is_some_and(|known| {
                        self.error_of_some(known, tolerance, r) || {
                            self.push(r);
                            self.velocity_error(known) > tolerance
                        }
                    });
                    self.truth = known;
                    above
                }
                // Quotients of two sums.
                Measure::QuadDv | Measure::MaxDv => false,
            }
    }

    /// No |q(r)|, and no Σ `W_αα` (r − r⁺)², is above this (J): with s = √`W_αα` r, |s| ≤ √max `W_αα` |r| and `W_D⁻¹W` no greater
    /// than its trace, both are at most twice the square of trace · |s| + √(Σ b²/`W_αα`).
    fn energy_at_most(&self, r: &[f64]) -> f64 {
        let Size { contacts, delassus, b, .. } = self.size;
        let s = (delassus * Arch::new().dispatch(Squared(r))).sqrt();
        2.0 * (contacts * s + b) * (contacts * s + b)
    }

    fn natural_map_of_some(&self, tolerance: f64, r: &[f64]) -> bool {
        let term = |contact: usize| {
            let (w, inverse) = self.columns.diagonal(contact);
            natural_map(r[contact], self.columns.alone(contact, r), w, inverse)
        };
        exceeds(r.len(), self.size.strides[0], least(tolerance, self.scale), term)
    }

    fn rate_of_some(&self, tolerance: f64, r: &[f64]) -> bool {
        let is_above = |contact| -self.columns.alone(contact, r) > tolerance;
        !r.is_empty() && is_above(self.worst_contact) || some(r.len(), self.size.strides[0]).any(is_above)
    }

    fn error_of_some(&self, known: &Known<D>, tolerance: f64, r: &[f64]) -> bool {
        let term = |grain| self.squared_error(known, grain, self.columns.gather(grain, r));
        let scale = known.distance * known.distance;
        exceeds(known.pushed.len(), self.size.strides[1], least(tolerance, scale), term)
    }
}

/// Above what a part of a sum of squares proves that its root, over that of the `scale`, is above the tolerance.
pub(crate) fn least(tolerance: f64, scale: f64) -> f64 {
    let least = tolerance * tolerance * scale;
    if tolerance == 0.0 || least > TINY { (1.0 + ROUND_OFF) * least } else { f64::INFINITY }
}

/// Reports whether the sum of the `term`s of some of `all` is above a bound; the summation ends where it is.
pub(crate) fn exceeds(all: usize, stride: usize, bound: f64, term: impl Fn(usize) -> f64) -> bool {
    let mut sum = 0.0;
    some(all, stride).any(|k| {
        sum += term(k);
        sum > bound
    })
}

/// Some of `all`, from all over, none twice.
fn some(all: usize, stride: usize) -> impl Iterator<Item = usize> {
    (0..all.div_ceil(SHARE)).scan(0, move |k, _| {
        *k = (*k + stride) % all;
        Some(*k)
    })
}

/// About the golden section of `all`, by which the first few are spread best, and without a common divisor, so that all come
/// before one comes again.
pub(crate) fn stride(all: usize) -> usize {
    let divisor = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = (0.618_034 * all as f64) as usize;
    (golden.max(1)..=all).find(|stride| divisor(*stride, all) == 1).unwrap_or(1)
}

struct Squared<'a>(&'a [f64]);

impl WithSimd for Squared<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        squared(self.0)
    }
}

/// The sums that ζ is made of, with the bits that they have among all.
struct Change<'a> {
    before: &'a [f64],
    r: &'a [f64],
}

impl WithSimd for Change<'_> {
    type Output = Sums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Sums {
        let mut sums = Sums::default();
        for (before, r) in self.before.chunks(BLOCK).zip(self.r.chunks(BLOCK)) {
            sums.join(&zeta(before, r), 0);
        }
        sums
    }
}
