//! A study on disk: the folder `root/<plan>` with its journal, and the tables that are made from it.

mod files;

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use polars::prelude::{CsvWriter, DataFrame, ParquetWriter, PolarsError, PolarsResult, SerWriter};
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

use crate::columns::{keys, rows};
use crate::journal::{Entry, Journal, Lines, Record, RowError, read as read_journal};
use crate::schema::{Run, Sample, Snapshot};
use crate::simulation::{Observed, Simulated, Simulation};
use crate::study::{
    CONTACTS, CURVES, GRAINS, Named, RUN, RUNS, Runs, SERIES, SIMULATION, SIMULATIONS, SNAPSHOTS, Study,
    TABLES,
};
pub(crate) use files::at;
pub use files::behind_links;
use files::{lock, new_dated_folder, read_parquet, write_whole};

const JOURNAL: &str = "journal.jsonl";
const LOCK: &str = "lock";
/// Problems of the last good states of simulations that exploded.
pub const LAST_STATES: &str = "last-states";

/// Why a study was not written or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// A file or folder cannot be made, opened, written or renamed.
    #[error("{path}: {source}")]
    File {
        /// Which one.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A table cannot be put into a file's format, or a file does not hold a table.
    #[error("{path}: {source}")]
    Format {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: PolarsError,
    },
    /// A line of a journal is damaged, or no run as this version writes them.
    #[error("{path}, line {line}: {source}")]
    Line {
        /// Which journal.
        path: PathBuf,
        /// Which line, counted from 1.
        line: usize,
        /// Why.
        source: RowError,
    },
    /// Another process writes to the study.
    #[error("{folder} is being written by {holder}: wait until it ends, or stop it")]
    InUse {
        /// Which study.
        folder: PathBuf,
        /// Who writes.
        holder: String,
    },
    /// A run does not say where it comes from, or ended as nothing ends.
    #[error(transparent)]
    Entry(#[from] RowError),
    /// A plan's name is the name of a folder.
    #[error("plan `{0}`: its name must be one folder's name, not starting with a dot")]
    Plan(String),
}

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
    /// known before the first run, not after the last.
    ///
    /// # Errors
    ///
    /// If the plan's name is not a folder's, the folder cannot be written to or another process writes to it, or its
    /// journal holds something else than runs.
    pub fn open(root: &Path, plan: &str) -> Result<Self, StoreError> {
        let folder = folder(root, plan)?;
        fs::create_dir_all(&folder).map_err(at(&folder))?;
        let lock = lock(&folder.join(LOCK))?;
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

    /// Length of a torn last line that was dropped (bytes); 0 if there was none.
    pub fn dropped(&self) -> u64 {
        self.lines.torn
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
        let format = |source| StoreError::Format { path: self.folder.clone(), source };
        study.tables().map_err(format)?.into_par_iter().try_for_each(|Named { name, mut table, csv }| {
            write_whole(&parquet(&self.folder, name), |file| {
                ParquetWriter::new(file).finish(&mut table).map(drop)
            })?;
            if csv {
                let path = self.folder.join(name).with_extension("csv");
                write_whole(&path, |file| CsvWriter::new(file).finish(&mut table))?;
            }
            Ok(())
        })
    }
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

/// The runs, by one of the `known` methods, that a study's folder holds at this moment, whoever writes to it; none if it is
/// not there.
///
/// # Errors
///
/// If its journal cannot be read.
pub fn records_of<R: Entry>(folder: &Path, known: &[&'static str]) -> Result<Vec<R>, StoreError> {
    let path = folder.join(JOURNAL);
    let lines = read_journal(&path)?;
    lines.check_methods(&path, known)?;
    Ok(lines.records)
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

/// Whether a folder is a study: it has a journal.
pub fn is_study(folder: &Path) -> bool {
    folder.join(JOURNAL).is_file()
}

/// Reads the tables of a study's folder.
///
/// # Errors
///
/// If a file is missing, is not a table, or not one of such rows.
pub fn read(folder: &Path) -> Result<Study, StoreError> {
    if parquet(folder, SIMULATIONS).is_file() {
        let simulations: Vec<Simulation> = typed(folder, SIMULATIONS)?;
        let mut series = grouped::<Observed>(folder, SERIES, SIMULATION, simulations.len())?.into_iter();
        let one = |simulation| Simulated { simulation, series: series.next().unwrap_or_default() };
        return Ok(Study::Simulations(simulations.into_iter().map(one).collect()));
    }
    let runs: Vec<Run> = typed(folder, RUNS)?;
    let mut curves = grouped::<Sample>(folder, CURVES, RUN, runs.len())?.into_iter();
    // Older studies have none.
    let has_snapshots = parquet(folder, SNAPSHOTS).is_file();
    let snapshots = has_snapshots.then(|| grouped::<Snapshot>(folder, SNAPSHOTS, RUN, runs.len()));
    let mut snapshots = snapshots.transpose()?.into_iter().flatten();
    let record = |run| Record {
        run,
        curve: curves.next().unwrap_or_default(),
        snapshots: snapshots.next().unwrap_or_default(),
    };
    let records = runs.into_iter().map(record).collect();
    Ok(Study::Runs(Runs { records, grains: typed(folder, GRAINS)?, contacts: typed(folder, CONTACTS)? }))
}

fn parquet(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).with_extension("parquet")
}

fn from_table<T>(
    folder: &Path,
    name: &str,
    read: impl Fn(&DataFrame) -> PolarsResult<T>,
) -> Result<T, StoreError> {
    let path = parquet(folder, name);
    read(&read_parquet(&path)?).map_err(|source| StoreError::Format { path, source })
}

/// The rows of a table.
fn typed<Row>(folder: &Path, name: &str) -> Result<Vec<Row>, StoreError>
where
    Row: Serialize + DeserializeOwned + Default + Send,
{
    from_table(folder, name, rows)
}

/// The rows of a table whose column `key` says of which run or simulation each is; rows of none are left aside.
fn grouped<Row>(folder: &Path, name: &str, key: &str, count: usize) -> Result<Vec<Vec<Row>>, StoreError>
where
    Row: Serialize + DeserializeOwned + Default + Send,
{
    let (keys, rows) = from_table(folder, name, |table| Ok((keys(key, table)?, rows::<Row>(table)?)))?;
    let mut groups: Vec<Vec<Row>> = Vec::new();
    groups.resize_with(count, Vec::new);
    for (key, row) in keys.into_iter().zip(rows) {
        if let Some(group) = groups.get_mut(key as usize) {
            group.push(row);
        }
    }
    Ok(groups)
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
