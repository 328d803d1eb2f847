//! Tables and figures, each one a function of stored tables.

mod axis;
mod canvas;
mod convergence;
mod curve;
mod iterations;
mod legend;
mod number;
mod rows;
mod sample;
mod style;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod tests;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use polars::prelude::{CsvWriter, DataFrame, PolarsError, SerWriter};
use results::store::Tables;
use tempfile::TempDir;
use thiserror::Error;

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

/// Makes all tables and figures of a study in the folder `out`, and returns their paths.
///
/// A file of the same name is replaced at once; files of other names stay.
///
/// # Errors
///
/// If a table lacks a column or a file cannot be written; nothing is replaced before all is drawn.
pub fn paper(tables: &Tables, out: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let table = iterations(tables)?;
    let mut files = vec![
        ("iterations.csv".to_owned(), csv(&table)?),
        ("iterations.md".to_owned(), iterations_text(tables)?.into_bytes()),
    ];
    let figures = convergence::figures(tables)?.into_iter().chain(sample::figures(tables)?);
    files.extend(figures.map(|(name, svg)| (format!("{name}.svg"), svg.into_bytes())));
    replace(&files, out)
}

fn csv(table: &DataFrame) -> Result<Vec<u8>, ReportError> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut table.clone())?;
    Ok(bytes)
}

/// Writes the files beside their place and renames them, so that no reader meets half a file.
fn replace(files: &[(String, Vec<u8>)], out: &Path) -> Result<Vec<PathBuf>, ReportError> {
    fs::create_dir_all(out).map_err(at(out))?;
    let drafts = TempDir::with_prefix_in(".unfinished-", out).map_err(at(out))?;
    let draft = |name: &str| drafts.path().join(name);
    for (name, bytes) in files {
        fs::write(draft(name), bytes).map_err(at(&draft(name)))?;
    }
    let replace_one = |(name, _): &(String, Vec<u8>)| {
        let path = out.join(name);
        fs::rename(draft(name), &path).map_err(at(&path))?;
        Ok(path)
    };
    files.iter().map(replace_one).collect()
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    |source| ReportError::File { path, source }
}

/// A file's name from a problem's or partition's: letters, digits, dot, dash, underscore.
fn file_name(text: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' };
    text.chars().map(safe).collect()
}
