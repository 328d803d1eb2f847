//! The columns of a stored table as vectors; a column that is missing or empty is an error that names it.

use polars::prelude::DataFrame;
use serde_json::{Map, Value};

use crate::error::ReportError;

fn filled<T>(column: &str, values: impl Iterator<Item = Option<T>>) -> Result<Vec<T>, ReportError> {
    let null = |row| ReportError::Null { column: column.to_owned(), row };
    values.enumerate().map(|(row, value)| value.ok_or_else(|| null(row))).collect()
}

pub(super) fn texts(table: &DataFrame, column: &str) -> Result<Vec<String>, ReportError> {
    filled(column, table.column(column)?.str()?.iter().map(|text| text.map(str::to_owned)))
}

pub(super) fn u32s(table: &DataFrame, column: &str) -> Result<Vec<u32>, ReportError> {
    filled(column, table.column(column)?.u32()?.iter())
}

pub(super) fn u64s(table: &DataFrame, column: &str) -> Result<Vec<u64>, ReportError> {
    filled(column, table.column(column)?.u64()?.iter())
}

/// Counts that some rows lack.
pub(super) fn counts(table: &DataFrame, column: &str) -> Result<Vec<Option<u64>>, ReportError> {
    Ok(table.column(column)?.u64()?.iter().collect())
}

pub(super) fn bools(table: &DataFrame, column: &str) -> Result<Vec<bool>, ReportError> {
    filled(column, table.column(column)?.bool()?.iter())
}

pub(super) fn f64s(table: &DataFrame, column: &str) -> Result<Vec<f64>, ReportError> {
    filled(column, table.column(column)?.f64()?.iter())
}

/// A measure may be undefined; a NaN that reached the table means the same as a null.
pub(super) fn measures(table: &DataFrame, column: &str) -> Result<Vec<Option<f64>>, ReportError> {
    Ok(table.column(column)?.f64()?.iter().map(|value| value.filter(|v| !v.is_nan())).collect())
}

/// Lists of numbers.
pub(super) fn lists(table: &DataFrame, column: &str) -> Result<Vec<Vec<f64>>, ReportError> {
    let lists = table.column(column)?.list()?;
    let list = |row: usize| {
        let null = ReportError::Null { column: column.to_owned(), row };
        Ok(lists.get_as_series(row).ok_or(null)?.f64()?.into_no_null_iter().collect())
    };
    (0..table.height()).map(list).collect()
}

/// A column that older studies lack: all its values are then undefined.
pub(super) fn newer(table: &DataFrame, column: &str) -> Result<Vec<Option<f64>>, ReportError> {
    if table.column(column).is_ok() { measures(table, column) } else { Ok(vec![None; table.height()]) }
}

/// Objects of JSON.
pub(super) fn json(table: &DataFrame, column: &str) -> Result<Vec<Map<String, Value>>, ReportError> {
    let not_json = |row, source| ReportError::Json { column: column.to_owned(), row, source };
    let read = |(row, text): (usize, &String)| serde_json::from_str(text).map_err(|e| not_json(row, e));
    texts(table, column)?.iter().enumerate().map(read).collect()
}
