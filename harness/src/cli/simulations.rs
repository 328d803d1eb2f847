//! Studies through time: the simulations that a store lacks are made, then tables and a report.

use crate::cli::bench::Args;
use crate::cli::plan::Row;
use crate::plan::methods::names;
use crate::problems::files::Root;
use crate::run::execute::{How, in_parallel, untimed};
use crate::run::simulation;
use crate::store::folder::{about, begin_anew, open, provenance, runs_folder, say_files, stopped};
use crate::store::tables::origins;
use crate::study::runs::left_s;
use crate::study::selection::Selection;
use crate::study::simulations::{Study, Task, by_id, missing};
use crate::terminal::exit;
use crate::terminal::interrupt;
use crate::terminal::output::say;
use crate::terminal::progress::Bars;
use anyhow::{Result, bail};
use reports::{Formats, Wanted, made};
use results::simulation::{Simulated, Simulation, SimulationTables};
use results::store::{Store, records_of};
use std::collections::HashSet;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

/// `gravel bench` of a plan with `[simulate]`.
pub(crate) fn bench(root: &Root, args: &Args, selection: Selection) -> Result<ExitCode> {
    if args.repeats.is_some_and(|repeats| repeats.get() > 1) {
        bail!("--repeats: a simulation is made once; its seconds are those of many time steps");
    }
    let provenance = provenance()?;
    begin_anew(root, args.fresh, &selection.plan.name)?;
    // A place that cannot be written to is known before a scene is made.
    let store: Store<Simulated> = open(root, &selection.plan.name)?;
    let study = Study::new(selection)?;
    let all = study.tasks()?;
    let tasks = if args.rerun { lacking(&study, &all, &[]) } else { lacking(&study, &all, store.records()) };
    interrupt::listen()?;
    say_what_is_to_make(&study, &all, &tasks, store.records())?;
    let how = How { jobs: args.jobs, repeats: 1 };
    let folder = store.folder().to_owned();
    let store = Mutex::new(store);
    let bars = Bars::new(tasks.len() as u64);
    let ended = in_parallel(&tasks, how.jobs, |task, halt| {
        let (plan, timing) = (&study.selection.plan.name, untimed(how));
        if let Some(simulated) = simulation::make(task, plan, timing, &provenance, &bars, halt, &folder)? {
            store.lock().unwrap_or_else(PoisonError::into_inner).append(simulated)?;
            bars.run_ended();
        }
        Ok(())
    });
    drop(bars);
    stopped(ended, &study.selection.again)?;
    finish(root, &study, store.into_inner().unwrap_or_else(PoisonError::into_inner))
}

fn say_what_is_to_make(study: &Study, all: &[Task], tasks: &[Task], records: &[Simulated]) -> Result<()> {
    let left = left(tasks, records).filter(|s| *s >= 1.0);
    let left = left.map_or(String::new(), |s| format!(", about {s:.0} s"));
    let runs = all.iter().filter(|task| task.role == "run").count();
    say(format_args!(
        "plan {}: {runs} simulations, and {} to compare them with; {} of {} to make{left}",
        study.selection.plan.name,
        all.len() - runs,
        tasks.len(),
        missing(all, &HashSet::new()).len()
    ))?;
    for note in &study.selection.notes {
        say(format_args!("  {note}"))?;
    }
    Ok(())
}

/// The simulations to be made that the records lack, each once.
fn lacking<'s>(study: &Study, tasks: &[Task<'s>], records: &[Simulated]) -> Vec<Task<'s>> {
    let done: HashSet<&str> = records.iter().map(|record| record.simulation.id.as_str()).collect();
    let mut missing = missing(tasks, &done);
    missing.retain(|task| study.selects(task));
    missing
}

/// The simulations to be made, for `gravel plan`, and how long the missing ones may take (s).
pub(crate) fn rows(root: &Root, selection: Selection) -> Result<(Vec<Row>, Option<f64>)> {
    let records: Vec<Simulated> = records_of(&runs_folder(root).join(&selection.plan.name), &names())?;
    let study = Study::new(selection)?;
    let mut tasks = study.tasks()?;
    tasks.retain(|task| study.selects(task));
    let left_s = left(&lacking(&study, &tasks, &records), &records);
    let done = by_id(&records);
    let row = |task: &Task| Row {
        problem: task.scene.name.clone(),
        method: task.variant.method.name.to_owned(),
        variant: format!("{} {}", task.variant.name, task.rule()),
        done: done.contains_key(task.id.as_str()),
    };
    Ok((tasks.iter().map(row).collect(), left_s))
}

fn left(missing: &[Task], records: &[Simulated]) -> Option<f64> {
    let seconds = records.iter().map(|record| (&*record.simulation.method, record.simulation.timing.wall_s));
    left_s(seconds, missing.iter().map(|task| task.variant.method.name))
}

/// `gravel merge` of a plan with `[simulate]`.
pub(crate) fn merged(root: &Root, selection: Selection, store: Store<Simulated>) -> Result<ExitCode> {
    finish(root, &Study::new(selection)?, store)
}

/// Makes the tables of a study from its store, and its report if the user did not stop it.
fn finish(root: &Root, study: &Study, mut store: Store<Simulated>) -> Result<ExitCode> {
    let tasks = study.tasks()?;
    let simulated = asked_for(study, &tasks, store.records());
    let tables = SimulationTables::new(&simulated)?;
    store.write_tables(&tables)?;
    if interrupt::asked() {
        let missing = lacking(study, &tasks, store.records()).len();
        say(format_args!(
            "stopped; simulations missing: {missing}, the others are kept; `gravel bench {}` goes on",
            study.selection.again
        ))?;
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    say(format_args!("{}", reports::simulations_text(&tables)?))?;
    if let Some(note) = origins(simulated.iter().map(|s| &s.simulation.provenance)) {
        say(format_args!("{note}"))?;
    }
    if let Some(note) = unlike_twins(store.records()) {
        say(format_args!("{note}"))?;
    }
    let Selection { plan, again, .. } = &study.selection;
    let out = root.join("reports/out").join(&plan.name);
    let before = made(&out);
    let formats = Formats::default().and_those_of(&before);
    let wanted = Wanted { charts: &plan.charts(), formats, against: None };
    let files = reports::report(&tables, &about(plan, again), wanted, &out)?;
    say_files(store.folder(), &out, &files, &before)?;
    Ok(ExitCode::SUCCESS)
}

/// The simulations that the plan asks for and the store has, in the plan's order, under the names that the plan gives them
/// now.
fn asked_for(study: &Study, tasks: &[Task], records: &[Simulated]) -> Vec<Simulated> {
    let known = by_id(records);
    let row = |task: &Task| {
        let known = known.get(task.id.as_str())?;
        let simulation = Simulation {
            plan: study.selection.plan.name.clone(),
            scene: task.scene.name.clone(),
            variant: task.variant.name.clone(),
            role: task.role.to_owned(),
            ..known.simulation.clone()
        };
        Some(Simulated { simulation, series: known.series.clone() })
    };
    tasks.iter().filter_map(row).collect()
}

/// Says which simulations were made again and showed something else.
fn unlike_twins(records: &[Simulated]) -> Option<String> {
    let latest = by_id(records);
    let differs = |record: &&Simulated| {
        let series = &latest[record.simulation.id.as_str()].series;
        // NaN is what it is, here.
        format!("{:?}", record.series) != format!("{series:?}")
    };
    let ids: Vec<&str> = records.iter().filter(differs).map(|record| record.simulation.id.as_str()).collect();
    (!ids.is_empty()).then(|| {
        format!(
            "WARNING: these simulations were made again, and showed something else: {}. The same id must mean the same \
             series.",
            ids.join(", ")
        )
    })
}
