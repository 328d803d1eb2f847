//! Tables and figures, each one a function of stored tables.

mod atlas;
mod axis;
mod canvas;
mod chart;
mod columns;
mod convergence;
mod cost;
mod curve;
mod directions;
mod ending;
mod folder;
mod groups;
mod iterations;
mod legend;
mod number;
mod panels;
mod profiles;
mod rows;
mod sample;
mod scale;
mod series;
mod signs;
mod size;
mod statistics;
mod study;
mod style;
mod subdomains;
mod truth;
mod work_precision;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod sweep_tests;
#[cfg(test)]
mod tests;

use std::io;
use std::path::{Path, PathBuf};

use polars::prelude::{CsvWriter, DataFrame, PolarsError, SerWriter};
use results::store::Tables;
use thiserror::Error;

pub use chart::{Chart, UnknownChart};
pub use iterations::{iterations, iterations_text};

/// Why a report was not made.
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
    /// A file or folder cannot be made or replaced.
    #[error("{path}: {source}")]
    File {
        /// Which one.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// A file of a report: its name and what it holds.
pub(crate) type File = (String, String);

/// Makes the table of iterations and the files of the `charts` of a study, and puts them into the folder `out`.
/// Returns their paths.
///
/// Files that an earlier report left in `out` go, files of anyone else stay.
///
/// # Errors
///
/// If a table lacks a column or a file cannot be written; nothing is replaced before all is drawn.
pub fn report(tables: &Tables, charts: &[Chart], out: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = vec![
        ("iterations.csv".to_owned(), csv(&iterations(tables)?)?),
        ("iterations.md".to_owned(), iterations_text(tables)?),
    ];
    for chart in charts {
        files.extend(chart.files(tables)?);
    }
    folder::replace(&files, out)
}

fn csv(table: &DataFrame) -> Result<String, ReportError> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut table.clone())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A file's name from a problem's or partition's: letters, digits, dot, dash, underscore.
fn file_name(text: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' };
    text.chars().map(safe).collect()
}
