//! Output of a chart: figures, tables and sentences, and the files that they become.

use std::ops::Deref;

use polars::prelude::{DataFrame, PolarsResult};
use results::columns::table as stored;
use serde::Serialize;

use crate::draw::{Formats, pdf, png};
use crate::error::ReportError;
use crate::read::counted;
use crate::text::table;

/// A file of a report: its name and what it holds.
pub(crate) struct File {
    pub(crate) name: String,
    pub(crate) content: Vec<u8>,
}

impl File {
    pub(crate) fn new(name: String, content: impl Into<Vec<u8>>) -> Self {
        Self { name, content: content.into() }
    }
}

/// Part of a report; its name is that of its files.
pub(crate) struct Part {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// Caption of a figure, where it is not that of its chart.
    pub(crate) caption: Option<String>,
    /// True where its page shows it; else the page names its files alone, since another part shows the same.
    pub(crate) on_page: bool,
}

pub(crate) enum Kind {
    /// A drawing, as SVG.
    Figure(String),
    /// A table, and what its columns mean.
    Table(Table),
    /// Sentences from rows, one a line.
    Text(String),
}

/// A table of a report.
pub(crate) struct Table {
    /// All columns, for other programs.
    pub(crate) all: DataFrame,
    /// The columns that a page has room for, under the headings there.
    pub(crate) shown: DataFrame,
    pub(crate) note: String,
}

impl Part {
    pub(crate) fn new(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), kind, caption: None, on_page: true }
    }

    pub(crate) fn figure(name: impl Into<String>, svg: String) -> Self {
        Self::new(name, Kind::Figure(svg))
    }

    pub(crate) fn table(name: impl Into<String>, all: DataFrame, note: impl Into<String>) -> Self {
        let table = Table { shown: all.clone(), all, note: note.into() };
        Self::new(name, Kind::Table(table))
    }

    pub(crate) fn text(name: impl Into<String>, text: String) -> Self {
        Self::new(name, Kind::Text(text))
    }

    /// A figure with a caption of its own.
    pub(crate) fn captioned(self, caption: impl Into<String>) -> Self {
        Self { caption: Some(caption.into()), ..self }
    }

    /// A part that repeats others: a file, and no place on the page.
    pub(crate) fn beside_the_page(self) -> Self {
        Self { on_page: false, ..self }
    }

    /// Endings of its files: a figure in the formats that are wanted, a table as CSV, Markdown and LaTeX, sentences as they are.
    pub(crate) fn endings(&self, formats: Formats) -> Vec<&'static str> {
        match &self.kind {
            Kind::Figure(_) => {
                let more =
                    [("pdf", formats.pdf), ("png", formats.png)].into_iter().filter(|(_, wanted)| *wanted);
                std::iter::once("svg").chain(more.map(|(ending, _)| ending)).collect()
            }
            Kind::Table(_) => vec!["csv", "md", "tex"],
            Kind::Text(_) => vec!["md"],
        }
    }

    /// Its files.
    pub(crate) fn files(&self, formats: Formats) -> Result<Vec<File>, ReportError> {
        let file = |ending| {
            let content = match (&self.kind, ending) {
                (Kind::Figure(svg), "pdf") => pdf(svg)?,
                (Kind::Figure(svg), "png") => png(svg)?,
                (Kind::Table(Table { all, .. }), "csv") => table::csv(all)?.into(),
                (Kind::Table(Table { shown, .. }), "tex") => table::latex(shown)?.into(),
                (Kind::Table(Table { shown, note, .. }), _) => (table::markdown(shown)? + note).into(),
                (Kind::Figure(text) | Kind::Text(text), _) => text.clone().into(),
            };
            Ok(File::new(format!("{}.{ending}", self.name), content))
        };
        self.endings(formats).into_iter().map(file).collect()
    }
}

/// Said in place of a figure that would show too many lines.
pub(crate) fn too_many(name: impl Into<String>, title: &str, lines: usize) -> Part {
    let lines = counted(lines, "line");
    nothing(name, title, &format!("{lines} are too many for a figure; the tables have them all"))
}

/// A sentence in place of a figure that would show nothing.
pub(crate) fn nothing(name: impl Into<String>, title: &str, why: &str) -> Part {
    Part::text(name, format!("{title}: {why}.\n"))
}

/// A table whose columns are values of the same rows.
pub(crate) fn frame(columns: PolarsResult<DataFrame>) -> DataFrame {
    columns.expect("all columns have a value for each row")
}

/// A table with a row for each of `rows`: the columns `names`, from `own` if it has them, else as they are stored.
pub(crate) fn chosen<'r, R: Deref<Target: Default + Serialize> + 'r>(
    rows: impl IntoIterator<Item = &'r R>,
    names: &str,
    own: PolarsResult<DataFrame>,
) -> DataFrame {
    let choose = || {
        let mut all = stored(rows.into_iter().map(|row| &**row))?;
        for column in own?.columns() {
            all.with_column(column.clone())?;
        }
        all.select(names.split_whitespace())
    };
    frame(choose())
}
