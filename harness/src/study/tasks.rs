//! A study is a list of tasks, each with its id; what runs them, and what becomes of them, does not ask of which kind they
//! are: runs on problems, or simulations.

use crate::root::Root;
use crate::run::{Conditions, How, Task, in_parallel};
use crate::study::Selection;
use crate::terminal::{Bars, exit};
use anyhow::Result;
use results::journal::Entry;
use results::median;
use results::study::Study as Rows;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::{Mutex, PoisonError};

/// A kind of study.
pub(crate) trait Kind: Sized + Sync {
    /// Stored record of a task that has ended.
    type Record: Entry + Clone + Send + Sync;
    /// Problem that a variant is run on, or simulation.
    type What<'s>: Clone + Sync
    where
        Self: 's;
    /// Name of the tasks, in the plural.
    const TASKS: &'static str;

    /// The study of a selection; problems that are needed and not there are computed first, if `compute` says so.
    fn new(selection: Selection, root: &Root, compute: bool) -> Result<Self>;

    /// Returns the selection from the plan.
    fn selection(&self) -> &Selection;

    /// Every task, in the order of the plan.
    fn tasks(&self) -> Vec<Task<'_, Self::What<'_>>>;

    /// Runs a task; `None` if it was halted.
    fn run(&self, task: &Task<Self::What<'_>>, conditions: &Conditions) -> Result<Option<Self::Record>>;

    /// Returns the number of tasks of the whole plan.
    fn size(&self) -> usize;

    /// Returns, in words, the work that the plan asks for.
    fn asks(&self) -> String;

    /// The tasks as they are listed, where those whose ids are in `done` have ended.
    fn listed(&self, done: &HashSet<&str>) -> Vec<Listed>;

    /// The rows of what has ended, under the names that the plan gives them now.
    fn rows(&self, root: &Root, ended: Vec<(Task<Self::What<'_>>, Self::Record)>) -> Result<Rows>;
}

/// A task as it is listed.
pub(crate) struct Listed {
    pub(crate) problem: String,
    pub(crate) method: &'static str,
    pub(crate) variant: String,
    pub(crate) done: bool,
}

/// The selected tasks whose id is not in `done`, each once.
pub(crate) fn missing<'s, W: Clone>(tasks: &[Task<'s, W>], done: &HashSet<&str>) -> Vec<Task<'s, W>> {
    let mut known = HashSet::new();
    let lacks =
        |task: &&Task<W>| task.selected && !done.contains(task.id.as_str()) && known.insert(task.id.clone());
    tasks.iter().filter(lacks).cloned().collect()
}

/// Runs `tasks` and gives what becomes of each to `keep` as soon as it has ended, in whatever order they end. Stops at the
/// first error, and when the user asks for it: then `keep` has seen those that had ended, and no part of another.
pub(crate) fn run_all<K: Kind>(
    study: &K,
    tasks: &[Task<K::What<'_>>],
    how: &How,
    keep: impl FnMut(K::Record) -> Result<()> + Send,
) -> Result<()> {
    let (bars, keep) = (Bars::new(tasks.len() as u64), Mutex::new(keep));
    in_parallel(tasks, how.jobs, |task, halt| {
        if let Some(record) = study.run(task, &Conditions { how, bars: &bars, halt })? {
            let _whole = exit::whole();
            keep.lock().unwrap_or_else(PoisonError::into_inner)(record)?;
            bars.run_ended();
        }
        Ok(())
    })
}

/// The records that count, by id: of two, the later.
pub(crate) fn by_id<R: Entry>(records: &[R]) -> HashMap<&str, &R> {
    records.iter().map(|record| (record.id(), record)).collect()
}

/// Estimates the time that the `missing` tasks take, one at a time, from the records of the same method, or else from all;
/// `None` if there are none (s).
pub(crate) fn left_s<W>(missing: &[Task<W>], records: &[impl Entry]) -> Option<f64> {
    let mut of_methods: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    // A run that was skipped took no time.
    for record in records.iter().filter(|record| record.timing().wall_s.is_finite()) {
        of_methods.entry(record.method()).or_default().push(record.timing().wall_s);
    }
    let all = median(of_methods.values().flatten().copied().collect());
    let of_method: BTreeMap<&str, Option<f64>> =
        of_methods.into_iter().map(|(method, seconds)| (method, median(seconds))).collect();
    missing.iter().map(|task| of_method.get(task.variant.method.name).copied().flatten().or(all)).sum()
}
