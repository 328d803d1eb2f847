//! Runs are made: alone for their seconds or several at a time for their counts, once or repeatedly.

use crate::problems::files::Root;
use crate::problems::reference::Known;
use crate::problems::spectrum::of_partition;
use crate::run::curve::Recorder;
use crate::run::rows::{UNTIMED, asked_row, ended_row};
use crate::run::snapshots::Snapshots;
use crate::study::runs::{Study, Task};
use crate::terminal::interrupt;
use crate::terminal::progress::Bars;
use anyhow::{Result, bail};
use contact::SetupError;
use results::journal::Record;
use results::provenance::load_average;
use results::schema::{Provenance, Run, Sample, Snapshot, Timing};
use runner::{Outcome, Status, solve_against};
use serde_json::Value;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

/// How runs are made.
#[derive(Clone, Copy)]
pub(crate) struct How {
    /// How many at a time.
    pub(crate) jobs: NonZeroUsize,
    /// How often each is made for its seconds.
    pub(crate) repeats: u32,
}

/// Reads a number of threads. To start more than a few hundred takes a system seconds, and brings nothing where there are
/// fewer processors.
pub(crate) fn few(text: &str) -> Result<NonZeroUsize, String> {
    let number: NonZeroUsize = text.parse().map_err(|error| format!("{error}"))?;
    let most = std::thread::available_parallelism().map_or(256, |processors| processors.get().max(256));
    if number.get() <= most { Ok(number) } else { Err(format!("it must be at most {most}")) }
}

/// Makes the runs of `tasks` and gives each to `keep` as soon as it has ended, in whatever order they end. Stops at the
/// first error, and when the user asks for it: then `keep` has seen the runs that had ended, and no part of another.
pub(crate) fn execute(
    root: &Root,
    study: &Study,
    tasks: &[Task],
    how: How,
    provenance: &Provenance,
    keep: &(dyn Fn(Record) -> Result<()> + Sync),
) -> Result<()> {
    let bars = Bars::new(tasks.len() as u64);
    in_parallel(tasks, how.jobs, |task, halt| {
        if let Some(record) = make(root, study, task, how, provenance, &bars, halt)? {
            keep(record)?;
            bars.run_ended();
        }
        Ok(())
    })
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
    let halt = || interrupt::asked() || failed.load(Ordering::Relaxed);
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

/// One run, repeated for its seconds; `None` if it was halted. A method that cannot start on the problem is a row too: it
/// says why.
fn make(
    root: &Root,
    study: &Study,
    task: &Task,
    how: How,
    provenance: &Provenance,
    bars: &Bars,
    halt: &dyn Fn() -> bool,
) -> Result<Option<Record>> {
    let known = task.problem.known(root)?;
    let asked = Run {
        spectrum: spectrum(study, task, known),
        ..asked_row(study, task, &provenance.restarted(), untimed(how))
    };
    let skipped = |reason: &str| {
        let run = Run { reason: reason.to_owned(), ..asked.clone() };
        Ok(Some(Record { run, curve: Vec::new(), snapshots: Vec::new() }))
    };
    if task.variant.warm_start && task.problem.frozen.start.is_empty() {
        return skipped("the problem has no impulses of a time step before to begin from");
    }
    let clock = Instant::now();
    let mut made = Vec::new();
    // The first of several brings code and data into the caches.
    let warm_ups = u32::from(how.repeats > 1);
    for repeat in 0..warm_ups + how.repeats {
        match once(study, task, known, bars, halt) {
            Err(reason) => return skipped(&reason.to_string()),
            Ok((outcome, _)) if outcome.status == Status::Interrupted => return Ok(None),
            Ok(ended) if repeat >= warm_ups => made.push(ended),
            Ok(_) => {}
        }
    }
    let Some((outcome, (curve, snapshots), timing)) = median(made, &asked.timing) else {
        bail!("{}: it counts other work when it is repeated; a run must not", task.name());
    };
    let outcome = Outcome { status: known.ending(outcome.status), ..outcome };
    let timing = Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing };
    Ok(Some(Record { run: ended_row(Run { timing, ..asked }, &outcome, &curve), curve, snapshots }))
}

/// What explains how the run ends, where the plan asks for it.
fn spectrum(study: &Study, task: &Task, known: &Known) -> String {
    if !study.selection.plan.spectra {
        return "{}".to_owned();
    }
    let mut spectrum = task.problem.spectrum(known).clone();
    spectrum.extend(of_partition(&task.problem.frozen.problem, task.variant));
    Value::Object(spectrum).to_string()
}

/// The curve of a run, and the iterates that the page shows, if any.
type Kept = (Vec<Sample>, Vec<Snapshot>);

fn once(
    study: &Study,
    task: &Task,
    known: &Known,
    bars: &Bars,
    halt: &dyn Fn() -> bool,
) -> Result<(Outcome, Kept), SetupError> {
    let (frozen, plan) = (&task.problem.frozen, &study.selection.plan);
    let mut recorder = Recorder::new(plan.curves);
    let shown = plan.view.as_ref().is_some_and(|view| view.shows(&task.problem.frozen.name, task.variant));
    let mut snapshots = shown.then(Snapshots::new);
    let mut line = bars.line(task.name());
    let solver = &*task.variant.method.solver;
    let r0 = frozen.start(task.variant.warm_start);
    let outcome = solve_against(known.truth(), solver, &frozen.problem, &r0, &plan.stop, &mut |progress| {
        recorder.observe(progress);
        if let Some(snapshots) = &mut snapshots {
            snapshots.observe(progress);
        }
        line.show(progress, plan.stop.on);
        if halt() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let snapshots = snapshots.map_or_else(Vec::new, |kept| kept.finish(&outcome));
    Ok((outcome, (recorder.finish(), snapshots)))
}

/// Before the run.
pub(crate) fn untimed(how: How) -> Timing {
    Timing { repeats: how.repeats, timed_alone: how.jobs.get() == 1, load_average: load_average(), ..UNTIMED }
}

/// The repeat with the median time in `advance`, with the median time in `start` and the spreads of both. `None` if the
/// repeats do not count the same work.
fn median(mut made: Vec<(Outcome, Kept)>, timing: &Timing) -> Option<(Outcome, Kept, Timing)> {
    let counts = |(outcome, _): &(Outcome, _)| (outcome.status, outcome.iterations, outcome.work);
    if made.windows(2).any(|pair| counts(&pair[0]) != counts(&pair[1])) {
        return None;
    }
    let mut setup: Vec<_> = made.iter().map(|(outcome, _)| outcome.setup).collect();
    setup.sort_unstable();
    made.sort_by_key(|(outcome, _)| outcome.iterating);
    let (last, middle) = (made.len().checked_sub(1)?, (made.len() - 1) / 2);
    let spread = |least: Duration, greatest: Duration| {
        if last == 0 { f64::NAN } else { greatest.abs_diff(least).as_secs_f64() }
    };
    let timing = Timing {
        setup_spread_s: spread(setup[0], setup[last]),
        iterating_spread_s: spread(made[0].0.iterating, made[last].0.iterating),
        ..timing.clone()
    };
    let (outcome, kept) = made.swap_remove(middle);
    Some((Outcome { setup: setup[middle], ..outcome }, kept, timing))
}
