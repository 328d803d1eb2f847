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
    /// A row lacks a value, or has one of another kind.
    #[error("the stored tables, row {row}: {why}")]
    Row {
        /// The first such row.
        row: usize,
        /// Which column, and what of it.
        why: serde::de::value::Error,
    },
    /// A picture or a page cannot be drawn.
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
