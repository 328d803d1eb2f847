//! Runs of one method that agree in all but what a chart varies, as a series.

use std::collections::BTreeMap;

use crate::draw::{Look, Looks};
use crate::own::shown;
use crate::read::{RunRow, differing, settings_text};

/// The runs of a method with the same settings.
#[derive(Clone)]
pub(crate) struct Series<'r> {
    pub(crate) method: &'r str,
    /// The settings in which it differs from the method's other series.
    pub(crate) group: String,
    pub(crate) look: Look,
    pub(crate) runs: Vec<&'r RunRow>,
    /// True where runs on other problems compare, such as those with as many grains in each subdomain.
    pub(crate) across: bool,
}

/// All series in the order of the study; runs of one may differ in the settings `varied`. Every one has a sign.
pub(crate) fn series<'r>(runs: impl IntoIterator<Item = &'r RunRow>, varied: &[&str]) -> Vec<Series<'r>> {
    let runs: Vec<&RunRow> = runs.into_iter().collect();
    let (keys, looks) = (
        differing(runs.iter().map(|run| (&run.method, &run.settings)), varied),
        Looks::new(runs.iter().copied()),
    );
    let one_method = runs.windows(2).all(|pair| pair[0].method == pair[1].method);
    let mut all: Vec<Series> = Vec::new();
    let mut known: BTreeMap<(&str, String), usize> = BTreeMap::new();
    let mut of_method: BTreeMap<&str, usize> = BTreeMap::new();
    for run in runs {
        let group = settings_text((&run.method, &run.settings), &keys);
        if let Some(&index) = known.get(&(run.method.as_str(), group.clone())) {
            all[index].runs.push(run);
            continue;
        }
        let earlier = of_method.entry(&run.method).or_default();
        let look = if one_method {
            looks.variant_alone(&run.method, *earlier)
        } else {
            looks.variant(&run.method, *earlier)
        };
        *earlier += 1;
        known.insert((&run.method, group.clone()), all.len());
        all.push(Series { method: &run.method, group, look: look.signed(), runs: vec![run], across: false });
    }
    all
}

impl<'r> Series<'r> {
    pub(crate) fn label(&self) -> String {
        if self.group.is_empty() {
            shown(self.method).to_owned()
        } else {
            format!("{}, {}", shown(self.method), self.group)
        }
    }

    /// The run with the fewest subdomains that differs from `run` in them alone, and in the problem where the series is across
    /// problems.
    pub(crate) fn fewest(&self, run: &RunRow) -> Option<&'r RunRow> {
        let same = |other: &&&RunRow| {
            (self.across || other.problem == run.problem) && other.warm_start == run.warm_start
        };
        self.runs.iter().filter(same).min_by_key(|other| other.subdomains).copied()
    }

    /// Returns that run if both converged.
    pub(crate) fn fewest_converged(&self, run: &RunRow) -> Option<&'r RunRow> {
        self.fewest(run).filter(|fewest| fewest.has_converged() && run.has_converged())
    }

    /// Returns the iterations of a run over those with the fewest subdomains.
    pub(crate) fn growth(&self, run: &RunRow) -> Option<f64> {
        let fewest = self.fewest_converged(run)?.iterations;
        (fewest > 0).then(|| run.iterations as f64 / fewest as f64)
    }
}
