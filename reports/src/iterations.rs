//! The table of iterations and work: one row per run, as a table and as text.

use polars::prelude::{DataFrame, PolarsResult};
use results::store::Tables;

use crate::ReportError;
use crate::part::{Kind, Part, Table};
use crate::table::markdown;

/// What is told of each run.
const COLUMNS: [&str; 20] = [
    "problem",
    "method",
    "variant",
    "subdomains",
    "status",
    "iterations_to_zeta_1e_3",
    "iterations_to_zeta_1e_4",
    "iterations_to_natural_map_1e_2",
    "iterations_to_natural_map_1e_4",
    "iterations",
    "contact_updates",
    "delassus_products",
    "triangular_solve_entries",
    "factorisations",
    "setup_s",
    "iterating_s",
    "natural_map",
    "velocity_error",
    "reason",
    "id",
];

/// What of it a page is wide enough for, with the headings there.
const TEXT_COLUMNS: [(&str, &str); 11] = [
    ("problem", "problem"),
    ("method", "method"),
    ("variant", "variant"),
    ("status", "status"),
    ("iterations_to_zeta_1e_3", "ζ ≤ 10⁻³"),
    ("iterations_to_zeta_1e_4", "ζ ≤ 10⁻⁴"),
    ("iterations_to_natural_map_1e_2", "natural map ≤ 10⁻²"),
    ("iterations_to_natural_map_1e_4", "≤ 10⁻⁴"),
    ("iterations", "iterations"),
    ("iterating_s", "seconds"),
    ("velocity_error", "error at the end"),
];

/// Iterations to each accuracy, counted work and seconds, one row per run in the order of the study.
pub(crate) fn part(tables: &Tables) -> Result<Part, ReportError> {
    Ok(Part { name: "iterations".to_owned(), kind: Kind::Table(table(tables)?) })
}

/// The same table as text, less what a page has no room for; below it, why runs were skipped.
///
/// # Errors
///
/// If the table of runs lacks a column.
pub fn iterations_text(tables: &Tables) -> Result<String, ReportError> {
    let Table { shown, note, .. } = table(tables)?;
    Ok(markdown(&shown)? + &note)
}

fn table(tables: &Tables) -> Result<Table, ReportError> {
    let all = tables.runs.select(COLUMNS)?;
    let columns = TEXT_COLUMNS
        .iter()
        .map(|(name, heading)| Ok(all.column(name)?.clone().with_name((*heading).into())))
        .collect::<PolarsResult<Vec<_>>>()?;
    let shown = DataFrame::new(all.height(), columns)?;
    Ok(Table { all, shown, note: skipped(tables)? })
}

/// A line for each run that was skipped.
fn skipped(tables: &Tables) -> Result<String, ReportError> {
    let text = |name| Ok::<_, ReportError>(tables.runs.column(name)?.str()?);
    let (problem, method, variant) = (text("problem")?, text("method")?, text("variant")?);
    let (status, reason) = (text("status")?, text("reason")?);
    let line = |row: usize| {
        let [problem, method, variant, reason] =
            [problem, method, variant, reason].map(|column| column.get(row).unwrap_or_default());
        format!("\nskipped: {} on {problem}: {reason}\n", format!("{method} {variant}").trim_end())
    };
    Ok((0..tables.runs.height()).filter(|row| status.get(*row) == Some("skipped")).map(line).collect())
}
