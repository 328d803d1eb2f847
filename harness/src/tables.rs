//! From the records of a store to the tables of a study as its plan is now, and what is to be said of them.

use crate::inputs::Root;
use crate::rows::{given_row, partitions, scene_rows};
use crate::study::{Study, by_id};
use anyhow::Result;
use partition::Partition;
use results::journal::Record;
use results::schema::{Provenance, Run, Sample, Snapshot};
use results::store::Tables;
use results::tables::{contacts_table, curves_table, grains_table, runs_table, snapshots_table};
use std::collections::{HashMap, HashSet};

/// The runs that the plan asks for and the store has, in the plan's order, under the names that the plan gives them now;
/// and the problems as they are drawn.
pub(crate) fn tables(
    root: &Root,
    study: &Study,
    records: &[Record],
    provenance: &Provenance,
) -> Result<Tables> {
    let known = by_id(records);
    let plan = &study.asked.plan;
    let mut runs = Vec::new();
    let mut curves: Vec<(u32, &[Sample])> = Vec::new();
    let mut snapshots: Vec<(u32, &Vec<Snapshot>)> = Vec::new();
    for task in study.tasks() {
        if let Some(record) = known.get(task.id.as_str()) {
            let run = runs.len() as u32;
            runs.push(Run {
                run,
                plan: plan.name.clone(),
                problem: task.problem.frozen.name.clone(),
                problem_settings: task.problem.settings.clone(),
                variant: task.variant.name.clone(),
                ..record.run.clone()
            });
            curves.push((run, &record.curve));
            snapshots.push((run, &record.snapshots));
        }
    }
    for problem in &study.problems {
        if let Some(given) = &problem.given {
            let run = runs.len() as u32;
            let row = given_row(plan, problem, given, problem.known(root)?.truth(), provenance);
            runs.push(Run { run, ..row });
        }
    }
    let (mut grains, mut contacts) = (Vec::new(), Vec::new());
    let partitions = partitions(&study.asked.variants);
    // Without a partition there is nothing to draw.
    let drawn = plan.reference && !partitions.is_empty();
    for problem in study.problems.iter().filter(|_| drawn) {
        let impulses = problem.known(root)?.impulses();
        for (name, grid, scheme) in &partitions {
            // Runs with a partition that does not fit the problem were skipped.
            if let Ok(partition) = Partition::of_contacts(&problem.frozen.problem, *scheme, *grid) {
                let (g, c) = scene_rows(&problem.frozen, name, &partition, impulses);
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
        snapshots: snapshots_table(&snapshots)?,
    })
}

/// What a reader of the tables must know of where their rows come from: one sentence each.
pub(crate) fn notes(study: &Study, records: &[Record]) -> Vec<String> {
    let known = by_id(records);
    let asked: HashSet<String> = study.tasks().into_iter().map(|task| task.id).collect();
    let runs: Vec<&Run> = asked.iter().filter_map(|id| known.get(id.as_str())).map(|r| &r.run).collect();
    let mut notes: Vec<String> = origins(runs.iter().map(|run| &run.provenance)).into_iter().collect();
    let timed = || runs.iter().filter(|run| run.status != "skipped");
    let together = timed().filter(|run| !run.timing.timed_alone).count();
    if together > 0 {
        notes.push(format!(
            "Runs made beside others: {together}; their seconds are not those of a run alone."
        ));
    }
    let once = timed().filter(|run| run.timing.repeats < study.asked.plan.repeats.get()).count();
    if once > 0 {
        notes.push(format!("Runs repeated less often than the plan asks: {once}."));
    }
    let missing = study.asked.runs() - runs.len();
    if missing > 0 {
        notes.push(format!("Runs of the plan that are not made yet: {missing}."));
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

/// Says so if rows do not come from one build on one machine.
pub(crate) fn origins<'r>(rows: impl Iterator<Item = &'r Provenance>) -> Option<String> {
    let mut origins: Vec<&Provenance> = Vec::new();
    for row in rows {
        if !origins.iter().any(|other| other.comparable(row)) {
            origins.push(row);
        }
    }
    (origins.len() > 1).then(|| {
        format!(
            "The rows come from {} builds, machines or numbers of threads: their counts compare, their seconds do not. \
             --rerun times all again.",
            origins.len()
        )
    })
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
