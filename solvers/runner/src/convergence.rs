//! Check that a run that met its stop rule has converged. ζ, LMGC90's norms and the penetration rate can all be met far from a
//! solution, or where there is none.

use crate::Stop;
use crate::judge::Judge;
use contact::{Measure, Measures};

/// A velocity error of more than this many tolerances is no convergence (–). Over the frozen problems, six methods and
/// tolerances from 1e-2 to 1e-6, runs that stop on the natural map have at most 60, on the penetration rate 71.
const FAR: f64 = 100.0;

/// Nor is, where the solution is not known, a natural map of more than this many tolerances (–): three times the
/// greatest of those runs on ζ, `quad_dv` or `max_dv` whose velocity error is within [`FAR`], 350.
const FAR_ON_THE_NATURAL_MAP: f64 = 1000.0;

/// Largest penetration rate of a converged run, where the solution is not known, over the tolerance (–): the greatest of those runs
/// is 6. It is one-sided: impulses that are too large meet it.
const FAR_ON_THE_RATE: f64 = 100.0;

/// Below this nothing is judged (–): a truth is certified to 1e-12, and its velocity may be off by more.
const LEAST: f64 = 1e-9;

/// Above this share of the natural map of r = 0, which is 1, a proof that there is no solution is looked for however fast the
/// natural map falls (–): with a coarse tolerance a run ends before it can stay.
const HARDLY_FALLEN: f64 = 0.1;

/// Reports whether `stop`, which the last iterate met, is met falsely.
///
/// The truth decides where it is known, and there is no other. Elsewhere the natural map does: it is far above the tolerance, or it
/// stays (`stays`), or has hardly fallen, while one of the `rays`, the impulses and their growth, proves that there is no solution.
pub(crate) fn is_false(
    stop: &Stop,
    judge: &mut impl Judge,
    measures: &Measures,
    stays: bool,
    rays: &dyn Fn() -> Vec<Vec<f64>>,
) -> bool {
    let tolerance = as_a_share(stop, judge);
    if judge.has_one_velocity() && !measures.velocity_error.is_nan() {
        return measures.velocity_error > LEAST.max(FAR * tolerance);
    }
    let far = match stop.on {
        // Met, or not known: nothing says otherwise.
        Measure::NaturalMap | Measure::VelocityError => return false,
        Measure::PenetrationRate => FAR_ON_THE_RATE,
        Measure::Zeta | Measure::QuadDv | Measure::MaxDv => FAR_ON_THE_NATURAL_MAP,
    };
    measures.natural_map > LEAST.max(far * tolerance)
        || measures.natural_map > tolerance
            && (stays || measures.natural_map > HARDLY_FALLEN)
            && judge.any_proves_infeasible(&rays())
}

/// The tolerance of a penetration rate over the rate of r = 0; that of the other measures, which are shares (–).
fn as_a_share(stop: &Stop, judge: &impl Judge) -> f64 {
    if stop.on == Measure::PenetrationRate { stop.tolerance / judge.greatest_rate() } else { stop.tolerance }
}
