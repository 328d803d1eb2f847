//! A plan with its problems at hand: the runs that it asks for, each with its identity.

use crate::identity::run_id;
use crate::plan::{Plan, Variant};
use crate::problems::Problem;
use results::journal::Record;
use results::schema::Run;
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
        let mut seconds: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for Run { method, timing, .. } in records.iter().map(|record| &record.run) {
            // A run that was skipped took no time.
            if timing.wall_s.is_finite() {
                seconds.entry(method).or_default().push(timing.wall_s);
            }
        }
        let all = median(seconds.values().flatten().copied().collect());
        let of_method: BTreeMap<&str, Option<f64>> =
            seconds.into_iter().map(|(method, seconds)| (method, median(seconds))).collect();
        let one = |task: &Task| of_method.get(task.variant.method.name).copied().flatten().or(all);
        let left_s = missing.iter().map(one).sum();
        Made { missing, left_s }
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
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
