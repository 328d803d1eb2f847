//! Cost of a run at a sample, and the first sample at which it was accurate.

use crate::read::run::defined;
use crate::read::{RunRow, Sample, power_of_ten};

/// The accuracies that methods are compared at: the velocity error.
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
}

impl Cost {
    /// The cost of a run to a velocity error, if it comes there.
    pub(crate) fn to(&self, run: &RunRow, accuracy: f64) -> Option<f64> {
        (self.of)(run, reached(&run.curve, accuracy)?)
    }
}

pub(crate) const COSTS: [Cost; 2] = [
    Cost {
        name: "seconds",
        title: "set-up and iterations (s)",
        of: |run, point| Some(run.setup_s? + defined(point.iterating_s)?),
    },
    Cost { name: "sweeps", title: "counted work (sweeps)", of: RunRow::work },
];

/// Definition of a sweep of counted work.
pub(crate) const WORK: &str = "A sweep of counted work is eight multiply-adds per contact of the problem: a contact updated \
                               counts as much as a contact passed in a product with W, an entry of a triangular factor and \
                               a multiply-add of a factorisation an eighth. A run with many factorisations that a \
                               library makes, which are not counted, has no counted work.";

/// Returns the first sample with a velocity error of at most `accuracy`, from which on it stays there.
fn reached(curve: &[Sample], accuracy: f64) -> Option<&Sample> {
    let errors = curve.iter().map(|point| point.velocity_error().unwrap_or(f64::NAN));
    results::reached(errors, accuracy).map(|at| &curve[at])
}
