//! The fastest methods to an accuracy on problems of one kind, with ties.

use contact::Measure;
use results::Median;

use crate::read::{COSTS, Ending, Kind, RunRow, problems, unique};

/// Returns the values of the natural map at which methods are ranked: none below the tolerance at which all of `runs` stop.
pub(crate) fn natural_maps(runs: &[RunRow]) -> Vec<f64> {
    let tolerance = |run: &RunRow| if run.stop_on.0 == Measure::NaturalMap { run.tolerance } else { None };
    let least = runs.iter().map(|run| tolerance(run).unwrap_or(0.0)).fold(f64::INFINITY, f64::min);
    [1e-2, 1e-4, 1e-6, 1e-8, 1e-10].into_iter().filter(|accuracy| *accuracy >= least).collect()
}

/// A method on problems of one kind.
pub(crate) struct Standing {
    /// Method and settings.
    pub(crate) label: String,
    /// Number of problems on which it reached the accuracy.
    pub(crate) reached: usize,
    /// Seconds there.
    pub(crate) seconds: Median,
    /// Its seconds over those of the fastest method of each problem: median, and where they are most.
    pub(crate) ratio: f64,
    pub(crate) worst: f64,
    /// True where no difference from the first shows: it reached the accuracy on as many problems, and is not slower on enough of them
    /// by more than the intervals of both times.
    pub(crate) ties: bool,
}

/// A method over all kinds of problem and sizes, at an accuracy.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) label: String,
    pub(crate) accuracy: f64,
    /// Number of kinds, those of a size apart, that it has runs on and some method solves.
    pub(crate) kinds: usize,
    /// Number of those in which it is first alone, and in which it is first or ties.
    pub(crate) alone: usize,
    pub(crate) first: usize,
    /// Number of problems on which it reached the accuracy, of all that it was run on.
    pub(crate) reached: usize,
    pub(crate) problems: usize,
    /// Its seconds over those of the fastest method of each problem, where they are most.
    pub(crate) worst: f64,
}

/// The standings of a kind at an accuracy.
pub(crate) struct Ranked<'k, 'r> {
    pub(crate) kind: &'k Kind<'r>,
    pub(crate) accuracy: f64,
    pub(crate) standings: Vec<Standing>,
}

/// Ranks the methods of each kind at each accuracy.
pub(crate) fn ranked<'k, 'r>(kinds: &'k [Kind<'r>], accuracies: &[f64]) -> Vec<Ranked<'k, 'r>> {
    let at = |kind: &'k Kind<'r>, accuracy: f64| Ranked {
        kind,
        accuracy,
        standings: standings(&kind.runs, accuracy),
    };
    kinds.iter().flat_map(|kind| accuracies.iter().map(move |accuracy| at(kind, *accuracy))).collect()
}

/// Counts in how many kinds each of the methods `labels` is first, at each accuracy.
pub(crate) fn tallies(ranked: &[Ranked], labels: &[String], accuracies: &[f64]) -> Vec<Tally> {
    let tally = |accuracy: f64, label: &String| {
        let mut tally = Tally { label: label.clone(), accuracy, ..Tally::default() };
        for Ranked { kind, standings, .. } in ranked.iter().filter(|ranked| ranked.accuracy == accuracy) {
            let made = |run: &&&RunRow| run.own_label() == *label && run.status != Ending::Skipped;
            let runs = kind.runs.iter().filter(made).count();
            tally.problems += runs;
            tally.kinds += usize::from(runs > 0 && !standings.is_empty());
            let Some(own) = standings.iter().find(|standing| standing.label == *label) else { continue };
            let ties = standings.iter().filter(|standing| standing.ties).count();
            tally.first += usize::from(own.ties);
            tally.alone += usize::from(own.ties && ties == 1);
            tally.reached += own.reached;
            tally.worst = tally.worst.max(own.worst);
        }
        tally
    };
    accuracies.iter().flat_map(|accuracy| labels.iter().map(|label| tally(*accuracy, label))).collect()
}

/// Returns the seconds after which the natural map of a run is at most `accuracy` and stays there, set-up included.
fn seconds(run: &RunRow, accuracy: f64) -> Option<Median> {
    run.interval(COSTS[0].to(run, Measure::NaturalMap, accuracy)?)
}

/// Ranks the methods of `runs` by a natural map of `accuracy`: those that reach it on more problems first, then those whose
/// median ratio to the fastest of each problem is less. One that reaches it on none is not among them.
fn standings(runs: &[&RunRow], accuracy: f64) -> Vec<Standing> {
    let problems = problems(runs.iter().copied());
    let labels = unique(runs.iter().map(|run| run.own_label()));
    let of_label = |label: &String| {
        let all: Vec<&RunRow> = runs.iter().filter(|run| run.own_label() == *label).copied().collect();
        let on = |problem: &&str| {
            all.iter().find(|run| run.problem == *problem).and_then(|run| seconds(run, accuracy))
        };
        Times { label: label.clone(), seconds: problems.iter().map(on).collect() }
    };
    let times: Vec<Times> = labels.iter().map(of_label).collect();
    let fastest = |k: usize| {
        let there = times.iter().filter_map(|times| Some(times.seconds[k]?.median));
        there.fold(f64::INFINITY, f64::min)
    };
    let fastest: Vec<f64> = (0..problems.len()).map(fastest).collect();
    let mut all: Vec<(&Times, Median)> =
        times.iter().filter_map(|times| Some((times, Median::of(times.over(&fastest))?))).collect();
    let order = |(a, of_a): &(&Times, Median), (b, of_b): &(&Times, Median)| {
        b.reached().cmp(&a.reached()).then(of_a.median.total_cmp(&of_b.median))
    };
    all.sort_by(order);
    let standing = |(times, of): &(&Times, Median)| {
        let (first, _) = all[0];
        Some(Standing {
            label: times.label.clone(),
            reached: times.reached(),
            seconds: Median::of(times.seconds.iter().flatten().map(|seconds| seconds.median).collect())?,
            ratio: of.median,
            worst: times.over(&fastest).into_iter().fold(1.0, f64::max),
            ties: times.reached() == first.reached() && !times.is_slower_than(first),
        })
    };
    all.iter().filter_map(standing).collect()
}

/// Seconds of a method on each of some problems, `None` where it does not reach the accuracy.
struct Times {
    label: String,
    seconds: Vec<Option<Median>>,
}

impl Times {
    fn reached(&self) -> usize {
        self.seconds.iter().flatten().count()
    }

    /// Returns the ratios to the `fastest` times; a problem that no method needs any time for has 1.
    fn over(&self, fastest: &[f64]) -> Vec<f64> {
        let there = self
            .seconds
            .iter()
            .zip(fastest)
            .filter_map(|(seconds, fastest)| Some((seconds.as_ref()?.median, fastest)));
        there.map(|(time, fastest)| if time > 0.0 { time / fastest } else { 1.0 }).collect()
    }

    /// Reports whether the least ratio to the times of another that the intervals of both allow has an interval above 1.
    fn is_slower_than(&self, other: &Self) -> bool {
        let both = self.seconds.iter().zip(&other.seconds);
        let least = both.filter_map(|(it, other)| Some(it.as_ref()?.low / other.as_ref()?.high));
        Median::of(least.collect()).is_some_and(|least| least.low > 1.0)
    }
}

#[cfg(test)]
mod tests;
