//! A run of a study on a problem, and the samples of its curve.

use std::ops::Deref;

use contact::{Measure, Work};
use results::Median;
use results::journal::Record;
use results::schema::{Run, Sample, Snapshot};
use results::settings::{CASE, FRICTION};

use crate::own::shown;
use crate::read::{Ending, counted, number, unique};

/// A run with all that is stored of it, and what is read from that; a number that is undefined there is `None` here.
#[derive(Clone)]
pub(crate) struct RunRow {
    row: Run,
    /// Its number in the study.
    pub(crate) run: u32,
    /// The settings in which runs of its method differ, as they are read, and how it starts if they differ in that.
    pub(crate) words: String,
    /// The settings alone.
    pub(crate) set: String,
    pub(crate) tolerance: Option<f64>,
    pub(crate) setup_s: Option<f64>,
    pub(crate) iterating_s: Option<f64>,
    /// The last sample, whether or not a curve is stored.
    pub(crate) end: Sample,
    /// In the order of the iterations.
    pub(crate) curve: Vec<Sample>,
    pub(crate) snapshots: Vec<Snapshot>,
}

impl Deref for RunRow {
    type Target = Run;

    fn deref(&self) -> &Run {
        &self.row
    }
}

/// `None` for NaN.
pub(crate) fn defined(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

impl RunRow {
    pub(crate) fn of(run: u32, Record { run: row, curve, snapshots }: &Record) -> Self {
        let (measures, work) = (row.end.measures, row.end.work);
        let end = Sample { iteration: row.iterations, iterating_s: row.iterating_s, measures, work };
        Self {
            run,
            words: String::new(),
            set: String::new(),
            tolerance: defined(row.tolerance),
            setup_s: defined(row.setup_s),
            iterating_s: defined(row.iterating_s),
            end,
            curve: curve.clone(),
            snapshots: snapshots.clone(),
            row: row.clone(),
        }
    }

    pub(crate) fn label(&self) -> String {
        label(&self.method, &self.words)
    }

    /// Returns the method and its settings, however the run starts.
    pub(crate) fn own_label(&self) -> String {
        label(&self.method, &self.set)
    }

    pub(crate) fn has_converged(&self) -> bool {
        self.status == Ending::Converged
    }

    /// Returns the stopping rule as a sentence has it.
    pub(crate) fn rule(&self) -> Option<String> {
        Some(format!("{} ≤ {}", self.stop_on.0.name().replace('_', " "), number(self.tolerance?, 2)))
    }

    /// Copies the run with the partition of another: for a method whose iterates do not depend on that.
    pub(crate) fn shared_as(&self, other: &Self) -> Self {
        let mut shared = self.clone();
        shared.row.subdomains = other.subdomains;
        shared.row.spectrum.clone_from(&other.row.spectrum);
        shared
    }

    /// Returns the time of an iteration (s).
    pub(crate) fn seconds_per_iteration(&self) -> Option<f64> {
        self.iterating_s.filter(|_| self.iterations > 0).map(|seconds| seconds / self.iterations as f64)
    }

    /// Multiply-adds of an iteration on the longest subdomain.
    pub(crate) fn path_per_iteration(&self) -> Option<f64> {
        self.derived.get("critical_path")?.as_f64()
    }

    /// Set-up and iterations (s).
    pub(crate) fn seconds(&self) -> Option<f64> {
        Some(self.setup_s? + self.iterating_s?)
    }

    /// Returns seconds up to a sample with their interval: as wide, as a factor to either side, as that of the whole run in proportion; of
    /// a run timed once nothing is known.
    pub(crate) fn interval(&self, median: f64) -> Option<Median> {
        let width = (self.timing.setup_spread_s + self.timing.iterating_spread_s) / self.seconds()?;
        let factor = if width.is_nan() { f64::INFINITY } else { 1.0 + width };
        Some(Median { low: median / factor, median, high: median * factor })
    }

    /// Returns the least natural map of its samples, and the first iteration with it.
    pub(crate) fn least(&self) -> Option<(f64, u64)> {
        let measured =
            self.curve.iter().filter_map(|sample| Some((sample.get(Measure::NaturalMap)?, sample.iteration)));
        measured.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Returns the measure that the run was stopped on; the natural map, the working measure, stands for those that are no error.
    pub(crate) fn stopped_on(&self) -> Measure {
        match self.stop_on.0 {
            error @ (Measure::Zeta | Measure::QuadDv | Measure::VelocityError) => error,
            _ => Measure::NaturalMap,
        }
    }

    /// The name of the case of its problem, if that is of one.
    pub(crate) fn case(&self) -> Option<&str> {
        self.problem_settings.get(CASE)?.as_str()
    }

    /// μ of its grains, where the study sets it (–).
    pub(crate) fn friction(&self) -> Option<f64> {
        self.problem_settings.get(FRICTION)?.as_f64()
    }

    /// Counted work in sweeps over `contacts`: a contact updated counts as much as a contact passed in a product W p, that
    /// is eight multiply-adds (two components of two grains, read and written back); an entry of a triangular factor is one.
    /// So is a multiply-add of a factorisation. A run that makes more than a few without counting them, as rows of before they were
    /// counted and solvers of others do, has no counted work; nor has one that counts none after an iteration.
    pub(crate) fn work(&self, sample: &Sample) -> Option<f64> {
        let Work { contact_updates, delassus_products, triangular_solve_entries, factorisations, .. } =
            sample.work;
        let of_factorisations = sample.work.factorisation_multiply_adds;
        let few = factorisations <= 6 * (u64::from(self.subdomains) + 1) || of_factorisations > 0;
        let contacts = f64::from(self.contacts.max(1));
        let visits = contact_updates as f64 + contacts * delassus_products as f64;
        let work = visits + (triangular_solve_entries + of_factorisations) as f64 / 8.0;
        (few && (work > 0.0 || sample.iteration == 0)).then_some(work / contacts)
    }
}

/// Method and variant, as a key says them.
pub(crate) fn label(method: &str, variant: &str) -> String {
    let method = shown(method);
    match variant {
        "" => method.to_owned(),
        grid if grid.starts_with(|c: char| c.is_ascii_digit()) => format!("{method} {grid}"),
        words => format!("{method}, {words}"),
    }
}

/// States how often each was run for its seconds, as a note.
pub(crate) fn repeats(runs: &[RunRow]) -> String {
    match range(runs, |run| run.timing.repeats) {
        (_, 1) => "One run each.".to_owned(),
        (least, most) if least == most => format!("Seconds: medians of {most} runs each."),
        (least, most) => format!("Seconds: medians of {least} to {most} runs each."),
    }
}

/// States the number of threads of the runs, in words.
pub(crate) fn threads(runs: &[RunRow]) -> String {
    match range(runs, |run| run.provenance.threads) {
        (least, most) if least == most => counted(most as usize, "thread"),
        (least, most) => format!("{least} to {most} threads"),
    }
}

fn range(runs: &[RunRow], of: fn(&RunRow) -> u32) -> (u32, u32) {
    let (least, most) = (runs.iter().map(of).min(), runs.iter().map(of).max());
    (least.unwrap_or(1), most.unwrap_or(1))
}

/// Reports whether the tolerance of all runs is a natural map of 10⁻², which figures show beside tighter ones.
pub(crate) fn stopped_at_1e_2<'r>(runs: impl IntoIterator<Item = &'r RunRow>) -> bool {
    runs.into_iter().all(|run| run.stop_on.0 == Measure::NaturalMap && run.tolerance == Some(1e-2))
}

/// The problems in the order of the study.
pub(crate) fn problems<'r>(runs: impl IntoIterator<Item = &'r RunRow>) -> Vec<&'r str> {
    unique(runs.into_iter().map(|run| run.problem.as_str()))
}

#[cfg(test)]
mod tests;
