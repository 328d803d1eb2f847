//! Rows as tables and back. A column is a field, under the name that serde gives it, in the order of the struct; the
//! fields of a struct inside a row are columns of their own. What is undefined (NaN, or left open) is a null.

use ciborium::value::{Error, Value};
use polars::prelude::{AnyValue, Column, DataFrame, DataType, PolarsError, PolarsResult, Series};
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// A field by its name.
type Field = (String, Value);

/// One row per item of `rows`; without any, the columns alone.
///
/// # Errors
///
/// If a row holds what no column can.
pub fn table<'r, Row>(rows: impl IntoIterator<Item = &'r Row>) -> PolarsResult<DataFrame>
where
    Row: Serialize + Default + 'r,
{
    let mut columns: Vec<(String, Option<DataType>, Vec<AnyValue>)> = Vec::new();
    for (name, value) in flat(&Row::default())? {
        columns.push((name, kind(&value)?, Vec::new()));
    }
    let mut height = 0;
    for row in rows {
        height += 1;
        for ((_, dtype, cells), (_, value)) in columns.iter_mut().zip(flat(row)?) {
            if dtype.is_none() {
                *dtype = kind(&value)?;
            }
            cells.push(cell(value)?);
        }
    }
    let column = |(name, dtype, cells): (String, Option<DataType>, Vec<AnyValue>)| {
        // What may be left open is a count.
        let dtype = dtype.unwrap_or(DataType::UInt64);
        Series::from_any_values_and_dtype(name.into(), &cells, &dtype, true).map(Column::from)
    };
    DataFrame::new(height, columns.into_iter().map(column).collect::<PolarsResult<_>>()?)
}

/// A table of `rows`, before whose columns stands `key`: for each row the number of the run or simulation that it is of.
///
/// # Errors
///
/// Those of [`table`].
pub fn keyed<'r, Row>(key: &str, rows: impl IntoIterator<Item = (u64, &'r Row)>) -> PolarsResult<DataFrame>
where
    Row: Serialize + Default + 'r,
{
    let (numbers, rows): (Vec<u64>, Vec<&Row>) = rows.into_iter().unzip();
    let mut table = table(rows)?;
    table.insert_column(0, Column::new(key.into(), numbers))?;
    Ok(table)
}

/// The rows of a table. Columns that a row does not know are left aside; those that it lacks have their defaults, if they
/// have any.
///
/// # Errors
///
/// If a column is missing, or holds something else than its field.
pub fn rows<Row: Serialize + DeserializeOwned + Default + Send>(table: &DataFrame) -> PolarsResult<Vec<Row>> {
    let parts: Vec<Value> = fields(&Row::default())?
        .into_iter()
        .filter(|(_, value)| value.is_map())
        .map(|(name, _)| Value::Text(name))
        .collect();
    let columns = table.columns();
    let row = |index: usize| {
        let mut row = Vec::with_capacity(columns.len() + parts.len());
        for column in columns {
            row.push((Value::Text(column.name().to_string()), value(&column.get(index)?)?));
        }
        // Each part takes its own columns.
        let whole = if parts.is_empty() { Value::Null } else { Value::Map(row.clone()) };
        row.extend(parts.iter().map(|part| (part.clone(), whole.clone())));
        Value::Map(row).deserialized().map_err(|Error::Custom(why)| wrong(&format!("row {index}: {why}")))
    };
    (0..table.height()).into_par_iter().map(row).collect()
}

/// The numbers in the column `key` of a [`keyed`] table.
///
/// # Errors
///
/// If it has none, or a null.
pub fn keys(key: &str, table: &DataFrame) -> PolarsResult<Vec<u64>> {
    let column = table.column(key)?.cast(&DataType::UInt64)?;
    let numbers = column.u64()?.iter().enumerate();
    numbers
        .map(|(row, key_of)| key_of.ok_or_else(|| wrong(&format!("row {row}: `{key}` is empty"))))
        .collect()
}

fn wrong(why: &str) -> PolarsError {
    PolarsError::SchemaMismatch(why.to_owned().into())
}

fn fields(row: &impl Serialize) -> PolarsResult<Vec<Field>> {
    let other = |error: Error| wrong(&error.to_string());
    let Value::Map(entries) = Value::serialized(row).map_err(other)? else {
        return Err(wrong("a row is a struct"));
    };
    let field = |(name, value): (Value, Value)| (name.into_text().unwrap_or_default(), value);
    Ok(entries.into_iter().map(field).collect())
}

/// The fields of a row, with those of the structs in it in their place.
fn flat(row: &impl Serialize) -> PolarsResult<Vec<Field>> {
    let mut flat = Vec::new();
    for (name, value) in fields(row)? {
        if value.is_map() { flat.extend(fields(&value)?) } else { flat.push((name, value)) }
    }
    Ok(flat)
}

/// Returns the values of a row as a text file holds them, each with its column; what is undefined is empty.
///
/// # Errors
///
/// If the row holds what no column can.
pub fn cells(row: &impl Serialize) -> PolarsResult<Vec<(String, String)>> {
    let text = |value: Value| -> PolarsResult<String> {
        Ok(match cell(value)? {
            AnyValue::Null => String::new(),
            AnyValue::Float64(number) => number.to_string(),
            AnyValue::UInt64(count) => count.to_string(),
            AnyValue::StringOwned(text) => text.to_string(),
            other => other.to_string(),
        })
    };
    flat(row)?.into_iter().map(|(name, value)| Ok((name, text(value)?))).collect()
}

/// Table of CSV that grows row by row, so that a program that is killed leaves what it wrote.
pub struct CsvRows(File);

impl CsvRows {
    /// Begins a table, in a file that is not there, with the columns of a row like that of [`cells`].
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn begin(path: &Path, like: Vec<(String, String)>) -> io::Result<Self> {
        let mut file = File::create_new(path)?;
        let names: Vec<String> = like.into_iter().map(|(name, _)| name).collect();
        writeln!(file, "{}", names.join(","))?;
        Ok(Self(file))
    }

    /// Adds rows in one write, so that no half row is left.
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn add(&mut self, rows: impl IntoIterator<Item = Vec<(String, String)>>) -> io::Result<()> {
        let line = |row: Vec<(String, String)>| {
            row.into_iter().map(|(_, value)| value).collect::<Vec<_>>().join(",") + "\n"
        };
        self.0.write_all(rows.into_iter().map(line).collect::<String>().as_bytes())
    }
}

/// Values of a column.
pub enum Values {
    /// Counts and indices; −1 where there is none.
    Counts(Vec<i64>),
    /// Numbers; NaN where one is not defined.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

/// Returns the columns of a table of `rows`, each with its name.
///
/// # Errors
///
/// If a row holds what no column can.
pub fn lists<'r, Row>(rows: impl IntoIterator<Item = &'r Row>) -> PolarsResult<Vec<(String, Values)>>
where
    Row: Serialize + Default + 'r,
{
    let table = table(rows)?;
    let values = |column: &Column| -> PolarsResult<Values> {
        Ok(match column.dtype() {
            DataType::String => {
                Values::Texts(column.str()?.iter().map(|text| text.unwrap_or_default().to_owned()).collect())
            }
            DataType::UInt64 => {
                Values::Counts(column.u64()?.iter().map(|count| count.map_or(-1, u64::cast_signed)).collect())
            }
            _ => {
                let numbers = column.cast(&DataType::Float64)?;
                Values::Numbers(numbers.f64()?.iter().map(|number| number.unwrap_or(f64::NAN)).collect())
            }
        })
    };
    table.columns().iter().map(|column| Ok((column.name().to_string(), values(column)?))).collect()
}

/// The type of a column that holds `value`; unknown of a null.
fn kind(value: &Value) -> PolarsResult<Option<DataType>> {
    Ok(Some(match value {
        Value::Null => return Ok(None),
        Value::Bool(_) => DataType::Boolean,
        Value::Integer(_) => DataType::UInt64,
        Value::Float(_) => DataType::Float64,
        Value::Text(_) => DataType::String,
        Value::Array(_) => DataType::List(Box::new(DataType::Float64)),
        other => return Err(wrong(&format!("no column holds {other:?}"))),
    }))
}

fn cell(value: Value) -> PolarsResult<AnyValue<'static>> {
    Ok(match value {
        Value::Null => AnyValue::Null,
        Value::Bool(truth) => AnyValue::Boolean(truth),
        Value::Integer(count) => AnyValue::UInt64(count.try_into().map_err(|_| wrong("a count is below 0"))?),
        Value::Float(number) if number.is_nan() => AnyValue::Null,
        Value::Float(number) => AnyValue::Float64(number),
        Value::Text(text) => AnyValue::StringOwned(text.into()),
        Value::Array(numbers) => {
            let number =
                |item: &Value| item.as_float().ok_or_else(|| wrong(&format!("no list holds {item:?}")));
            let numbers: Vec<f64> = numbers.iter().map(number).collect::<PolarsResult<_>>()?;
            AnyValue::List(Series::from_iter(numbers))
        }
        other => return Err(wrong(&format!("no column holds {other:?}"))),
    })
}

fn value(cell: &AnyValue) -> PolarsResult<Value> {
    Ok(match cell {
        AnyValue::Null => Value::Null,
        AnyValue::Boolean(truth) => Value::Bool(*truth),
        AnyValue::UInt32(count) => Value::from(*count),
        AnyValue::UInt64(count) => Value::from(*count),
        AnyValue::Float64(number) => Value::from(*number),
        AnyValue::String(text) => Value::from(*text),
        AnyValue::StringOwned(text) => Value::from(text.as_str()),
        AnyValue::List(numbers) => {
            Value::Array(numbers.f64()?.iter().map(|number| number.unwrap_or(f64::NAN).into()).collect())
        }
        other => return Err(wrong(&format!("no field holds {other}"))),
    })
}
