//! Some columns and rows of a table of a report, in one of its formats.

use std::collections::BTreeSet;

use polars::prelude::{BooleanChunked, Column, DataFrame, NewChunkedArray};
use wildmatch::WildMatch;

use crate::error::ReportError;
use crate::text::{Table, table};

/// Selection from a table, and its format.
#[derive(Clone, Copy, Debug)]
pub struct Pick<'p> {
    /// Name of the table: that of its files.
    pub table: &'p str,
    /// Its columns, by their names in the CSV file or their headings; all that a page shows if there are none.
    pub columns: &'p [String],
    /// Columns and patterns, in which `*` stands for any text: rows in which all match.
    pub rows: &'p [(String, String)],
    /// The format.
    pub format: TableFormat,
}

/// A format of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Every digit.
    Csv,
    /// For people.
    Markdown,
    /// For papers.
    Latex,
}

impl Pick<'_> {
    /// The text of what is wanted of `from`.
    pub(crate) fn of(&self, from: &Table) -> Result<String, ReportError> {
        let mut rows = vec![true; from.all.height()];
        for (name, pattern) in self.rows {
            let (column, wanted) = (self.column(from, name)?, WildMatch::new(pattern));
            let mut known = BTreeSet::new();
            for (i, chosen) in rows.iter_mut().enumerate().filter(|(_, chosen)| **chosen) {
                let value = column.get(i)?;
                // Nothing where there is none, as in its CSV file.
                let value = if value.is_null() { String::new() } else { value.str_value().into_owned() };
                *chosen = wanted.matches(&value);
                known.insert(value);
            }
            if !known.is_empty() && !rows.contains(&true) {
                let what = format!("row of table `{}` that matches", self.table);
                let rest = (known.len() > NAMED).then(|| "…".to_owned());
                let known = known.into_iter().take(NAMED).chain(rest).collect();
                return Err(ReportError::Unknown { what, name: format!("{name}={pattern}"), known });
            }
        }
        let columns = self.columns.iter().map(|name| self.column(from, name).cloned());
        let columns: Vec<Column> = columns.collect::<Result<_, _>>()?;
        let wanted =
            if columns.is_empty() { from.shown.clone() } else { DataFrame::new(from.all.height(), columns)? };
        let wanted = wanted.filter(&BooleanChunked::from_slice("chosen".into(), &rows))?;
        match self.format {
            TableFormat::Csv => table::csv(&wanted),
            TableFormat::Markdown => table::markdown(&wanted),
            TableFormat::Latex => table::latex(&wanted),
        }
    }

    fn column<'t>(&self, from: &'t Table, name: &str) -> Result<&'t Column, ReportError> {
        from.all.column(name).or_else(|_| from.shown.column(name)).map_err(|_| ReportError::Unknown {
            what: format!("column of table `{}`", self.table),
            name: name.to_owned(),
            known: from.all.get_column_names().into_iter().map(ToString::to_string).collect(),
        })
    }
}

/// Greatest number of values that an error names.
const NAMED: usize = 20;
