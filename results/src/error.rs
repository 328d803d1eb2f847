//! Errors of rows, journals and stores.

use polars::prelude::PolarsError;
use seal::Damaged;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a row is not stored, or a line of a journal not taken.
#[derive(Debug, Error)]
pub enum RowError {
    /// It does not say where it comes from.
    #[error("provenance: `{0}` is unknown, and a run without it is not stored")]
    Untraced(&'static str),
    /// The operating system does not describe the machine.
    #[error("provenance: the processor cannot be read: {0}")]
    System(String),
    /// A text is none of those that it can be.
    #[error("`{key}` is \"{value}\": it must be one of {}", known.join(", "))]
    Name {
        /// Key of the text.
        key: &'static str,
        /// The text.
        value: String,
        /// Accepted texts.
        known: Vec<&'static str>,
    },
    /// A line was changed after it was written.
    #[error(transparent)]
    Damaged(#[from] Damaged),
    /// A line has lost its checksum.
    #[error("damaged: it has no checksum, and a line before it has one")]
    Unsealed,
    /// A line is no row, or one of another version of the schema.
    #[error("not a run as this version writes them: {0}")]
    Json(#[from] serde_json::Error),
}

impl RowError {
    /// Refuses a text that is none of the `known` ones.
    ///
    /// # Errors
    ///
    /// Names the key, the text and those that are known.
    pub fn unless_known(key: &'static str, value: &str, known: &[&'static str]) -> Result<(), Self> {
        if known.contains(&value) {
            return Ok(());
        }
        Err(Self::Name { key, value: value.to_owned(), known: known.to_vec() })
    }
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
    /// A table was changed after it was written.
    #[error("{path}: {source}; `gravel bench` makes the tables again from the journal")]
    Damaged {
        /// Which file.
        path: PathBuf,
        /// In what it shows.
        source: Damaged,
    },
    /// Two tables of a study were not written together.
    #[error(
        "{} is not of the same time as {}: the program was stopped between them; `gravel bench` makes the tables again \
         from the journal",
        path.display(),
        other.display()
    )]
    Apart {
        /// Which file.
        path: PathBuf,
        /// The one that was read before it.
        other: PathBuf,
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
        /// Process that writes to it.
        holder: String,
    },
    /// A run does not say where it comes from, or ended as nothing ends.
    #[error(transparent)]
    Entry(#[from] RowError),
    /// A plan's name is the name of a folder.
    #[error("plan `{0}`: its name must be one folder's name, not starting with a dot")]
    Plan(String),
}

/// Names the file that an error of the system is of.
pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    |source| StoreError::File { path, source }
}
