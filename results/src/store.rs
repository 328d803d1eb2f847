//! A study on disk: one folder `root/<plan>/<time>`, which appears once all its files are in it.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use polars::prelude::{
    CsvWriter, DataFrame, ParquetReader, ParquetWriter, PolarsError, SerReader, SerWriter,
};
use tempfile::TempDir;
use thiserror::Error;

const RUNS: &str = "runs.parquet";
const CURVES: &str = "curves.parquet";
const GRAINS: &str = "grains.parquet";
const CONTACTS: &str = "contacts.parquet";
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
}

/// Why tables were not written or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// A file or folder cannot be made, opened or renamed.
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
    /// A run does not say where it comes from.
    #[error("row {row} of the runs has no `{column}`, and a run without it is not stored")]
    Untraced {
        /// Row of the table of runs.
        row: usize,
        /// What is missing.
        column: &'static str,
    },
    /// A plan's name is the name of a folder.
    #[error("plan `{0}`: its name must be one folder's name, not starting with a dot")]
    Plan(String),
    /// The time is part of the folder's name.
    #[error("`{text}` is not a time in UTC: {source}")]
    Time {
        /// What was given.
        text: String,
        /// Why it is none.
        source: jiff::Error,
    },
}

/// Room for the tables of one study. Until [`Store::write`] they have no visible folder.
#[derive(Debug)]
pub struct Store {
    /// `root/<plan>`.
    plan: PathBuf,
    /// Name of the folder to be.
    time: String,
    /// Where the files are gathered; removed with this value.
    gathered: TempDir,
}

impl Store {
    /// Makes room below `root/<plan>` for a study that began at `started_utc` (RFC 3339).
    /// A place that cannot be written to is so known before the first run, not after the last.
    ///
    /// # Errors
    ///
    /// If the plan's name is not a folder's, the time not a time, or the folder cannot be written to.
    pub fn create(root: &Path, plan: &str, started_utc: &str) -> Result<Self, StoreError> {
        if plan.is_empty() || plan.starts_with('.') || plan.contains(['/', '\\', ':']) {
            return Err(StoreError::Plan(plan.to_owned()));
        }
        let time: Timestamp = started_utc
            .parse()
            .map_err(|source| StoreError::Time { text: started_utc.to_owned(), source })?;
        let plan = root.join(plan);
        fs::create_dir_all(&plan).map_err(at(&plan))?;
        let gathered = TempDir::with_prefix_in(".unfinished-", &plan).map_err(at(&plan))?;
        // Some file systems allow no colon in a name.
        Ok(Self { plan, time: time.strftime("%Y-%m-%dT%H-%M-%SZ").to_string(), gathered })
    }

    /// Writes all tables, or nothing, and returns their folder: the time, with `-2`, `-3` … if that exists.
    ///
    /// # Errors
    ///
    /// If a file cannot be written, or a run has no commit, compiler, processor, threads, time or problem hash.
    pub fn write(self, tables: &Tables) -> Result<PathBuf, StoreError> {
        check_traced(&tables.runs)?;
        // A folder inside the temporary one, since the temporary one is closed to other users.
        let files = self.gathered.path().join("tables");
        fs::create_dir(&files).map_err(at(&files))?;
        write_parquet(&tables.runs, &files.join(RUNS))?;
        write_parquet(&tables.curves, &files.join(CURVES))?;
        write_parquet(&tables.grains, &files.join(GRAINS))?;
        write_parquet(&tables.contacts, &files.join(CONTACTS))?;
        write_csv(&tables.runs, &files.join(RUNS_CSV))?;
        write_csv(&tables.curves, &files.join(CURVES_CSV))?;
        self.publish(&files)
    }

    /// Renames the folder of files to the first name that is free.
    fn publish(&self, files: &Path) -> Result<PathBuf, StoreError> {
        let mut count = 1;
        loop {
            let name = if count == 1 { self.time.clone() } else { format!("{}-{count}", self.time) };
            let folder = self.plan.join(name);
            // A rename would replace an empty folder; one that holds files refuses by itself.
            if !folder.exists() {
                match fs::rename(files, &folder) {
                    Ok(()) => return Ok(folder),
                    // Another study took the name in the meantime.
                    Err(_) if folder.exists() => {}
                    Err(e) => return Err(at(&folder)(e)),
                }
            }
            count += 1;
        }
    }
}

/// Reads the tables of a folder that [`Store::write`] made.
///
/// # Errors
///
/// If a file is missing or is not a table.
pub fn read(folder: &Path) -> Result<Tables, StoreError> {
    Ok(Tables {
        runs: read_parquet(&folder.join(RUNS))?,
        curves: read_parquet(&folder.join(CURVES))?,
        grains: read_parquet(&folder.join(GRAINS))?,
        contacts: read_parquet(&folder.join(CONTACTS))?,
    })
}

/// The latest study of a plan, if there is any.
pub fn latest(root: &Path, plan: &str) -> Option<PathBuf> {
    let folders = fs::read_dir(root.join(plan)).ok()?.filter_map(Result::ok).map(|entry| entry.path());
    folders
        .filter(|folder| folder.join(RUNS).is_file())
        .filter_map(|f| Some((age_key(&f)?, f)))
        .max()
        .map(|(_, f)| f)
}

/// Time and count of a folder's name, in an order in which `-10` comes after `-9`.
fn age_key(folder: &Path) -> Option<(String, u32)> {
    let name = folder.file_name()?.to_str()?;
    if name.starts_with('.') {
        return None;
    }
    let (time, count) = name.split_once('Z')?;
    Some((time.to_owned(), count.strip_prefix('-').and_then(|n| n.parse().ok()).unwrap_or(1)))
}

fn check_traced(runs: &DataFrame) -> Result<(), StoreError> {
    let path = || format(Path::new(RUNS));
    for column in ["problem_hash", "commit", "processor", "rustc", "started_utc"] {
        let texts = runs.column(column).and_then(|c| c.str()).map_err(path())?;
        if let Some(row) = texts.iter().position(|text| text.is_none_or(|text| text.trim().is_empty())) {
            return Err(StoreError::Untraced { row, column });
        }
    }
    let threads = runs.column("threads").and_then(|c| c.u32()).map_err(path())?;
    match threads.iter().position(|n| n.is_none_or(|n| n == 0)) {
        Some(row) => Err(StoreError::Untraced { row, column: "threads" }),
        None => Ok(()),
    }
}

fn write_parquet(table: &DataFrame, path: &Path) -> Result<(), StoreError> {
    let file = File::create_new(path).map_err(at(path))?;
    ParquetWriter::new(&file).finish(&mut table.clone()).map_err(format(path))?;
    file.sync_all().map_err(at(path))
}

fn write_csv(table: &DataFrame, path: &Path) -> Result<(), StoreError> {
    let mut file = File::create_new(path).map_err(at(path))?;
    CsvWriter::new(&mut file).finish(&mut table.clone()).map_err(format(path))?;
    file.sync_all().map_err(at(path))
}

fn read_parquet(path: &Path) -> Result<DataFrame, StoreError> {
    let file = File::open(path).map_err(at(path))?;
    ParquetReader::new(file).finish().map_err(format(path))
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    |source| StoreError::File { path, source }
}

fn format(path: &Path) -> impl FnOnce(PolarsError) -> StoreError {
    let path = path.to_owned();
    |source| StoreError::Format { path, source }
}

#[cfg(test)]
mod tests;
