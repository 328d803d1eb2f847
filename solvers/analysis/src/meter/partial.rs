//! Proof, from less than all its measures, that an iterate does not end a run.
//!
//! Most measures are sums of squares, or maxima: a few contacts, taken from all over the packing, prove that the whole is
//! above a tolerance, long before it comes near. Nothing is assumed of how a measure falls.

use super::{Meter, Part, Solution};
use contact::mechanics::Gauge;
use contact::{ContactProblem, Measure, Measures, Mechanics, Vector, zeta};

/// One of so many contacts or grains is evaluated, at most. More are no cheaper than all.
const SHARE: usize = 16;

/// Nearer to the tolerance than this (–), some of [`SHARE`] seldom prove anything: its root, and a margin.
const FAR: f64 = 5.0;

/// Relative margin by which round-off may make a sum over all less than that over a part (–).
const ROUND_OFF: f64 = 1e-6;

/// Below this, squares lose digits.
const TINY: f64 = 1e-290;

/// Data of the problem that bound the size of an iterate's energy, and of the iterate measured last.
#[derive(Default)]
pub(super) struct Bounds {
    /// λmax(W_D⁻¹W) is at most the trace, the number of unknowns.
    trace: f64,
    /// √(Σ b²/`W_αα`) (√J).
    b: f64,
    /// Strides from one contact, or grain, to the next one that is evaluated.
    strides: [usize; 2],
    /// The contact that approached fastest when all were evaluated.
    worst_contact: usize,
    /// Natural map then; not yet known, above any tolerance.
    natural_map: Option<f64>,
}

impl Bounds {
    pub(super) fn new<M: Mechanics>(gauge: &M::Gauge, problem: &ContactProblem<M>) -> Self {
        Self {
            trace: problem.impulse_count() as f64,
            b: gauge.size_of_b(),
            strides: [problem.contact_count(), problem.grain_count()].map(stride),
            ..Self::default()
        }
    }

    /// Remembers an iterate that was measured wholly.
    pub(super) fn take(&mut self, measures: &Measures) {
        self.worst_contact = measures.worst_contact.unwrap_or(self.worst_contact);
        self.natural_map = Some(measures.natural_map);
    }

    /// No |q(r)|, and no Σ `W_αα` (r − r⁺)², is above this (J): with s = √`W_αα` r and `W_D⁻¹W` no greater than its trace, both are at
    /// most twice the square of trace · |s| + √(Σ b²/`W_αα`).
    fn energy(&self, size: f64) -> f64 {
        2.0 * (self.trace * size + self.b) * (self.trace * size + self.b)
    }
}

impl<M: Mechanics> Meter<'_, M> {
    /// Reports whether the iterate `r` (N·s), which comes after `before`, is proved to have a measure `on` that is above `tolerance`, or is
    /// NaN, and an energy of at most `energy` (J) and a natural map that is finite. It is as [`Meter::measure_after`] would say, and most
    /// often costs a fraction of it; `false` says nothing. Of ranks it is `false`: measuring all is one exchange and one sum, and to prove
    /// less is no cheaper.
    pub fn goes_on(
        &mut self,
        on: Measure,
        tolerance: f64,
        energy: f64,
        (before, r): (&[f64], &[f64]),
    ) -> bool {
        let (None, [part]) = (self.share, &self.parts[..]) else { return false };
        self.bounds.energy(part.gauge.size(r)) <= energy.min(f64::MAX)
            && match on {
                Measure::NaturalMap => {
                    self.bounds.natural_map.is_none_or(|last| last > FAR * tolerance)
                        && self.natural_map_of_some(part, tolerance, r)
                        || {
                            self.push(&[], r);
                            let natural_map = self.pull([&[], r], 0.0, true).natural_map(self.scale);
                            self.bounds.natural_map = Some(natural_map);
                            natural_map > tolerance
                        }
                }
                Measure::Zeta => !(zeta(before, r) <= tolerance),
                Measure::PenetrationRate => self.rate_of_some(part, tolerance, r),
                Measure::VelocityError => {
                    let mut known = self.solutions.iter().enumerate();
                    !self.solutions.is_empty()
                        && known.all(|known| self.error_of_some(part, known, tolerance, r))
                        || {
                            self.push(&[], r);
                            self.velocity_error() > tolerance
                        }
                }
                // Quotients of two sums.
                Measure::QuadDv | Measure::MaxDv => false,
            }
    }

    fn natural_map_of_some(&self, part: &Part<M>, tolerance: f64, r: &[f64]) -> bool {
        let contacts = r.len() / M::Impulse::LEN;
        exceeds(contacts, self.bounds.strides[0], least(tolerance, self.scale), |k| part.gauge.alone(k, r).0)
    }

    fn rate_of_some(&self, part: &Part<M>, tolerance: f64, r: &[f64]) -> bool {
        let is_above = |contact| part.gauge.alone(contact, r).1 > tolerance;
        let contacts = r.len() / M::Impulse::LEN;
        contacts > 0 && is_above(self.bounds.worst_contact)
            || some(contacts, self.bounds.strides[0]).any(is_above)
    }

    fn error_of_some(
        &self,
        part: &Part<M>,
        (k, known): (usize, &Solution),
        tolerance: f64,
        r: &[f64],
    ) -> bool {
        let term = |grain| part.gauge.squared(grain, part.gauge.gather(grain, r) - part.solutions[k][grain]);
        let scale = known.distance * known.distance;
        exceeds(part.weight.len(), self.bounds.strides[1], least(tolerance, scale), term)
    }
}

/// Returns the bound above which a part of a sum of squares proves that its root, over that of the `scale`, is above the tolerance.
fn least(tolerance: f64, scale: f64) -> f64 {
    let least = tolerance * tolerance * scale;
    if tolerance == 0.0 || least > TINY { (1.0 + ROUND_OFF) * least } else { f64::INFINITY }
}

/// Reports whether the sum of the `term`s of some of `all` is above a bound; the summation ends where it is.
fn exceeds(all: usize, stride: usize, bound: f64, term: impl Fn(usize) -> f64) -> bool {
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
fn stride(all: usize) -> usize {
    let divisor = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = (0.618_034 * all as f64) as usize;
    (golden.max(1)..=all).find(|stride| divisor(*stride, all) == 1).unwrap_or(1)
}
