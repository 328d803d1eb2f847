//! A table as the rows of a page.

use polars::prelude::DataFrame;
use serde::Serialize;

use crate::error::ReportError;
use crate::text::{Column, columns};

/// More rows than this are left to the file: a browser would be slow.
const MOST_ROWS: usize = 5000;

/// A text of more letters than this is broken into lines.
const LONG: usize = 28;

#[derive(Serialize)]
pub(crate) struct Rows {
    name: String,
    headings: Vec<Column>,
    /// The rows as HTML.
    body: String,
    shown: usize,
    of: usize,
    notes: Vec<String>,
    /// Headings of the columns by whose values rows are chosen.
    filters: Vec<&'static str>,
    /// Headings of the columns that have a value where a run reached an accuracy.
    accuracies: Vec<String>,
}

impl Rows {
    pub(crate) fn of(name: &str, table: &DataFrame, note: &str) -> Result<Self, ReportError> {
        Self::linked(name, table, note, &|_, _| None)
    }

    /// Makes the rows of a table. `leads` names the page to which a cell leads, if any, by its row and its heading.
    pub(crate) fn linked(
        name: &str,
        table: &DataFrame,
        note: &str,
        leads: &dyn Fn(usize, &str) -> Option<String>,
    ) -> Result<Self, ReportError> {
        let columns = columns(table, MOST_ROWS)?;
        let shown = table.height().min(MOST_ROWS);
        // The whole value, by which a row is sorted: what is written is rounded.
        let floats: Vec<_> = table.columns().iter().map(|column| column.f64().ok()).collect();
        let mut body = String::new();
        for row in 0..shown {
            body += "<tr>";
            for (column, floats) in columns.iter().zip(&floats) {
                match floats.and_then(|floats| floats.get(row)) {
                    Some(value) => body.extend(["<td data-v=\"", &value.to_string(), "\">"]),
                    // Such a text must not push what follows out of sight.
                    None if column.cells[row].chars().count() > LONG => body += "<td class=\"long\">",
                    None => body += "<td>",
                }
                let text = escaped(&column.cells[row]);
                match leads(row, &column.name) {
                    Some(to) => body.extend(["<a href=\"", &escaped(&to), "\">", &text, "</a>"]),
                    None => body += &text,
                }
            }
            body += "\n";
        }
        let notes = note.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect();
        Ok(Self {
            name: name.to_owned(),
            headings: columns,
            body,
            shown,
            of: table.height(),
            notes,
            filters: Vec::new(),
            accuracies: Vec::new(),
        })
    }

    /// Offers a choice by the values of the columns with these headings, and by the accuracy that was reached.
    pub(crate) fn chosen_by(mut self, headings: &[&'static str]) -> Self {
        self.filters = headings.to_vec();
        let names = self.headings.iter().map(|heading| &heading.name);
        self.accuracies = names.filter(|name| name.starts_with("natural map ≤")).cloned().collect();
        self
    }
}

/// Writes a text as HTML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
