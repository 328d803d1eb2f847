//! A plan with its problems at hand: the runs that it asks for, each with its identity.

use crate::identity::run_id;
use crate::plan::{Plan, Variant};
use crate::problems::Problem;
use results::journal::Record;
use std::collections::{BTreeMap, HashMap, HashSet};

/// A plan and all that it names.
pub(crate) struct Study {
    /// The arguments that ask for it again.
    pub(crate) again: String,
    /// The plan; its name says whether it is quick, changed or not the whole one.
    pub(crate) plan: Plan,
    pub(crate) problems: Vec<Problem>,
    pub(crate) variants: Vec<Variant>,
    /// What was changed or left out, in words.
    pub(crate) notes: Vec<String>,
}

/// One run that a study asks for.
#[derive(Clone)]
pub(crate) struct Task<'s> {
    pub(crate) problem: &'s Problem,
    pub(crate) variant: &'s Variant,
    pub(crate) id: String,
}

impl Study {
    /// Every run, in the order of the plan.
    pub(crate) fn tasks(&self) -> Vec<Task<'_>> {
        let of_problem = |problem| self.variants.iter().map(move |variant| self.task(problem, variant));
        self.problems.iter().flat_map(of_problem).collect()
    }

    /// The runs whose id is not in `done`, each once.
    pub(crate) fn missing(&self, done: &HashSet<&str>) -> Vec<Task<'_>> {
        let mut known = HashSet::new();
        let mut tasks = self.tasks();
        tasks.retain(|task| !done.contains(task.id.as_str()) && known.insert(task.id.clone()));
        tasks
    }

    fn task<'s>(&'s self, problem: &'s Problem, variant: &'s Variant) -> Task<'s> {
        let id = run_id(&problem.hash, &variant.method, &self.plan.stop, self.plan.warm_start);
        Task { problem, variant, id }
    }
}

/// How much of a study there is.
pub(crate) struct Made<'s> {
    /// The runs that are missing, each once.
    pub(crate) missing: Vec<Task<'s>>,
    /// How long the missing ones take, one at a time, judged by those of the same method that are there, or else by all;
    /// `None` if there are none (s).
    pub(crate) left_s: Option<f64>,
}

impl Study {
    /// Which runs the records lack.
    pub(crate) fn made(&self, records: &[Record]) -> Made<'_> {
        let done: HashSet<&str> = records.iter().map(|record| record.run.id.as_str()).collect();
        let missing = self.missing(&done);
        let seconds = records.iter().map(|Record { run, .. }| (&*run.method, run.timing.wall_s));
        let left_s = left_s(seconds, missing.iter().map(|task| task.variant.method.name));
        Made { missing, left_s }
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

impl Task<'_> {
    /// The run, as it is told to the user.
    pub(crate) fn name(&self) -> String {
        let name = format!("{} {}", self.variant.method.name, self.variant.name);
        format!("{} on {}", name.trim_end(), self.problem.frozen.name)
    }
}

/// The records that count, by id: of two, the later.
pub(crate) fn by_id(records: &[Record]) -> HashMap<&str, &Record> {
    records.iter().map(|record| (record.run.id.as_str(), record)).collect()
}
