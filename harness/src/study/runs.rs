//! A plan with its problems at hand: the runs that it asks for, each with its identity.

use crate::identity::{code_version, first_hex};
use crate::plan::variants::Variant;
use crate::problems::files::Root;
use crate::problems::planned::{PlannedProblem, Problem};
use crate::study::selection::Selection;
use anyhow::Result;
use contact::{Measure, Stop};
use reference::InteriorPoint;
use results::journal::Record;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashMap, HashSet};

/// A plan with those of its problems that are at hand: all that runs to be made need, and others that need not be made.
pub(crate) struct Study {
    pub(crate) selection: Selection,
    pub(crate) problems: Vec<Problem>,
}

/// One run that a study asks for.
#[derive(Clone)]
pub(crate) struct Task<'s> {
    pub(crate) problem: &'s Problem,
    pub(crate) variant: &'s Variant,
    pub(crate) id: String,
}

impl Study {
    /// Makes the problems of the runs to be made.
    pub(crate) fn made(selection: Selection, root: &Root) -> Result<Self> {
        let needed = |problem: &PlannedProblem| {
            selection.variants.iter().any(|variant| selection.selects(&problem.name, variant))
        };
        let mut problems = Vec::new();
        for problem in &selection.problems {
            let made = if needed(problem) { Some(problem.made(root)?) } else { problem.at_hand(root) };
            problems.extend(made);
        }
        Ok(Self { selection, problems })
    }

    /// Makes nothing.
    pub(crate) fn at_hand(selection: Selection, root: &Root) -> Self {
        let problems = selection.problems.iter().filter_map(|problem| problem.at_hand(root)).collect();
        Self { selection, problems }
    }

    /// Every run on the problems at hand, in the order of the plan.
    pub(crate) fn tasks(&self) -> Vec<Task<'_>> {
        let of_problem =
            |problem| self.selection.variants.iter().map(move |variant| self.task(problem, variant));
        self.problems.iter().flat_map(of_problem).collect()
    }

    /// The runs to be made whose id is not in `done`, each once.
    pub(crate) fn missing(&self, done: &HashSet<&str>) -> Vec<Task<'_>> {
        let mut known = HashSet::new();
        let mut tasks = self.tasks();
        tasks.retain(|task| self.selection.selects(&task.problem.frozen.name, task.variant));
        tasks.retain(|task| !done.contains(task.id.as_str()) && known.insert(task.id.clone()));
        tasks
    }

    fn task<'s>(&'s self, problem: &'s Problem, variant: &'s Variant) -> Task<'s> {
        let id = run_id(&problem.hash, variant, &self.selection.plan.stop);
        Task { problem, variant, id }
    }
}

/// How far a study is.
pub(crate) struct Progress<'s> {
    /// The runs that are missing, each once.
    pub(crate) missing: Vec<Task<'s>>,
    /// How long the missing ones take, one at a time, judged by those of the same method that are there, or else by all;
    /// `None` if there are none (s).
    pub(crate) left_s: Option<f64>,
}

impl Study {
    /// Which of the runs to be made the records lack.
    pub(crate) fn progress(&self, records: &[Record]) -> Progress<'_> {
        let done: HashSet<&str> = records.iter().map(|record| record.run.id.as_str()).collect();
        let missing = self.missing(&done);
        let seconds = records.iter().map(|Record { run, .. }| (&*run.method, run.timing.wall_s));
        let left_s = left_s(seconds, missing.iter().map(|task| task.variant.method.name));
        Progress { missing, left_s }
    }
}

/// How long runs of the `missing` methods take, judged by the `seconds` of those of each method that are there, or else by
/// all; `None` if there are none (s).
pub(crate) fn left_s<'s>(
    seconds: impl Iterator<Item = (&'s str, f64)>,
    missing: impl Iterator<Item = &'s str>,
) -> Option<f64> {
    let mut of_methods: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    // A run that was skipped took no time.
    for (method, wall_s) in seconds.filter(|(_, wall_s)| wall_s.is_finite()) {
        of_methods.entry(method).or_default().push(wall_s);
    }
    let all = median(of_methods.values().flatten().copied().collect());
    let of_method: BTreeMap<&str, Option<f64>> =
        of_methods.into_iter().map(|(method, seconds)| (method, median(seconds))).collect();
    missing.map(|method| of_method.get(method).copied().flatten().or(all)).sum()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The same id means the same counts: on any machine, with any number of threads.
pub(crate) fn run_id(problem_hash: &str, variant: &Variant, stop: &Stop) -> String {
    let Variant { method, warm_start, .. } = variant;
    // Sorted, whatever the map of the JSON crate does with its keys.
    let settings: BTreeMap<_, _> = method.settings.iter().collect();
    // What stops on the error needs the solution, and whether ζ lied is judged by it.
    let truth = matches!(stop.on, Measure::VelocityError | Measure::Zeta).then(code_version::<InteriorPoint>);
    let stop = (stop.on, stop.tolerance, stop.max_iterations);
    let all = json!([problem_hash, method.name, method.code, settings, stop, warm_start, truth]);
    first_hex(Sha256::digest(all.to_string()).as_slice())
}

impl Task<'_> {
    /// The run, as it is told to the user.
    pub(crate) fn name(&self) -> String {
        format!("{} on {}", self.variant.label(), self.problem.frozen.name)
    }
}

/// The records that count, by id: of two, the later.
pub(crate) fn by_id(records: &[Record]) -> HashMap<&str, &Record> {
    records.iter().map(|record| (record.run.id.as_str(), record)).collect()
}
