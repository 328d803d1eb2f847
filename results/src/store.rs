//! A study on disk: the folder `root/<plan>` with its journal, and the tables that are made from it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use polars::prelude::{
    CsvWriter, DataFrame, ParquetReader, ParquetWriter, PolarsError, SerReader, SerWriter,
};
use thiserror::Error;

use crate::journal::{Journal, Lines, Record, read as read_journal};
use crate::provenance::ProvenanceError;
use crate::schema::Snapshot;
use crate::tables::snapshots_table;

const JOURNAL: &str = "journal.jsonl";
const LOCK: &str = "lock";
const RUNS: &str = "runs.parquet";
const CURVES: &str = "curves.parquet";
const GRAINS: &str = "grains.parquet";
const CONTACTS: &str = "contacts.parquet";
const SNAPSHOTS: &str = "snapshots.parquet";
/// The same rows once more, for spreadsheets and `diff`.
const RUNS_CSV: &str = "runs.csv";
const CURVES_CSV: &str = "curves.csv";

/// The tables of a study, as [`crate::tables`] makes them.
#[derive(Clone, Debug)]
pub struct Tables {
    /// One row per run.
    pub runs: DataFrame,
    /// One row per sample of a run.
    pub curves: DataFrame,
    /// One row per grain and partition.
    pub grains: DataFrame,
    /// One row per contact and partition.
    pub contacts: DataFrame,
    /// One row per contact of the kept iterates of some runs; of older studies none.
    pub snapshots: DataFrame,
}

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
    /// A line of a journal is no run, or one of another version of the schema.
    #[error("{path}, line {line}: not a run as this version writes them: {source}")]
    Line {
        /// Which journal.
        path: PathBuf,
        /// Which line, counted from 1.
        line: usize,
        /// Why.
        source: serde_json::Error,
    },
    /// Another process writes to the study.
    #[error("{folder} is being written by {holder}: wait until it ends, or stop it")]
    InUse {
        /// Which study.
        folder: PathBuf,
        /// Who writes.
        holder: String,
    },
    /// A run does not say where it comes from.
    #[error(transparent)]
    Untraced(#[from] ProvenanceError),
    /// A plan's name is the name of a folder.
    #[error("plan `{0}`: its name must be one folder's name, not starting with a dot")]
    Plan(String),
}

/// A study that this process, and no other, writes to.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    journal: Journal,
    lines: Lines,
    /// Locked as long as it is open, whatever ends the process.
    _lock: File,
}

impl Store {
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
        let lock = lock(&folder)?;
        let (journal, lines) = Journal::open(&folder.join(JOURNAL))?;
        Ok(Self { folder, journal, lines, _lock: lock })
    }

    /// Moves all that the study of a plan holds, readable or not, to a folder inside it that is named after the time, and
    /// returns that folder; `None` if there is nothing to move.
    ///
    /// # Errors
    ///
    /// As [`Store::open`], and if a file cannot be moved.
    pub fn set_aside(root: &Path, plan: &str) -> Result<Option<PathBuf>, StoreError> {
        let folder = folder(root, plan)?;
        // The journal first: what it holds is what counts.
        let files = [JOURNAL, RUNS, CURVES, GRAINS, CONTACTS, SNAPSHOTS, RUNS_CSV, CURVES_CSV];
        let files: Vec<&str> = files.into_iter().filter(|file| folder.join(file).exists()).collect();
        if files.is_empty() {
            return Ok(None);
        }
        let _lock = lock(&folder)?;
        let aside = new_dated_folder(&folder)?;
        for file in files {
            fs::rename(folder.join(file), aside.join(file)).map_err(at(&folder.join(file)))?;
        }
        Ok(Some(aside))
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// All runs, in the order in which they ended: of two with one id, the later counts.
    pub fn records(&self) -> &[Record] {
        &self.lines.records
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
    pub fn append(&mut self, record: Record) -> Result<(), StoreError> {
        if record.run.problem_hash.is_empty() {
            return Err(ProvenanceError::Unknown("problem_hash").into());
        }
        record.run.provenance.check()?;
        self.journal.append(&record)?;
        self.lines.records.push(record);
        Ok(())
    }

    /// Replaces the tables, each file at once.
    ///
    /// # Errors
    ///
    /// If a file cannot be written.
    pub fn write_tables(&mut self, tables: &Tables) -> Result<(), StoreError> {
        self.journal.sync()?;
        let parquet = [
            (RUNS, &tables.runs),
            (CURVES, &tables.curves),
            (GRAINS, &tables.grains),
            (CONTACTS, &tables.contacts),
            (SNAPSHOTS, &tables.snapshots),
        ];
        for (name, table) in parquet {
            write_whole(&self.folder.join(name), |file| {
                ParquetWriter::new(file).finish(&mut table.clone()).map(drop)
            })?;
        }
        for (name, table) in [(RUNS_CSV, &tables.runs), (CURVES_CSV, &tables.curves)] {
            write_whole(&self.folder.join(name), |file| CsvWriter::new(file).finish(&mut table.clone()))?;
        }
        Ok(())
    }
}

/// The runs that a study's folder holds at this moment, whoever writes to it; none if it is not there.
///
/// # Errors
///
/// If its journal cannot be read.
pub fn records_of(folder: &Path) -> Result<Vec<Record>, StoreError> {
    Ok(read_journal(&folder.join(JOURNAL))?.records)
}

/// Whether a folder is a study: it has a journal.
pub fn is_study(folder: &Path) -> bool {
    folder.join(JOURNAL).is_file()
}

/// Reads the tables of a study's folder.
///
/// # Errors
///
/// If a file is missing or is not a table.
pub fn read(folder: &Path) -> Result<Tables, StoreError> {
    let snapshots = folder.join(SNAPSHOTS);
    let none = |source| StoreError::Format { path: snapshots.clone(), source };
    Ok(Tables {
        runs: read_parquet(&folder.join(RUNS))?,
        curves: read_parquet(&folder.join(CURVES))?,
        grains: read_parquet(&folder.join(GRAINS))?,
        contacts: read_parquet(&folder.join(CONTACTS))?,
        snapshots: if snapshots.is_file() {
            read_parquet(&snapshots)?
        } else {
            snapshots_table::<Vec<Snapshot>>(&[]).map_err(none)?
        },
    })
}

/// The folder of a plan's study, if it has tables.
pub fn tables_folder(root: &Path, plan: &str) -> Option<PathBuf> {
    let folder = folder(root, plan).ok()?;
    folder.join(RUNS).is_file().then_some(folder)
}

fn folder(root: &Path, plan: &str) -> Result<PathBuf, StoreError> {
    if plan.is_empty() || plan.starts_with('.') || plan.contains(['/', '\\', ':']) {
        return Err(StoreError::Plan(plan.to_owned()));
    }
    Ok(root.join(plan))
}

/// Locks the folder, or says who holds it.
fn lock(folder: &Path) -> Result<File, StoreError> {
    let path = folder.join(LOCK);
    let mut options = OpenOptions::new();
    let mut file = options.write(true).create(true).truncate(false).open(&path).map_err(at(&path))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            let holder = fs::read_to_string(&path).map_err(at(&path))?;
            return Err(StoreError::InUse { folder: folder.to_owned(), holder });
        }
        Err(TryLockError::Error(error)) => return Err(at(&path)(error)),
    }
    let since = Timestamp::now().strftime("%Y-%m-%dT%H:%M:%SZ");
    let holder = format!("process {} since {since}", std::process::id());
    file.set_len(0).and_then(|()| file.write_all(holder.as_bytes())).map_err(at(&path))?;
    Ok(file)
}

/// A folder named after the time, with `-2`, `-3` … if that exists. Some file systems allow no colon in a name.
fn new_dated_folder(parent: &Path) -> Result<PathBuf, StoreError> {
    let time = Timestamp::now().strftime("%Y-%m-%dT%H-%M-%SZ").to_string();
    let mut path = parent.join(&time);
    let mut count = 1;
    loop {
        match fs::create_dir(&path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                count += 1;
                path = parent.join(format!("{time}-{count}"));
            }
            Err(error) => return Err(at(&path)(error)),
        }
    }
}

/// Writes a table beside its place and gives it its name once it is complete.
fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), PolarsError>,
) -> Result<(), StoreError> {
    let folder = path.parent().unwrap_or(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".unfinished-");
    // A temporary file is closed to other users unless it asks for what files usually get.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(at(path))?;
    write(file.as_file_mut()).map_err(|source| StoreError::Format { path: path.to_owned(), source })?;
    file.as_file().sync_all().map_err(at(path))?;
    file.persist(path).map_err(|error| at(path)(error.error))?;
    Ok(())
}

fn read_parquet(path: &Path) -> Result<DataFrame, StoreError> {
    let file = File::open(path).map_err(at(path))?;
    let format = |source| StoreError::Format { path: path.to_owned(), source };
    ParquetReader::new(file).finish().map_err(format)
}

pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    |source| StoreError::File { path, source }
}

#[cfg(test)]
mod tests;
