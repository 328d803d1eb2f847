//! The folder of a study: opened, gone on with, its tables and report written.

use crate::plan::{Method, Plan, method_names};
use crate::root::Root;
use crate::run::Task;
use crate::study::{Kind, Selection, by_id, missing};
use crate::terminal::{exit, say};
use anyhow::{Context, Result, anyhow, ensure};
use lineup::Settings;
use reports::{About, Formats, Wanted, made};
use results::error::StoreError;
use results::journal::Entry;
use results::schema::Provenance;
use results::store::Store;
use results::study::{Runs, Study as Rows, TABLES};
use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Returns the folder that stores studies.
pub(crate) fn runs_folder(root: &Root) -> PathBuf {
    root.join("results/runs")
}

/// Opens the store of a plan, and says what was lost with a process that was killed.
pub(crate) fn open<R: Entry>(root: &Root, plan: &str) -> Result<Store<R>> {
    let opened = Store::open(&runs_folder(root), plan);
    let store = opened.and_then(|store| store.check_methods(&method_names()).map(|()| store));
    let store = store.map_err(|error| match error {
        StoreError::Line { .. } => anyhow!(
            "{error}; take the line out and its run is run again, or `gravel bench --fresh` keeps the file aside and \
             starts afresh"
        ),
        error => error.into(),
    })?;
    let (folder, torn) = (store.folder().display(), store.lines().torn);
    if torn > 0 {
        eprintln!("{folder}: the last run was not written to its end ({torn} bytes): dropped");
    }
    note_unsealed(store.folder(), store.lines().unsealed);
    Ok(store)
}

/// Returns the runs that the journal of a study holds at this moment; says how many of them have no checksum.
pub(crate) fn records_of<R: Entry>(folder: &Path) -> Result<Vec<R>> {
    let lines = results::store::records_of(folder, &method_names())?;
    note_unsealed(folder, lines.unsealed);
    Ok(lines.records)
}

/// Says that damage to the journal in a folder may go unnoticed: in so many lines of it.
fn note_unsealed(folder: &Path, unsealed: usize) {
    if unsealed > 0 {
        let folder = folder.display();
        eprintln!("{folder}: runs in the journal from before there were checksums: {unsealed}; {UNSEALED}");
    }
}

const UNSEALED: &str = "damage to them would go unnoticed";

/// Returns the tables of a study, in which a setting that came after a row was made has its default: so rows of two versions are of
/// one method.
pub(crate) fn tables_of(folder: &Path) -> Result<Rows> {
    let mut rows = tables_as_written(folder)?;
    let complete = |method: &str, settings: &mut Settings| {
        // One that the method lacks by now is shown as it is.
        if let Ok(method) = Method::new(method, settings.clone()) {
            *settings = method.settings;
        }
    };
    match &mut rows {
        Rows::Runs(Runs { records, .. }) => {
            for one in records {
                complete(&one.run.method, &mut one.run.settings);
            }
        }
        Rows::Simulations(all) => {
            for one in all {
                complete(&one.simulation.method, &mut one.simulation.settings);
            }
        }
    }
    Ok(rows)
}

/// Returns the tables of a study; says which of them have no checksum.
pub(crate) fn tables_as_written(folder: &Path) -> Result<Rows> {
    let (rows, unsealed) = results::store::read(folder)?;
    if !unsealed.is_empty() {
        let names: Vec<_> =
            unsealed.iter().filter_map(|path| Some(path.file_name()?.to_string_lossy())).collect();
        let (folder, names) = (folder.display(), names.join(", "));
        eprintln!(
            "{folder}: tables from before there were checksums: {names}; {UNSEALED}, and `gravel bench` makes them again"
        );
    }
    Ok(rows)
}

/// Returns the folders of tables below a folder, by name.
pub(crate) fn studies_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let name = || folder.display().to_string();
    let mut studies = Vec::new();
    for entry in fs::read_dir(folder).with_context(name)? {
        studies.extend(Some(entry.with_context(name)?.path()).filter(|path| has_tables(path)));
    }
    studies.sort();
    ensure!(!studies.is_empty(), "{}: it holds no tables of a study", name());
    Ok(studies)
}

/// Reports whether a folder has tables of a study.
pub(crate) fn has_tables(folder: &Path) -> bool {
    TABLES.iter().any(|table| folder.join(format!("{table}.parquet")).is_file())
}

/// Writes the tables of a study from its store, and its report if the user did not stop it.
pub(crate) fn finish<K: Kind>(root: &Root, study: &K, mut store: Store<K::Record>) -> Result<ExitCode> {
    let _whole = exit::whole();
    let Selection { plan, again, .. } = study.selection();
    let tasks = study.tasks();
    let known = by_id(store.records());
    let mut ended = Vec::new();
    for task in &tasks {
        ended.extend(known.get(task.id.as_str()).map(|record| (task.clone(), (*record).clone())));
    }
    let rows = study.rows(root, ended)?;
    if exit::requested() {
        let missing = missing(&tasks, &known.into_keys().collect()).len();
        store.write_tables(&rows)?;
        say(format_args!(
            "stopped; {} missing: {missing}, the others are kept; `gravel bench {again}` goes on",
            K::TASKS
        ))?;
        return Ok(exit::code("interrupted"));
    }
    let notes = notes(study, &tasks, store.records());
    let (folder, charts, about) = (store.folder().to_owned(), plan.charts(), about(plan, again));
    draw(root, &plan.name, &folder, Formats::default(), |formats, out| {
        let wanted = Wanted { charts: &charts, formats, against: None };
        let (written, drawn) =
            rayon::join(|| store.write_tables(&rows), || reports::report(&rows, &about, wanted, out));
        // The tables come before the words, which may meet a closed pipe.
        written?;
        say(format_args!("{}", reports::summary(&rows)?))?;
        for note in notes {
            say(format_args!("{note}"))?;
        }
        if let Some(text) = &about.text {
            say(format_args!("discussed in {text}"))?;
        }
        Ok(drawn?)
    })?;
    Ok(ExitCode::SUCCESS)
}

/// Describes a study, whose arguments are `again`, for its page.
pub(crate) fn about(plan: &Plan, again: &str) -> About {
    // A study that is changed is drawn by its own command alone.
    let drawn_again = again.split_whitespace().skip(1).all(|word| word == "--quick");
    let draw = drawn_again.then(|| again.to_owned());
    let rows = format!("../../../results/runs/{}", plan.name);
    let text = plan.text.clone();
    About { name: plan.name.clone(), why: plan.why.clone(), bench: again.to_owned(), rows, text, draw }
}

/// Draws into a folder of `reports/out` from the tables in `stored`, in `formats` and those of the files that are there; then
/// says where the rows and the files are, and which of those that were there are gone.
pub(crate) fn draw(
    root: &Root,
    name: &str,
    stored: &Path,
    formats: Formats,
    draw: impl FnOnce(Formats, &Path) -> Result<Vec<PathBuf>>,
) -> Result<()> {
    let out = root.join("reports/out").join(name);
    let before = made(&out);
    let files = draw(formats.and_those_of(&before), &out)?;
    say(format_args!("rows and curves   {}", stored.display()))?;
    say(format_args!("tables and figures {}", out.display()))?;
    for file in &files {
        say(format_args!("  {}", file.file_name().unwrap_or_default().to_string_lossy()))?;
    }
    if let Some(page) = files.iter().find(|file| file.ends_with("index.html")) {
        say(format_args!("open {} in a browser", page.display()))?;
    }
    let gone: Vec<&str> =
        before.iter().map(String::as_str).filter(|name| !files.contains(&out.join(name))).collect();
    if !gone.is_empty() {
        say(format_args!("removed, since this report does not write them: {}", gone.join(", ")))?;
    }
    Ok(())
}

/// Returns the notes on where the rows of the tables come from, one sentence each.
fn notes<K: Kind>(study: &K, tasks: &[Task<K::What<'_>>], records: &[K::Record]) -> Vec<String> {
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
    let is_crowded = |record: &&&K::Record| {
        let processors = record.provenance().processors;
        processors > 0 && record.timing().load_average > f64::from(processors)
    };
    note(
        ended.iter().filter(is_crowded).count(),
        &format!(
            "More processes than processors at their start: {{}} {what}; their seconds may be longer than those of a run alone."
        ),
    );
    let repeats = study.selection().plan.repeats.get();
    note(
        timed().filter(|timing| timing.repeats < repeats).count(),
        &format!("Repeated less often than the plan asks: {{}} {what}."),
    );
    note(study.size() - ended.len(), &format!("Not run yet, of those of the plan: {{}} {what}."));
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
    notes
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

/// Lists the runs whose counts differ from those of the first of their id, by name and id.
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
