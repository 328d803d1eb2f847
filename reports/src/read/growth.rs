//! Iterations with subdomains over those without: the pairs of runs, and medians over packings.

use contact::Measure;
use results::Median;

use super::run::label;
use crate::read::{Kind, RunRow, Sample, differing, settings_text, unique};

/// Least number of iterations for a ratio: with fewer, one more or less would be a ratio of its own.
pub(crate) const LEAST: u64 = 10;
/// Accuracies, in decades.
const DECADES: std::ops::RangeInclusive<i32> = 1..=8;

/// The ratios of a method with so many subdomains at an accuracy.
pub(crate) struct Growth<'r> {
    pub(crate) kind: &'r Kind<'r>,
    /// Method and settings, without its subdomains.
    pub(crate) label: String,
    /// One of its runs.
    pub(crate) run: &'r RunRow,
    pub(crate) subdomains: u32,
    pub(crate) measure: Measure,
    /// Logarithm of the accuracy.
    pub(crate) log: f64,
    /// Number of packings that have a run with subdomains and one without.
    pub(crate) pairs: usize,
    /// Number of those of which both reach the accuracy, the one without in as many iterations as a ratio needs.
    pub(crate) packings: usize,
    pub(crate) ratio: Option<Median>,
}

/// Returns the ratios of a kind of problem, ζ and the natural map at each decade.
pub(crate) fn growth<'r>(kind: &'r Kind<'r>) -> Vec<Growth<'r>> {
    let keys = differing(kind.runs.iter().map(|run| (&run.method, &run.settings)), &["subdomains"]);
    let named = |run: &RunRow| label(&run.method, &settings_text((&run.method, &run.settings), &keys));
    let pair = |run: &&'r RunRow| {
        let same: Vec<&RunRow> =
            kind.runs.iter().filter(|other| other.problem == run.problem).copied().collect();
        Some((*run, without_subdomains(run, &same)?))
    };
    let pairs: Vec<(&RunRow, &RunRow)> = kind.runs.iter().filter_map(pair).collect();
    let mut all = Vec::new();
    for (label, subdomains) in unique(pairs.iter().map(|(run, _)| (named(run), run.subdomains))) {
        let own: Vec<_> =
            pairs.iter().filter(|(run, _)| run.subdomains == subdomains && named(run) == label).collect();
        for measure in [Measure::Zeta, Measure::NaturalMap] {
            for log in DECADES.map(|decade| -f64::from(decade)) {
                let ratio = |(run, base): &&(&RunRow, &RunRow)| {
                    let of_base =
                        first(&base.curve, measure, log).filter(|iterations| *iterations >= LEAST)?;
                    Some(first(&run.curve, measure, log)? as f64 / of_base as f64)
                };
                let ratios: Vec<f64> = own.iter().filter_map(ratio).collect();
                all.push(Growth {
                    kind,
                    label: label.clone(),
                    run: own[0].0,
                    subdomains,
                    measure,
                    log,
                    pairs: own.len(),
                    packings: ratios.len(),
                    ratio: Median::of(ratios),
                });
            }
        }
    }
    all
}

/// The run that `run` is NSGS-DD of, which is NSGS; or else its own method's on one subdomain, if that is another run. All
/// settings that both have are the same.
pub(crate) fn without_subdomains<'r>(run: &RunRow, runs: &[&'r RunRow]) -> Option<&'r RunRow> {
    let agrees = |other: &RunRow| {
        let mut settings = run.settings.iter().filter(|(key, _)| *key != "subdomains");
        settings.all(|(key, value)| other.settings.get(key).is_none_or(|of| of == value))
    };
    let is_base = |other: &&&RunRow| {
        other.method == run.without_subdomains()
            && other.subdomains == 1
            && other.run != run.run
            && other.warm_start == run.warm_start
            && agrees(other)
    };
    run.settings.contains_key("subdomains").then(|| runs.iter().find(is_base).copied())?
}

/// Returns the first iteration with a measure of at most 10 to the power of `log`, from which on it stays there.
pub(crate) fn first(curve: &[Sample], measure: Measure, log: f64) -> Option<u64> {
    // Round-off of the power must not lose a whole decade.
    let accuracy = 10f64.powf(log) * (1.0 + 1e-12);
    let values = curve.iter().map(|point| point.get(measure).unwrap_or(f64::NAN));
    results::reached(values, accuracy).map(|at| curve[at].iteration)
}
