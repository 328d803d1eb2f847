//! Tables and figures, each one a function of stored rows.
//!
//! Each folder uses those before it: `families` (looks of methods), `own` (a style of one's own), `read` (rows, and what is true of them) → `draw` (lines, axes, keys on paper) → `text`
//! (tables, sentences, files) → `charts` (one for each name in [`Chart`]) → `page` (the page, and the folder of a report) → `site` (pages of
//! all that is archived and collected).

mod charts;
mod draw;
mod error;
mod families;
mod own;
mod page;
mod read;
mod site;
#[cfg(test)]
mod tests;
mod text;

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use results::study::Study as Stored;

pub use charts::{Chart, OwnChart, UnknownQuantity};
pub use draw::Formats;
pub use error::ReportError;
pub use families::Mark;
pub use own::{MethodStyle, Style, use_style};
pub use page::{About, Snapshots, made, view};
pub use site::{Archived, Collected, Facts, Hazard, Site, site};
pub use text::{Pick, TableFormat, summary};

use page::{Chapter, replace};
use read::Study;
use text::{File, Kind, Part};

/// Contents of a report.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'w> {
    /// The charts.
    pub charts: &'w [Chart],
    /// The formats of their figures.
    pub formats: Formats,
    /// An earlier study to compare with.
    pub against: Option<&'w Stored>,
}

/// Draws the charts of a study, its table of runs or simulations and its page, and puts their files into the folder
/// `out`. Returns their paths.
///
/// Files that an earlier report left in `out` go, files of anyone else stay.
///
/// # Errors
///
/// If a table lacks a column or a file cannot be written; nothing is replaced before all is drawn.
pub fn report(
    study: &Stored,
    about: &About,
    wanted: Wanted,
    out: &Path,
) -> Result<Vec<PathBuf>, ReportError> {
    let study = Study::from(study);
    let mut chapters = Vec::new();
    if let (Some(Stored::Runs(before)), Study::Problems(after)) = (wanted.against, &study) {
        chapters.push(Chapter::new("against", charts::against(&before.into(), after)));
    }
    let charts = wanted.charts.par_iter().map(|chart| Chapter::of_chart(*chart, &study));
    chapters.extend(charts.collect::<Vec<_>>());
    let rows = text::rows(&study)?;
    chapters.push(Chapter::new(rows.name.clone(), vec![rows]));
    let mut files =
        vec![File::new("index.html".to_owned(), page::page(&study, &chapters, about, wanted.formats)?)];
    let parts: Vec<&Part> = chapters.iter().flat_map(|chapter| &chapter.parts).collect();
    let of_parts = parts.par_iter().map(|part| part.files(wanted.formats));
    files.extend(of_parts.collect::<Result<Vec<_>, _>>()?.into_iter().flatten());
    replace(&files, out)
}

/// Fills a template with numbers of a study: of its rows, of their table, and of the tables of its `charts`; it may include `parts`, by
/// their names.
///
/// # Errors
///
/// If the template is none, or asks for what is not there.
pub fn fill(
    study: &Stored,
    charts: &[Chart],
    template: &str,
    parts: &[(String, String)],
) -> Result<String, ReportError> {
    let read = Study::from(study);
    let rows = text::rows(&read)?;
    let all = std::iter::once(rows).chain(charts.iter().flat_map(|chart| chart.parts(&read)));
    let table = |part: Part| match part.kind {
        Kind::Table(table) => Some((part.name, table.all)),
        Kind::Figure(_) | Kind::Text(_) => None,
    };
    text::fill(study, &all.filter_map(table).collect::<Vec<_>>(), template, parts)
}

/// Some columns and rows of a table that [`report`] makes of a study.
///
/// # Errors
///
/// Names a table or column that is not there, with those that are.
pub fn table(study: &Stored, charts: &[Chart], pick: Pick) -> Result<String, ReportError> {
    let study = Study::from(study);
    let mut parts = vec![text::rows(&study)?];
    // The table of all runs is the one that is asked for most, and needs no chart.
    if parts[0].name != pick.table {
        parts.extend(charts.iter().flat_map(|chart| chart.parts(&study)));
    }
    let mut known = Vec::new();
    for part in &parts {
        match &part.kind {
            Kind::Table(table) if part.name == pick.table => return pick.of(table),
            Kind::Table(_) => known.push(part.name.clone()),
            Kind::Figure(_) | Kind::Text(_) => {}
        }
    }
    let (what, name) = ("table of this study".to_owned(), pick.table.to_owned());
    Err(ReportError::Unknown { what, name, known })
}

/// Draws the figures and tables of one chart, as [`report`] does, without a page.
///
/// # Errors
///
/// Those of [`report`].
pub fn figure(
    study: &Stored,
    chart: Chart,
    formats: Formats,
    out: &Path,
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = Vec::new();
    for part in chart.parts(&Study::from(study)) {
        files.extend(part.files(formats)?);
    }
    replace(&files, out)
}
