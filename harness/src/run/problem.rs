//! A run on a problem: repeated for its seconds, kept as a row with its curve.

use crate::plan::Plan;
use crate::plan::Runs;
use crate::problems::{Known, Problem};
use crate::run::{Conditions, Ended, Recorder, Task, ended, ended_row, nothing_done};
use analysis::coupling;
use anyhow::{Context, Result, bail};
use contact::Work;
use partition::{Decomposition, Partition};
use results::journal::Record;
use results::schema::{Run, Sample, Snapshot, Timing};
use runner::{Outcome, Progress, Status};
use serde_json::{Map, Value, json};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// One run, as often as `timing` says; `None` if it was halted. A method that cannot start on the problem is a row too: it
/// says why.
pub(crate) fn run_on_problem(
    plan: &Plan,
    task: &Task<&Problem>,
    conditions: &Conditions,
) -> Result<Option<Record>> {
    let Task { id, variant, what: problem, .. } = task;
    let known = problem.known(conditions.how.root)?;
    let timing = conditions.how.timing();
    let mut provenance = conditions.how.provenance.restarted();
    if let Runs::Elsewhere(programme) = &variant.method.runs {
        programme.code.version().unwrap_or_default().clone_into(&mut provenance.other_code);
    }
    // A skipped run, if it is not run.
    let row = Run {
        id: id.clone(),
        method: variant.method.name.to_owned(),
        settings: variant.method.settings.clone(),
        variant: variant.name.clone(),
        // A grid may have more subdomains than the column counts; every method refuses it, and its row stays.
        subdomains: variant
            .method
            .partition()
            .map_or(1, |(grid, _)| u32::try_from(grid.count()).unwrap_or(u32::MAX)),
        warm_start: variant.warm_start,
        status: "skipped".to_owned(),
        spectrum: spectrum(plan, task, known),
        timing: timing.clone(),
        ..nothing_done(plan, problem, provenance)
    };
    let skipped = |reason: &str| {
        let run = Run { reason: reason.to_owned(), ..row.clone() };
        Ok(Some(Record { run, curve: Vec::new(), snapshots: Vec::new() }))
    };
    if variant.warm_start && problem.frozen.start.is_empty() {
        return skipped("the problem has no impulses of a time step before to begin from");
    }
    let clock = Instant::now();
    let mut all = Vec::new();
    // The first of several brings code and data into the caches.
    let warm_ups = u32::from(timing.repeats > 1);
    for repeat in 0..warm_ups + timing.repeats {
        match once(plan, task, known, conditions) {
            Err(reason) => return skipped(&format!("{reason:#}")),
            Ok((ended, _)) if ended.outcome.status == Status::Interrupted => return Ok(None),
            // Another code that gave no answer would give none again.
            Ok(one) if repeat >= warm_ups || one.0.failed.is_some() => {
                all.push(one);
                if all.iter().any(|(ended, _)| ended.failed.is_some()) {
                    break;
                }
            }
            Ok(_) => {}
        }
    }
    let ours = matches!(variant.method.runs, Runs::Here(_));
    // Another code need not count the same twice.
    if ours && all.windows(2).any(|pair| counts(&pair[0].0) != counts(&pair[1].0)) {
        bail!("{}: it counts other work when it is repeated; a run must not", name(task));
    }
    let (ended, (curve, snapshots), timing) = median(all, &timing).context("a run is made at least once")?;
    let outcome = Outcome { status: known.ending(ended.outcome.status), ..ended.outcome };
    let timing = Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing };
    let mut run = ended_row(Run { timing, ..row }, &outcome, &curve);
    if !ours {
        run.derived.insert("rungs".to_owned(), serde_json::to_value(&ended.rungs)?);
    }
    if let Some(why) = ended.failed {
        (run.status, run.reason) = ("failed".to_owned(), why);
    }
    Ok(Some(Record { run, curve, snapshots }))
}

/// What is the same in every repeat.
fn counts(Ended { outcome, .. }: &Ended) -> (Status, u64, Work) {
    (outcome.status, outcome.iterations, outcome.work)
}

/// The run, as a user reads it.
fn name(task: &Task<&Problem>) -> String {
    format!("{} on {}", task.variant.label(), task.what.frozen.name)
}

/// What explains how the run ends, where the plan asks for it: the spectrum of the problem; of a partition the most copies of a
/// grain and, where masses are whole, how strongly subdomains act on each other.
fn spectrum(plan: &Plan, task: &Task<&Problem>, known: &Known) -> Map<String, Value> {
    if !plan.spectra {
        return Map::new();
    }
    let (problem, variant) = (&task.what.frozen.problem, task.variant);
    let mut columns = task.what.spectrum(known).clone();
    // A run with a partition that does not fit the problem is skipped, and says why.
    if let Some((grid, scheme)) = variant.method.partition()
        && let Ok(partition) = Partition::of_contacts(problem, scheme, grid)
    {
        let multiplicity = Decomposition::new(problem, &partition).multiplicity.iter().copied().max();
        columns.insert("multiplicity".to_owned(), json!(multiplicity));
        if variant.method.setting::<bool>("mass_splitting") == Some(false)
            && let Some(coupling) = coupling(problem, &partition.subdomain)
        {
            columns.insert("coupling".to_owned(), json!(coupling));
        }
    }
    columns
}

/// The curve of a run, and the iterates that the page shows, if any.
type Kept = (Vec<Sample>, Vec<Snapshot>);

fn once(plan: &Plan, task: &Task<&Problem>, known: &Known, conditions: &Conditions) -> Result<(Ended, Kept)> {
    let (frozen, variant) = (&task.what.frozen, task.variant);
    let mut recorder = Recorder::new(plan.curves);
    let shown = plan.view.as_ref().is_some_and(|view| view.shows(&frozen.name, variant));
    let mut snapshots = shown.then(Snapshots::new);
    let mut line = conditions.bars.line(name(task));
    let r0 = frozen.start(variant.warm_start);
    let (truth, measured) = (known.truth(), conditions.how.measured);
    let ended = ended(&variant.method, truth, frozen, &r0, &plan.stop, measured, &mut |progress| {
        recorder.observe(progress);
        if let Some(snapshots) = &mut snapshots {
            snapshots.observe(progress);
        }
        line.show(progress, plan.stop.on);
        if (conditions.halt)() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let snapshots = snapshots.map_or_else(Vec::new, |kept| kept.finish(&ended.outcome));
    let curve = if ended.samples.is_empty() { recorder.finish() } else { ended.samples.clone() };
    Ok((ended, (curve, snapshots)))
}

/// The repeat with the median time in `advance`, with the median time in `start` and the spreads of both; `None` of none.
fn median(mut all: Vec<(Ended, Kept)>, timing: &Timing) -> Option<(Ended, Kept, Timing)> {
    let mut setup: Vec<_> = all.iter().map(|(ended, _)| ended.outcome.setup).collect();
    setup.sort_unstable();
    all.sort_by_key(|(ended, _)| ended.outcome.iterating);
    let (last, middle) = (all.len().checked_sub(1)?, (all.len() - 1) / 2);
    let spread = |least: Duration, greatest: Duration| {
        if last == 0 { f64::NAN } else { greatest.abs_diff(least).as_secs_f64() }
    };
    let iterating = |k: usize| all[k].0.outcome.iterating;
    let timing = Timing {
        setup_spread_s: spread(setup[0], setup[last]),
        iterating_spread_s: spread(iterating(0), iterating(last)),
        ..timing.clone()
    };
    let (mut ended, kept) = all.swap_remove(middle);
    ended.outcome.setup = setup[middle];
    Some((ended, kept, timing))
}

/// Keeps the beginning of a run, iterations in a ratio of about 1.4, and its end: some thirty iterates of a hundred thousand.
pub(crate) struct Snapshots {
    snapshots: Vec<Snapshot>,
    /// The next iteration to be kept.
    next: u64,
}

impl Snapshots {
    pub(crate) fn new() -> Self {
        Self { snapshots: Vec::new(), next: 0 }
    }

    /// Sees every iterate.
    pub(crate) fn observe(&mut self, progress: &Progress) {
        if let Some(measures) = progress.measures
            && progress.iteration >= self.next
        {
            self.snapshots.push(kept(progress.iteration, measures.natural_map, progress.impulses));
            self.next = progress.iteration + (2 * progress.iteration).div_ceil(5).max(1);
        }
    }

    /// The iterates; the last one is that of the outcome.
    pub(crate) fn finish(mut self, outcome: &Outcome) -> Vec<Snapshot> {
        if self.snapshots.last().is_none_or(|last| last.iteration != outcome.iterations) {
            self.snapshots.push(kept(outcome.iterations, outcome.measures.natural_map, &outcome.impulses));
        }
        self.snapshots
    }
}

fn kept(iteration: u64, natural_map: f64, impulses: &[f64]) -> Snapshot {
    Snapshot { iteration, natural_map, impulses_n_s: impulses.iter().copied().map(rounded).collect() }
}

/// To three significant digits: it is for the eye.
fn rounded(r: f64) -> f64 {
    format!("{r:.2e}").parse().ok().filter(|rounded: &f64| rounded.is_finite()).unwrap_or(f64::NAN)
}
