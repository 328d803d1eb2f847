//! A run on a problem: repeated for its seconds, kept as a row with its curve.

use crate::plan::file::Plan;
use crate::problems::planned::Problem;
use crate::problems::reference::Known;
use crate::problems::spectrum::of_partition;
use crate::run::curve::Recorder;
use crate::run::execute::{Conditions, Task};
use crate::run::rows::{ended_row, nothing_done};
use crate::run::snapshots::Snapshots;
use anyhow::{Result, bail};
use contact::SetupError;
use results::journal::Record;
use results::schema::{Run, Sample, Snapshot, Timing};
use runner::{Outcome, Status, solve_against};
use serde_json::{Map, Value};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// One run, as often as `timing` says; `None` if it was halted. A method that cannot start on the problem is a row too: it
/// says why.
pub(crate) fn run(plan: &Plan, task: &Task<&Problem>, conditions: &Conditions) -> Result<Option<Record>> {
    let Task { id, variant, what: problem, .. } = task;
    let known = problem.known(conditions.how.root)?;
    let timing = conditions.how.timing();
    // A skipped run, if it is not run.
    let row = Run {
        id: id.clone(),
        method: variant.method.name.to_owned(),
        settings: variant.method.settings.clone(),
        variant: variant.name.clone(),
        // A grid may have more subdomains than the column counts; every method refuses it, and its row stays.
        subdomains: variant
            .partition()
            .map_or(1, |(grid, _)| u32::try_from(grid.count()).unwrap_or(u32::MAX)),
        warm_start: variant.warm_start,
        status: "skipped".to_owned(),
        spectrum: spectrum(plan, task, known),
        timing: timing.clone(),
        ..nothing_done(plan, problem, conditions.how.provenance.restarted())
    };
    let skipped = |reason: &str| {
        let run = Run { reason: reason.to_owned(), ..row.clone() };
        Ok(Some(Record { run, curve: Vec::new(), snapshots: Vec::new() }))
    };
    if variant.warm_start && problem.frozen.start.is_empty() {
        return skipped("the problem has no impulses of a time step before to begin from");
    }
    let clock = Instant::now();
    let mut ended = Vec::new();
    // The first of several brings code and data into the caches.
    let warm_ups = u32::from(timing.repeats > 1);
    for repeat in 0..warm_ups + timing.repeats {
        match once(plan, task, known, conditions) {
            Err(reason) => return skipped(&reason.to_string()),
            Ok((outcome, _)) if outcome.status == Status::Interrupted => return Ok(None),
            Ok(one) if repeat >= warm_ups => ended.push(one),
            Ok(_) => {}
        }
    }
    let Some((outcome, (curve, snapshots), timing)) = median(ended, timing) else {
        bail!("{}: it counts other work when it is repeated; a run must not", name(task));
    };
    let outcome = Outcome { status: known.ending(outcome.status), ..outcome };
    let timing = Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing };
    Ok(Some(Record { run: ended_row(Run { timing, ..row }, &outcome, &curve), curve, snapshots }))
}

/// The run, as a user reads it.
fn name(task: &Task<&Problem>) -> String {
    format!("{} on {}", task.variant.label(), task.what.frozen.name)
}

/// What explains how the run ends, where the plan asks for it.
fn spectrum(plan: &Plan, task: &Task<&Problem>, known: &Known) -> Map<String, Value> {
    if !plan.spectra {
        return Map::new();
    }
    let mut spectrum = task.what.spectrum(known).clone();
    spectrum.extend(of_partition(&task.what.frozen.problem, task.variant));
    spectrum
}

/// The curve of a run, and the iterates that the page shows, if any.
type Kept = (Vec<Sample>, Vec<Snapshot>);

fn once(
    plan: &Plan,
    task: &Task<&Problem>,
    known: &Known,
    conditions: &Conditions,
) -> Result<(Outcome, Kept), SetupError> {
    let (frozen, variant) = (&task.what.frozen, task.variant);
    let mut recorder = Recorder::new(plan.curves);
    let shown = plan.view.as_ref().is_some_and(|view| view.shows(&frozen.name, variant));
    let mut snapshots = shown.then(Snapshots::new);
    let mut line = conditions.bars.line(name(task));
    let solver = &*variant.method.solver;
    let r0 = frozen.start(variant.warm_start);
    let outcome = solve_against(known.truth(), solver, &frozen.problem, &r0, &plan.stop, &mut |progress| {
        recorder.observe(progress);
        if let Some(snapshots) = &mut snapshots {
            snapshots.observe(progress);
        }
        line.show(progress, plan.stop.on);
        if (conditions.halt)() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let snapshots = snapshots.map_or_else(Vec::new, |kept| kept.finish(&outcome));
    Ok((outcome, (recorder.finish(), snapshots)))
}

/// The repeat with the median time in `advance`, with the median time in `start` and the spreads of both. `None` if the
/// repeats do not count the same work.
fn median(mut ended: Vec<(Outcome, Kept)>, timing: Timing) -> Option<(Outcome, Kept, Timing)> {
    let counts = |(outcome, _): &(Outcome, _)| (outcome.status, outcome.iterations, outcome.work);
    if ended.windows(2).any(|pair| counts(&pair[0]) != counts(&pair[1])) {
        return None;
    }
    let mut setup: Vec<_> = ended.iter().map(|(outcome, _)| outcome.setup).collect();
    setup.sort_unstable();
    ended.sort_by_key(|(outcome, _)| outcome.iterating);
    let (last, middle) = (ended.len().checked_sub(1)?, (ended.len() - 1) / 2);
    let spread = |least: Duration, greatest: Duration| {
        if last == 0 { f64::NAN } else { greatest.abs_diff(least).as_secs_f64() }
    };
    let timing = Timing {
        setup_spread_s: spread(setup[0], setup[last]),
        iterating_spread_s: spread(ended[0].0.iterating, ended[last].0.iterating),
        ..timing
    };
    let (outcome, kept) = ended.swap_remove(middle);
    Some((Outcome { setup: setup[middle], ..outcome }, kept, timing))
}
