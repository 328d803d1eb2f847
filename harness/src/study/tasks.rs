//! A study is a list of tasks, each with its id; what runs them, and what becomes of them, does not ask of which kind they
//! are: runs on problems, or simulations.

use crate::plan::variants::Variant;
use crate::problems::files::Root;
use crate::run::execute::{Conditions, in_parallel};
use crate::study::problems::OnProblems;
use crate::study::selection::Selection;
use crate::study::simulations::ThroughTime;
use crate::terminal::progress::Bars;
use anyhow::Result;
use results::journal::Entry;
use results::schema::Provenance;
use results::study::Study as Rows;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::num::NonZeroUsize;
use std::path::Path;

/// A kind of study.
pub(crate) trait Kind: Sized + Sync {
    /// What is stored of a task that has ended.
    type Record: Entry + Clone + Send + Sync;
    /// What a task is.
    type What<'s>: Clone + Sync
    where
        Self: 's;
    /// What the tasks are called.
    const TASKS: &'static str;

    /// The study of a selection; problems that are needed and not there are made first, if `make` says so.
    fn new(selection: Selection, root: &Root, make: bool) -> Result<Self>;

    /// What was selected of the plan.
    fn selection(&self) -> &Selection;

    /// How often a task is run for its seconds, where `wanted` replaces what the plan says.
    fn repeats(&self, wanted: Option<u32>) -> Result<u32>;

    /// Every task, in the order of the plan.
    fn tasks(&self) -> Result<Vec<Task<'_, Self>>>;

    /// Runs a task; `None` if it was halted.
    fn run(&self, task: &Task<Self>, conditions: &Conditions) -> Result<Option<Self::Record>>;

    /// How many tasks the whole plan has.
    fn size(&self) -> Result<usize>;

    /// What the plan asks for, in words.
    fn asks(&self) -> Result<String>;

    /// The tasks as they are listed, where those whose ids are in `done` have ended.
    fn listed(&self, done: &HashSet<&str>) -> Result<Vec<Listed>>;

    /// The rows of what has ended, under the names that the plan gives them now.
    fn rows(
        &self,
        root: &Root,
        ended: Vec<(Task<Self>, Self::Record)>,
        provenance: &Provenance,
    ) -> Result<Rows>;
}

/// One thing that a study asks for.
pub(crate) struct Task<'s, K: Kind + 's> {
    /// Hash of all that decides its counts.
    pub(crate) id: String,
    pub(crate) variant: &'s Variant,
    /// Whether the selection has it.
    pub(crate) selected: bool,
    pub(crate) what: K::What<'s>,
}

/// A task as it is listed.
pub(crate) struct Listed {
    pub(crate) problem: String,
    pub(crate) method: String,
    pub(crate) variant: String,
    pub(crate) done: bool,
}

/// The selected tasks whose id is not in `done`, each once.
pub(crate) fn missing<'s, K: Kind>(tasks: &[Task<'s, K>], done: &HashSet<&str>) -> Vec<Task<'s, K>> {
    let mut known = HashSet::new();
    let lacks =
        |task: &&Task<K>| task.selected && !done.contains(task.id.as_str()) && known.insert(task.id.clone());
    tasks.iter().filter(lacks).cloned().collect()
}

impl<K: Kind> Clone for Task<'_, K> {
    fn clone(&self) -> Self {
        Self { id: self.id.clone(), what: self.what.clone(), ..*self }
    }
}

/// How tasks are run.
pub(crate) struct How<'a> {
    pub(crate) root: &'a Root,
    /// The folder of the study, where there is one.
    pub(crate) folder: Option<&'a Path>,
    pub(crate) provenance: &'a Provenance,
    /// How often each for its seconds.
    pub(crate) repeats: u32,
    /// How many at a time.
    pub(crate) jobs: NonZeroUsize,
}

/// Runs `tasks` and gives what becomes of each to `keep` as soon as it has ended, in whatever order they end. Stops at the
/// first error, and when the user asks for it: then `keep` has seen those that had ended, and no part of another.
pub(crate) fn run_all<K: Kind>(
    study: &K,
    tasks: &[Task<K>],
    how: &How,
    keep: &(dyn Fn(K::Record) -> Result<()> + Sync),
) -> Result<()> {
    let bars = Bars::new(tasks.len() as u64);
    let How { root, folder, provenance, repeats, jobs } = *how;
    in_parallel(tasks, jobs, |task, halt| {
        let alone = jobs.get() == 1;
        let conditions = Conditions { root, folder, provenance, repeats, alone, bars: &bars, halt };
        if let Some(record) = study.run(task, &conditions)? {
            keep(record)?;
            bars.run_ended();
        }
        Ok(())
    })
}

/// What is done with a study, of whichever kind.
pub(crate) trait ForKind {
    type Output;

    /// Does it.
    fn of<K: Kind>(self, selection: Selection) -> Result<Self::Output>;
}

/// Does it with the kind of study that the plan is.
pub(crate) fn of_kind<C: ForKind>(selection: Selection, command: C) -> Result<C::Output> {
    match selection.plan.simulate {
        None => command.of::<OnProblems>(selection),
        Some(_) => command.of::<ThroughTime>(selection),
    }
}

/// The records that count, by id: of two, the later.
pub(crate) fn by_id<R: Entry>(records: &[R]) -> HashMap<&str, &R> {
    records.iter().map(|record| (record.id(), record)).collect()
}

/// How long the `missing` tasks take, one at a time, judged by the records of the same method, or else by all; `None` if
/// there are none (s).
pub(crate) fn left_s<K: Kind>(missing: &[Task<K>], records: &[K::Record]) -> Option<f64> {
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

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
