//! From the records of a store to the tables of a study as its plan is now, and what is to be said of them.

use crate::methods::Method;
use crate::rows::{partitions, scene_rows};
use crate::study::{Study, by_id};
use anyhow::Result;
use cases::Frozen;
use contact::{Status, Stop};
use results::journal::Record;
use results::schema::{Run, Sample};
use results::store::Tables;
use results::tables::{contacts_table, curves_table, grains_table, runs_table};
use std::collections::{HashMap, HashSet};

/// The runs that the plan asks for and the store has, in the plan's order, under the names that the plan gives them now;
/// and the problems as they are drawn.
pub(crate) fn tables(study: &Study, records: &[Record]) -> Result<Tables> {
    let known = by_id(records);
    let mut runs = Vec::new();
    let mut curves: Vec<(u32, &[Sample])> = Vec::new();
    for task in study.tasks() {
        if let Some(record) = known.get(task.id.as_str()) {
            let run = runs.len() as u32;
            runs.push(Run {
                run,
                plan: study.plan.name.clone(),
                problem: task.problem.frozen.name.clone(),
                problem_settings: task.problem.settings.clone(),
                variant: task.variant.name.clone(),
                ..record.run.clone()
            });
            curves.push((run, &record.curve));
        }
    }
    let (mut grains, mut contacts) = (Vec::new(), Vec::new());
    let partitions = partitions(&study.variants);
    // Without a partition there is nothing to draw.
    for problem in study.problems.iter().filter(|_| !partitions.is_empty()) {
        let impulses = impulses(&problem.frozen)?;
        for (name, grid, scheme) in &partitions {
            // Runs with a partition that does not fit the problem were skipped.
            if let Ok(partition) = scheme.partition(&problem.frozen.problem, *grid) {
                let (g, c) = scene_rows(&problem.frozen, name, &partition, impulses.as_deref());
                grains.extend(g);
                contacts.extend(c);
            }
        }
    }
    Ok(Tables {
        runs: runs_table(&runs)?,
        curves: curves_table(&curves)?,
        grains: grains_table(&grains)?,
        contacts: contacts_table(&contacts)?,
    })
}

/// Impulses to draw (N·s): the same whatever methods a study compares, and whether they converge; `None` if the method
/// for it does not.
fn impulses(frozen: &Frozen) -> Result<Option<Vec<f64>>> {
    let cg = Method::parse("cg", &[("preconditioner".to_owned(), "diagonal".to_owned())])?;
    let r0 = frozen.start(false);
    let outcome = contact::solve(&*cg.solver, &frozen.problem, &r0, &Stop::default(), &mut |_| {})?;
    Ok((outcome.status == Status::Converged).then_some(outcome.impulses))
}

/// What a reader of the tables must know of where their rows come from: one sentence each.
pub(crate) fn notes(study: &Study, records: &[Record]) -> Vec<String> {
    let known = by_id(records);
    let asked: HashSet<String> = study.tasks().into_iter().map(|task| task.id).collect();
    let runs: Vec<&Run> = asked.iter().filter_map(|id| known.get(id.as_str())).map(|r| &r.run).collect();
    let mut notes = Vec::new();
    let mut origins: Vec<&Run> = Vec::new();
    for run in &runs {
        if !origins.iter().any(|other| other.provenance.comparable(&run.provenance)) {
            origins.push(run);
        }
    }
    if origins.len() > 1 {
        notes.push(format!(
            "The rows come from {} builds, machines or numbers of threads: their counts compare, their seconds do not. \
             --rerun times all again.",
            origins.len()
        ));
    }
    let timed = || runs.iter().filter(|run| run.status != "skipped");
    let together = timed().filter(|run| !run.timing.timed_alone).count();
    if together > 0 {
        notes.push(format!(
            "Runs made beside others: {together}; their seconds are not those of a run alone."
        ));
    }
    let once = timed().filter(|run| run.timing.repeats < study.plan.repeats.get()).count();
    if once > 0 {
        notes.push(format!("Runs repeated less often than the plan asks: {once}."));
    }
    let others = known.keys().filter(|id| !asked.contains(**id)).count();
    if others > 0 {
        notes.push(format!(
            "Runs of earlier code, or that the plan no longer asks for: {others}; they are in the journal, and in no table."
        ));
    }
    let differ = unlike_twins(records);
    if !differ.is_empty() {
        notes.push(format!(
            "WARNING: these runs were made again, and counted other work: {}. The same id must mean the same counts.",
            differ.join(", ")
        ));
    }
    notes
}

/// Runs of one id that did not count the same: method, problem and id of each.
fn unlike_twins(records: &[Record]) -> Vec<String> {
    let mut first: HashMap<&str, &Run> = HashMap::new();
    let mut differ = Vec::new();
    for Record { run, .. } in records {
        let twin = first.entry(&run.id).or_insert(run);
        if !twin.same_counts(run) {
            differ.push(format!("{} on {} ({})", run.method, run.problem, run.id));
        }
    }
    differ
}
