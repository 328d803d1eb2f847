//! A study on disk: the folder `root/<plan>` with its journal, and the tables that are made from it.

mod files;

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use polars::prelude::{CsvWriter, PolarsResult, SerWriter};
use rayon::prelude::*;

use crate::error::{StoreError, at};
use crate::journal::{Entry, Journal, Lines, Record, read as read_journal};
use crate::schema::{Run, Sample, Snapshot};
use crate::seal::seal_tables;
use crate::simulation::{Observed, Simulated, Simulation};
use crate::study::{
    CONTACTS, CURVES, GRAINS, Named, RUN, RUNS, Runs, SERIES, SIMULATION, SIMULATIONS, SNAPSHOTS, Study,
    TABLES,
};
use crate::whole;
use files::{Tables, lock, new_dated_folder, parquet_of};

const JOURNAL: &str = "journal.jsonl";
const LOCK: &str = "lock";
/// Problems of the last good states of simulations that exploded.
pub const LAST_STATES: &str = "last-states";

/// A study that this process, and no other, writes to: runs on problems, or simulations.
#[derive(Debug)]
pub struct Store<R = Record> {
    folder: PathBuf,
    journal: Journal,
    lines: Lines<R>,
    /// Locked as long as it is open, whatever ends the process.
    _lock: File,
}

impl<R: Entry> Store<R> {
    /// Opens the study of a plan below `root`, and goes on behind what it holds. A place that cannot be written to is so
    /// known before the first run, not after the last. What a program that was killed did not finish is removed.
    ///
    /// # Errors
    ///
    /// If the plan's name is not a folder's, the folder cannot be written to or another process writes to it, or its
    /// journal holds something else than runs.
    pub fn open(root: &Path, plan: &str) -> Result<Self, StoreError> {
        let folder = folder(root, plan)?;
        fs::create_dir_all(&folder).map_err(at(&folder))?;
        let lock = lock(&folder.join(LOCK))?;
        whole::remove_abandoned(&folder).map_err(at(&folder))?;
        let (journal, lines) = Journal::open(&folder.join(JOURNAL))?;
        Ok(Self { folder, journal, lines, _lock: lock })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// All runs, in the order in which they ended: of two with one id, the later counts.
    pub fn records(&self) -> &[R] {
        &self.lines.records
    }

    /// Refuses what [`Lines::check_methods`] does.
    ///
    /// # Errors
    ///
    /// Its errors.
    pub fn check_methods(&self, known: &[&'static str]) -> Result<(), StoreError> {
        self.lines.check_methods(&self.folder.join(JOURNAL), known)
    }

    /// The journal, as it was when it was opened, with all runs.
    pub fn lines(&self) -> &Lines<R> {
        &self.lines
    }

    /// Adds a run. It is in the journal, whole, when this returns; if it fails, the journal is as before.
    ///
    /// # Errors
    ///
    /// If the run has no commit, compiler, processor, threads, time or problem hash, or the journal cannot be written.
    pub fn append(&mut self, record: R) -> Result<(), StoreError> {
        record.check()?;
        self.journal.append(&record)?;
        self.lines.records.push(record);
        Ok(())
    }

    /// Replaces the tables, each file at once.
    ///
    /// # Errors
    ///
    /// If a file cannot be written.
    pub fn write_tables(&mut self, study: &Study) -> Result<(), StoreError> {
        self.journal.sync()?;
        write_tables(&self.folder, study, true)
    }
}

/// Replaces the tables in a folder, each file at once; as CSV too where that is `wanted` and a table has it.
///
/// # Errors
///
/// If a file cannot be written.
pub fn write_tables(folder: &Path, study: &Study, wanted: bool) -> Result<(), StoreError> {
    let format = |source| StoreError::Format { path: folder.to_owned(), source };
    let mut named = study.tables().map_err(format)?;
    let bytes = named.par_iter_mut().map(|Named { table, .. }| parquet_of(table));
    let mut bytes = bytes.collect::<PolarsResult<Vec<_>>>().map_err(format)?;
    seal_tables(&mut bytes).map_err(|source| StoreError::Damaged { path: folder.to_owned(), source })?;
    named.into_par_iter().zip(bytes).try_for_each(|(Named { name, mut table, csv }, bytes)| {
        write_table(&parquet(folder, name), |file| Ok(file.write_all(&bytes)?))?;
        if csv && wanted {
            let path = folder.join(name).with_extension("csv");
            write_table(&path, |file| CsvWriter::new(file).finish(&mut table))?;
        }
        Ok(())
    })
}

/// Writes a table whole, to the disk.
fn write_table(path: &Path, write: impl FnOnce(&mut File) -> PolarsResult<()>) -> Result<(), StoreError> {
    let format = |source| StoreError::Format { path: path.to_owned(), source };
    whole::write(path, |file| {
        write(file)?;
        Ok(file.sync_all()?)
    })
    .map_err(format)
}

impl Store {
    /// Moves all that the study of a plan holds, readable or not, to a folder inside it that is named after the time, and
    /// returns that folder; `None` if there is nothing to move.
    ///
    /// # Errors
    ///
    /// As [`Store::open`], and if a file cannot be moved.
    pub fn set_aside(root: &Path, plan: &str) -> Result<Option<PathBuf>, StoreError> {
        let folder = folder(root, plan)?;
        // The journal first: what it holds is what counts.
        let tables = TABLES.iter().flat_map(|name| [format!("{name}.parquet"), format!("{name}.csv")]);
        let files = [JOURNAL, LAST_STATES].map(str::to_owned).into_iter().chain(tables);
        let files: Vec<String> = files.filter(|file| folder.join(file).exists()).collect();
        if files.is_empty() {
            return Ok(None);
        }
        let _lock = lock(&folder.join(LOCK))?;
        let aside = new_dated_folder(&folder)?;
        for file in files {
            fs::rename(folder.join(&file), aside.join(&file)).map_err(at(&folder.join(&file)))?;
        }
        Ok(Some(aside))
    }
}

/// Returns what the journal of a study's folder holds at this moment, whoever writes to it: runs by one of the `known` methods; nothing if
/// it is not there.
///
/// # Errors
///
/// If its journal cannot be read.
pub fn records_of<R: Entry>(folder: &Path, known: &[&'static str]) -> Result<Lines<R>, StoreError> {
    let path = folder.join(JOURNAL);
    let lines = read_journal(&path)?;
    lines.check_methods(&path, known)?;
    Ok(lines)
}

/// The journals of all studies below `root`, by name; none if it is not there.
///
/// # Errors
///
/// If the folder cannot be listed.
pub fn journals(root: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let entries = match fs::read_dir(root) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(at(root))?,
    };
    let folders: Vec<PathBuf> =
        entries.map(|entry| Ok(entry?.path())).collect::<Result<_, _>>().map_err(at(root))?;
    let mut journals: Vec<PathBuf> =
        folders.iter().filter(|folder| is_study(folder)).map(|folder| folder.join(JOURNAL)).collect();
    journals.sort();
    Ok(journals)
}

/// Reports whether a folder is a study: it has a journal.
pub fn is_study(folder: &Path) -> bool {
    folder.join(JOURNAL).is_file()
}

/// Reads the tables of a study's folder; and returns with them the paths of those that have no checksum, since they are from before
/// there were any.
///
/// # Errors
///
/// If a file is missing, is not a table, not one of such rows, was changed, or was written at another time than the others.
pub fn read(folder: &Path) -> Result<(Study, Vec<PathBuf>), StoreError> {
    let mut tables = Tables::default();
    let study = read_study(folder, &mut tables)?;
    Ok((study, tables.unsealed))
}

fn read_study(folder: &Path, tables: &mut Tables) -> Result<Study, StoreError> {
    if parquet(folder, SIMULATIONS).is_file() {
        let simulations: Vec<Simulation> = tables.rows(&parquet(folder, SIMULATIONS))?;
        let series = tables.groups::<Observed>(&parquet(folder, SERIES), SIMULATION, simulations.len())?;
        let mut series = series.into_iter();
        let one = |simulation| Simulated { simulation, series: series.next().unwrap_or_default() };
        return Ok(Study::Simulations(simulations.into_iter().map(one).collect()));
    }
    let runs: Vec<Run> = tables.rows(&parquet(folder, RUNS))?;
    let mut curves = tables.groups::<Sample>(&parquet(folder, CURVES), RUN, runs.len())?.into_iter();
    // Older studies have none.
    let snapshots = Some(parquet(folder, SNAPSHOTS)).filter(|path| path.is_file());
    let snapshots = snapshots.map(|path| tables.groups::<Snapshot>(&path, RUN, runs.len())).transpose()?;
    let mut snapshots = snapshots.into_iter().flatten();
    let record = |run| Record {
        run,
        curve: curves.next().unwrap_or_default(),
        snapshots: snapshots.next().unwrap_or_default(),
    };
    let records = runs.into_iter().map(record).collect();
    let grains = tables.rows(&parquet(folder, GRAINS))?;
    Ok(Study::Runs(Runs { records, grains, contacts: tables.rows(&parquet(folder, CONTACTS))? }))
}

fn parquet(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).with_extension("parquet")
}

/// The folder of a plan's study, if it has tables.
pub fn tables_folder(root: &Path, plan: &str) -> Option<PathBuf> {
    let folder = folder(root, plan).ok()?;
    [RUNS, SIMULATIONS].iter().any(|table| parquet(&folder, table).is_file()).then_some(folder)
}

fn folder(root: &Path, plan: &str) -> Result<PathBuf, StoreError> {
    if plan.is_empty() || plan.starts_with('.') || plan.contains(['/', '\\', ':']) {
        return Err(StoreError::Plan(plan.to_owned()));
    }
    Ok(root.join(plan))
}

#[cfg(test)]
mod tests;
