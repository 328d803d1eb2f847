//! Tables and figures, each one a function of stored tables.

mod against;
mod atlas;
mod atlas_in_time;
mod axis;
mod canvas;
mod chart;
mod columns;
mod convergence;
mod cost;
mod critical_path;
mod curve;
mod directions;
mod ending;
mod failures;
mod fill;
mod folder;
mod found;
mod groups;
mod iterations;
mod legend;
mod number;
mod page;
mod panels;
mod part;
mod picture;
mod profiles;
mod relaxation;
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
mod table;
mod through_time;
mod trajectory;
mod truth;
mod viewer;
mod weak;
mod work_precision;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod fixture_in_time;
#[cfg(test)]
mod sweep_tests;
#[cfg(test)]
mod tests;

use std::io;
use std::path::{Path, PathBuf};

use polars::prelude::PolarsError;
use rayon::prelude::*;
use results::simulation::SimulationTables;
use results::store::Tables;
use thiserror::Error;

pub use chart::{Chart, UnknownChart};
pub use fill::fill;
pub use folder::made;
pub use iterations::iterations_text;
pub use page::view;
pub use picture::Formats;
pub use through_time::simulations_text;
pub use viewer::Filmed;

use page::Chapter;
use part::{File, Part};

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
    /// A template is none, or asks for what is not there.
    #[error("the template: {0}")]
    Template(String),
    /// A file or folder cannot be made or replaced.
    #[error("{path}: {source}")]
    File {
        /// Which one.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// The tables of a study.
#[derive(Clone, Copy, Debug)]
pub enum StudyTables<'t> {
    /// Of runs on problems.
    Problems(&'t Tables),
    /// Of simulations.
    Simulations(&'t SimulationTables),
}

impl<'t> From<&'t Tables> for StudyTables<'t> {
    fn from(tables: &'t Tables) -> Self {
        Self::Problems(tables)
    }
}

impl<'t> From<&'t SimulationTables> for StudyTables<'t> {
    fn from(tables: &'t SimulationTables) -> Self {
        Self::Simulations(tables)
    }
}

/// What a report says of its study beside the rows.
#[derive(Clone, Debug)]
pub struct About {
    /// Name of the study.
    pub name: String,
    /// What it asks, in a sentence.
    pub why: String,
    /// The arguments of `gravel bench` that make it.
    pub bench: String,
    /// The arguments of `gravel report` and `gravel figure` that draw it, where they can.
    pub draw: Option<String>,
}

/// What a report is made of.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'w> {
    /// The charts.
    pub charts: &'w [Chart],
    /// The formats of their figures.
    pub formats: Formats,
    /// An earlier study to compare with.
    pub against: Option<&'w Tables>,
}

/// Makes the table of runs or simulations, the charts of a study and its page, and puts their files into the folder
/// `out`. Returns their paths.
///
/// Files that an earlier report left in `out` go, files of anyone else stay.
///
/// # Errors
///
/// If a table lacks a column or a file cannot be written; nothing is replaced before all is drawn.
pub fn report<'t>(
    tables: impl Into<StudyTables<'t>>,
    about: &About,
    wanted: Wanted,
    out: &Path,
) -> Result<Vec<PathBuf>, ReportError> {
    let tables = tables.into();
    let mut chapters = Vec::new();
    if let (Some(before), StudyTables::Problems(tables)) = (wanted.against, tables) {
        chapters.push(Chapter::new("against", against::parts(before, tables)?));
    }
    let charts = wanted.charts.par_iter().map(|chart| Chapter::of_chart(*chart, tables));
    chapters.extend(charts.collect::<Result<Vec<_>, _>>()?);
    chapters.push(match tables {
        StudyTables::Problems(tables) => Chapter::new("iterations", vec![iterations::part(tables)?]),
        StudyTables::Simulations(tables) => Chapter::new("simulations", vec![through_time::part(tables)?]),
    });
    let mut files = vec![File::new("index.html".to_owned(), page::page(tables, &chapters, about)?)];
    let parts: Vec<&Part> = chapters.iter().flat_map(|chapter| &chapter.parts).collect();
    let of_parts = parts.par_iter().map(|part| part.files(wanted.formats));
    files.extend(of_parts.collect::<Result<Vec<_>, _>>()?.into_iter().flatten());
    folder::replace(&files, out)
}

/// Makes the figures and tables of one chart, as [`report`] does, without a page.
///
/// # Errors
///
/// Those of [`report`].
pub fn figure<'t>(
    tables: impl Into<StudyTables<'t>>,
    chart: Chart,
    formats: Formats,
    out: &Path,
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = Vec::new();
    for part in chart.parts(tables.into())? {
        files.extend(part.files(formats)?);
    }
    folder::replace(&files, out)
}

/// A file's name from a problem's or partition's: letters, digits, dot, dash, underscore.
fn file_name(text: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' };
    text.chars().map(safe).collect()
}
