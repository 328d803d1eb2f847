//! Cost of a run at a sample, and the first sample at which it was accurate.

use contact::Measure;
use results::Median;

use crate::read::run::defined;
use crate::read::{RunRow, Sample, power_of_ten};

/// The accuracies that methods are compared at: the velocity error, or where it is not known the natural map.
pub(crate) const ACCURACIES: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// An accuracy as a power of ten.
pub(crate) fn accuracy_text(accuracy: f64) -> String {
    power_of_ten(accuracy.log10().round() as i32)
}

/// A kind of cost.
pub(crate) struct Cost {
    pub(crate) name: &'static str,
    /// Name of its axis.
    pub(crate) title: &'static str,
    pub(crate) of: fn(&RunRow, &Sample) -> Option<f64>,
    /// True where it is measured, with a spread; false where it is counted.
    is_timed: bool,
}

/// Fewest repeats of which the least and the greatest hold the median with a probability of 90 % or more: 1 − 2/2⁵.
const REPEATS: u32 = 5;

impl Cost {
    /// The cost of a run to an accuracy of a measure, if it comes there.
    pub(crate) fn to(&self, run: &RunRow, measure: Measure, accuracy: f64) -> Option<f64> {
        let values = run.curve.iter().map(|point| point.get(measure).unwrap_or(f64::NAN));
        (self.of)(run, &run.curve[results::reached(values, accuracy)?])
    }

    /// Returns that cost with its interval, which has no width where it is counted, and no bound where it is timed fewer than five times.
    pub(crate) fn within(&self, run: &RunRow, measure: Measure, accuracy: f64) -> Option<Median> {
        let cost = self.to(run, measure, accuracy)?;
        if !self.is_timed {
            return Some(Median { low: cost, median: cost, high: cost });
        }
        let few = run.timing.repeats < REPEATS;
        if few { Some(Median { low: 0.0, median: cost, high: f64::INFINITY }) } else { run.interval(cost) }
    }

    /// The runs with the least cost to an accuracy of a measure: one, or those whose intervals overlap its own. None where seconds of one
    /// of them are of fewer than five repeats.
    pub(crate) fn least<'r>(&self, runs: &[&'r RunRow], measure: Measure, accuracy: f64) -> Vec<&'r RunRow> {
        let priced = |run: &'_ &'r RunRow| Some((self.within(run, measure, accuracy)?, *run));
        let priced: Vec<(Median, &RunRow)> = runs.iter().filter_map(priced).collect();
        if self.is_timed && priced.iter().any(|(_, run)| run.timing.repeats < REPEATS) {
            return Vec::new();
        }
        let first = priced.iter().min_by(|(a, _), (b, _)| a.median.total_cmp(&b.median));
        let Some(high) = first.map(|(first, _)| first.high) else { return Vec::new() };
        priced.iter().filter(|(cost, _)| cost.low <= high).map(|(_, run)| *run).collect()
    }
}

pub(crate) const COSTS: [Cost; 2] = [
    Cost {
        name: "seconds",
        title: "set-up and iterations (s)",
        of: |run, point| Some(run.setup_s? + defined(point.iterating_s)?),
        is_timed: true,
    },
    Cost { name: "sweeps", title: "counted work (sweeps)", of: RunRow::work, is_timed: false },
];

/// Definition of a sweep of counted work.
pub(crate) const WORK: &str = "A sweep of counted work is eight multiply-adds per contact of the problem: a contact updated \
                               counts as much as a contact passed in a product with W, an entry of a triangular factor and \
                               a multiply-add of a factorisation an eighth. A run with many factorisations that a \
                               library makes, which are not counted, has no counted work.";
