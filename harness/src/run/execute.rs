//! Work in threads: that of methods, and several tasks at a time.

use crate::plan::Variant;
use crate::root::Root;
use crate::terminal::{Bars, exit};
use anyhow::Result;
use results::provenance::load_average;
use results::schema::{Provenance, Timing};
use runner::Measured;
use std::num::NonZeroUsize;
use std::path::Path;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::ScopedJoinHandle;

/// One thing that a study asks for.
#[derive(Clone)]
pub(crate) struct Task<'s, W> {
    /// Hash of all that decides its counts.
    pub(crate) id: String,
    pub(crate) variant: &'s Variant,
    /// True where the selection has it.
    pub(crate) selected: bool,
    /// Problem that the variant is run on, or simulation.
    pub(crate) what: W,
}

/// Settings by which tasks are run.
pub(crate) struct How<'a> {
    pub(crate) root: &'a Root,
    /// The folder of the study, where there is one.
    pub(crate) folder: Option<&'a Path>,
    pub(crate) provenance: &'a Provenance,
    /// Number of repeats of each, for its seconds.
    pub(crate) repeats: u32,
    /// Number of tasks at a time.
    pub(crate) jobs: NonZeroUsize,
    /// Iterates of each that are measured.
    pub(crate) measured: Measured,
}

/// Conditions of a task while it runs.
pub(crate) struct Conditions<'a> {
    pub(crate) how: &'a How<'a>,
    pub(crate) bars: &'a Bars,
    /// Test for a request to end at once.
    pub(crate) halt: &'a dyn Fn() -> bool,
}

impl How<'_> {
    /// Returns the timing of a run before it starts.
    pub(crate) fn timing(&self) -> Timing {
        let timed_alone = self.jobs.get() == 1;
        Timing { repeats: self.repeats, timed_alone, load_average: load_average(), ..Timing::default() }
    }
}

/// Reads a whole number from 1.
pub(crate) fn from_one<N: FromStr>(text: &str) -> Result<N, String> {
    text.parse().map_err(|_| "it is a whole number from 1".to_owned())
}

/// Reads a number of threads. To start more than a few hundred takes a system seconds, and brings nothing where there are
/// fewer processors.
pub(crate) fn few(text: &str) -> Result<NonZeroUsize, String> {
    let number: NonZeroUsize = from_one(text)?;
    let most = std::thread::available_parallelism().map_or(256, |processors| processors.get().max(256));
    if number.get() <= most { Ok(number) } else { Err(format!("it must be at most {most}")) }
}

/// Does `work` in one of the threads that methods use: a method called from elsewhere sleeps while these work, and every
/// one of its iterations wakes all of them.
pub(crate) fn in_the_pool<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::scope(|_| work())
}

/// Does the `work` of every task, `jobs` at a time, until the first error or until the user asks for an end; the work
/// learns of both by its second argument.
pub(crate) fn in_parallel<T: Sync>(
    tasks: &[T],
    jobs: NonZeroUsize,
    work: impl Fn(&T, &dyn Fn() -> bool) -> Result<()> + Sync,
) -> Result<()> {
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let halt = || exit::requested() || failed.load(Ordering::Relaxed);
    let do_the_next = || -> Result<()> {
        while !halt()
            && let Some(task) = tasks.get(next.fetch_add(1, Ordering::Relaxed))
        {
            work(task, &halt)?;
        }
        Ok(())
    };
    let work = || do_the_next().inspect_err(|_| failed.store(true, Ordering::Relaxed));
    let workers = jobs.get().min(tasks.len());
    if workers < 2 {
        return in_the_pool(work);
    }
    let ended: Vec<Result<()>> = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let joined = handles.into_iter().map(ScopedJoinHandle::join);
        joined.map(|ended| ended.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    ended.into_iter().collect()
}
