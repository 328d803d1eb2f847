//! A text with numbers from the rows of a study in it: a template that names runs, so that none is typed.

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Kwargs, Serde};
use minijinja::{Environment, Error, ErrorKind, UndefinedBehavior, Value, context};
use polars::prelude::{AnyValue, Column, DataFrame};
use results::journal::Record;
use results::study::Study;

use crate::error::ReportError;
use crate::read::stored::by_column;
use crate::read::{count, number};

/// A run by the names of its columns.
type Row = BTreeMap<String, Value>;

/// Fills a template: `run(problem=…, method=…, …)` is the one row with these values, `runs(…)` all of them, `table(NAME)` the rows of
/// one of the `tables`; `{% include NAME %}` takes one of the `parts`; the filter `number` writes up to so many digits, `count` groups them by three. A name that is not there is an
/// error.
///
/// # Errors
///
/// If the template is none, asks for what is not in the rows, or a table lacks a column.
pub(crate) fn fill(
    study: &Study,
    tables: &[(String, DataFrame)],
    template: &str,
    parts: &[(String, String)],
) -> Result<String, ReportError> {
    let refused = |error: Error| ReportError::Template(format!("{error:#}"));
    let records = if let Study::Runs(runs) = study { &runs.records[..] } else { &[] };
    let row = |record: &Record| {
        Ok(by_column(&record.run)?.into_iter().map(|(k, v)| (k, Value::from(Serde(v)))).collect())
    };
    let rows: Vec<Row> = records
        .iter()
        .map(row)
        .collect::<Result<_, serde_json::Error>>()
        .map_err(|error| ReportError::Template(error.to_string()))?;
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    let syntax = SyntaxConfig::builder().trim_blocks(true).keep_trailing_newline(true).build();
    templates.set_syntax(syntax.map_err(refused)?);
    let all = rows.clone();
    templates.add_function("runs", move |wanted: Kwargs| chosen(&all, &wanted).map(Value::from));
    let tables: BTreeMap<String, Value> =
        tables.iter().map(|(name, table)| (name.clone(), rows_of(table))).collect();
    templates.add_function("table", move |name: &str| {
        let known = || tables.keys().cloned().collect::<Vec<_>>().join(", ");
        let unknown =
            || Error::new(ErrorKind::InvalidOperation, format!("no table `{name}`: there are {}", known()));
        tables.get(name).cloned().ok_or_else(unknown)
    });
    templates.add_function("run", move |wanted: Kwargs| one(&rows, &wanted));
    templates.add_filter("number", |value: f64, digits: u8| number(value, digits));
    templates.add_filter("count", |value: usize| count(value));
    for (name, part) in parts {
        templates.add_template(name, part).map_err(refused)?;
    }
    templates.add_template("text", template).map_err(refused)?;
    templates.get_template("text").and_then(|text| text.render(context! {})).map_err(refused)
}

/// The rows of a table by the names of their columns, numbers as they are.
fn rows_of(table: &DataFrame) -> Value {
    let cell = |column: &Column, row: usize| match column.get(row) {
        Ok(AnyValue::Boolean(is)) => Value::from(is),
        Ok(value) if value.is_integer() => Value::from(value.extract::<i64>()),
        Ok(value) => value.get_str().map_or_else(|| Value::from(value.extract::<f64>()), Value::from),
        Err(_) => Value::UNDEFINED,
    };
    let row = |row: usize| -> Row {
        table.columns().iter().map(|column| (column.name().to_string(), cell(column, row))).collect()
    };
    (0..table.height()).map(row).map(Value::from).collect()
}

fn chosen(rows: &[Row], wanted: &Kwargs) -> Result<Vec<Value>, Error> {
    let mut values: Vec<(String, Value)> = Vec::new();
    for key in wanted.args() {
        if rows.first().is_some_and(|row| !row.contains_key(key)) {
            return Err(Error::new(ErrorKind::InvalidOperation, format!("runs have no column `{key}`")));
        }
        values.push((key.to_owned(), wanted.get(key)?));
    }
    let fits = |row: &&Row| values.iter().all(|(key, value)| row.get(key) == Some(value));
    Ok(rows.iter().filter(fits).cloned().map(Value::from).collect())
}

fn one(rows: &[Row], wanted: &Kwargs) -> Result<Value, Error> {
    let mut found = chosen(rows, wanted)?;
    if found.len() == 1 {
        return Ok(found.remove(0));
    }
    let names = wanted.args().map(|key| Ok(format!("{key}={}", wanted.get::<Value>(key)?)));
    let names: Vec<String> = names.collect::<Result<_, Error>>()?;
    let what = format!("{} runs have {}: name one", found.len(), names.join(", "));
    Err(Error::new(ErrorKind::InvalidOperation, what))
}

#[cfg(test)]
mod tests;
