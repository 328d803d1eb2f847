//! What a reader of the tables must know of where their rows come from.

use crate::study::tasks::{Kind, Task, by_id};
use anyhow::Result;
use results::journal::Entry;
use results::schema::Provenance;
use std::collections::{HashMap, HashSet};

/// One sentence each.
pub(crate) fn notes<K: Kind>(study: &K, tasks: &[Task<K>], records: &[K::Record]) -> Result<Vec<String>> {
    let known = by_id(records);
    let wanted: HashSet<&str> = tasks.iter().map(|task| task.id.as_str()).collect();
    let ended: Vec<&K::Record> = wanted.iter().filter_map(|id| known.get(id).copied()).collect();
    let mut notes: Vec<String> =
        origins(ended.iter().map(|record| record.provenance())).into_iter().collect();
    // One that was skipped took no time.
    let timed = || ended.iter().map(|record| record.timing()).filter(|timing| timing.wall_s.is_finite());
    let what = K::TASKS;
    let mut note = |count: usize, words: &str| {
        if count > 0 {
            notes.push(words.replace("{}", &count.to_string()));
        }
    };
    note(
        timed().filter(|timing| !timing.timed_alone).count(),
        &format!("Not alone on the machine: {{}} {what}; their seconds are not those of a run alone."),
    );
    let repeats = study.repeats(None)?;
    note(
        timed().filter(|timing| timing.repeats < repeats).count(),
        &format!("Repeated less often than the plan asks: {{}} {what}."),
    );
    note(study.size()? - ended.len(), &format!("Not run yet, of those of the plan: {{}} {what}."));
    note(
        known.keys().filter(|id| !wanted.contains(**id)).count(),
        &format!(
            "Of earlier code, or no longer in the plan: {{}} {what}; they are in the journal, and in no table."
        ),
    );
    let differ = unlike_twins(records);
    if !differ.is_empty() {
        notes.push(format!(
            "WARNING: run again, these {what} counted other work: {}. The same id must mean the same counts.",
            differ.join(", ")
        ));
    }
    Ok(notes)
}

/// Says so if rows do not come from one build on one machine.
fn origins<'r>(rows: impl Iterator<Item = &'r Provenance>) -> Option<String> {
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

/// Those of one id that did not count the same, with their ids.
fn unlike_twins<R: Entry>(records: &[R]) -> Vec<String> {
    let mut first: HashMap<&str, &R> = HashMap::new();
    let mut differ = Vec::new();
    for record in records {
        let twin = *first.entry(record.id()).or_insert(record);
        // Most have no twin but themselves.
        if !std::ptr::eq(twin, record) && twin.difference(record).is_some() {
            differ.push(format!("{} ({})", record.name(), record.id()));
        }
    }
    differ
}
