//! Worth of LMGC90's norm: the natural map where it first meets a tolerance, over packings.

use contact::Measure;
use results::Median;

use crate::read::{Kind, unique};

/// The natural maps of a method on the packings of a kind, where LMGC90's quadratic norm first meets a tolerance.
pub(crate) struct Norm<'k> {
    pub(crate) kind: &'k Kind<'k>,
    /// Method and settings.
    pub(crate) label: String,
    pub(crate) tolerance: f64,
    /// Number of packings on which the method was run, and on which the norm meets the tolerance.
    pub(crate) packings: usize,
    pub(crate) met: usize,
    pub(crate) natural_map: Median,
}

/// Tolerances of the norm, which samples are kept for.
const TOLERANCES: [f64; 4] = [1e-3, 1e-4, 1e-5, 1e-6];

/// Returns what the norm is worth on a kind of problem, for each of its methods; tolerances that it meets nowhere are left out.
pub(crate) fn norms<'k>(kind: &'k Kind<'k>) -> Vec<Norm<'k>> {
    let mut all = Vec::new();
    for label in unique(kind.runs.iter().map(|run| run.own_label())) {
        let runs = || kind.runs.iter().filter(|run| run.own_label() == label && !run.curve.is_empty());
        for tolerance in TOLERANCES {
            let there = |run: &&&super::RunRow| {
                let mut samples = run.curve.iter().filter(|sample| sample.iteration > 0);
                let first = samples
                    .find(|sample| sample.get(Measure::QuadDv).is_some_and(|norm| norm <= tolerance))?;
                first.get(Measure::NaturalMap)
            };
            let maps: Vec<f64> = runs().filter_map(|run| there(&run)).collect();
            let (packings, met) = (runs().count(), maps.len());
            let norm =
                |natural_map| Norm { kind, label: label.clone(), tolerance, packings, met, natural_map };
            all.extend(Median::of(maps).map(norm));
        }
    }
    all
}
