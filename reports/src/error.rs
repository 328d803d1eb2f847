//! Why there is no report.

use std::io;
use std::path::PathBuf;

use polars::prelude::PolarsError;
use thiserror::Error;

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A table cannot be made.
    #[error("a table: {0}")]
    Table(#[from] PolarsError),
    /// The drawing library refuses.
    #[error("a figure cannot be drawn: {0}")]
    Drawing(String),
    /// A template is none, or asks for what is not there.
    #[error("the template: {0}")]
    Template(String),
    /// A table, or a column of it, that is not there.
    #[error("no {what} `{name}`; known: {}", known.join(", "))]
    Unknown {
        /// Kind of thing asked for, in words.
        what: String,
        /// Its name.
        name: String,
        /// Known names.
        known: Vec<String>,
    },
    /// A file or folder cannot be written or replaced.
    #[error("{path}: {source}")]
    File {
        /// Which one.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}
