//! Why there is no report.

use std::io;
use std::path::PathBuf;

use polars::prelude::PolarsError;
use thiserror::Error;

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A table lacks a column, or it holds something else.
    #[error("the stored tables: {0}")]
    Table(#[from] PolarsError),
    /// A column that must be filled has a null.
    #[error("the stored tables: column `{column}` is empty in row {row}")]
    Null {
        /// Name of the column.
        column: String,
        /// The first such row.
        row: usize,
    },
    /// A column of JSON has something else.
    #[error("the stored tables: column `{column}` in row {row} is not a JSON object: {source}")]
    Json {
        /// Name of the column.
        column: String,
        /// The first such row.
        row: usize,
        /// Why.
        source: serde_json::Error,
    },
    /// The drawing library refuses.
    #[error("a figure cannot be drawn: {0}")]
    Drawing(String),
    /// A template is none, or asks for what is not there.
    #[error("the template: {0}")]
    Template(String),
    /// A file or folder cannot be written or replaced.
    #[error("{path}: {source}")]
    File {
        /// Which one.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}
