//! The table of iterations and work: one row per run, as a table and as text.

use polars::prelude::{AnyValue, DataFrame, PolarsResult};
use results::store::Tables;

use crate::ReportError;
use crate::number::number;

/// What is told of each run.
const COLUMNS: [&str; 19] = [
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
///
/// # Errors
///
/// If the table of runs lacks a column.
pub fn iterations(tables: &Tables) -> Result<DataFrame, ReportError> {
    Ok(tables.runs.select(COLUMNS)?)
}

/// The same table as text, less what a page has no room for; below it, why runs were skipped.
///
/// # Errors
///
/// If the table of runs lacks a column.
pub fn iterations_text(tables: &Tables) -> Result<String, ReportError> {
    let columns = TEXT_COLUMNS
        .iter()
        .map(|(name, heading)| Ok(tables.runs.column(name)?.clone().with_name((*heading).into())))
        .collect::<PolarsResult<Vec<_>>>()?;
    Ok(to_markdown(&DataFrame::new(tables.runs.height(), columns)?)? + &skipped(tables)?)
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

/// A table as Markdown that also reads well on a terminal: numbers to the right, a dash where there is none.
///
/// # Errors
///
/// Those of polars.
pub(crate) fn to_markdown(table: &DataFrame) -> Result<String, ReportError> {
    let mut lines = vec![String::from("|"); table.height() + 2];
    for column in table.columns() {
        let numeric = column.dtype().is_primitive_numeric();
        let mut cells = vec![column.name().to_string()];
        for row in 0..table.height() {
            cells.push(cell(&column.get(row)?));
        }
        let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0).max(3);
        let rule = if numeric { format!("{:->width$}", ":") } else { "-".repeat(width) };
        let pad =
            |cell: &String| if numeric { format!(" {cell:>width$} |") } else { format!(" {cell:<width$} |") };
        lines[0] += &pad(&cells[0]);
        lines[1].extend([" ", rule.as_str(), " |"]);
        for (line, cell) in lines[2..].iter_mut().zip(&cells[1..]) {
            *line += &pad(cell);
        }
    }
    let mut text = lines.join("\n") + "\n";
    if table.height() == 0 {
        text += "\nno such run in this study\n";
    }
    Ok(text)
}

fn cell(value: &AnyValue) -> String {
    match value {
        AnyValue::Null => "–".to_owned(),
        AnyValue::Float64(x) => number(*x, 3),
        AnyValue::String(text) => text.replace('|', "\\|").replace('\n', " "),
        other => other.to_string(),
    }
}
