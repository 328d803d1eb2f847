//! A text with numbers from the rows of a study in it: a template that names runs, so that none is typed.

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Kwargs, Serde};
use minijinja::{Environment, Error, ErrorKind, UndefinedBehavior, Value, context};
use results::Median;
use results::journal::Record;
use results::study::Study;

use crate::error::ReportError;
use crate::read::stored::by_column;
use crate::read::{
    Growth, Kind, Norm, Problems, Standing, Tally, count, growth, kinds, natural_maps, norms, number,
    standings, tallies,
};

/// A run by the names of its columns.
type Row = BTreeMap<String, Value>;

/// Fills a template: `run(problem=…, method=…, …)` is the one row with these values, `runs(…)` all of them, `kinds` the kinds of
/// problem, each with its methods ranked, `tallies` in how many of them each method is first, `growth` what subdomains cost on them, `norms` what LMGC90's norm is worth; the filter `number` writes up to so many digits, `count` groups them by three.
/// A name that is not there is an error.
///
/// # Errors
///
/// If the template is none, asks for what is not in the rows, or a table lacks a column.
pub fn fill(study: &Study, template: &str) -> Result<String, ReportError> {
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
    if let Study::Runs(runs) = study {
        let study = runs.into();
        templates.add_global("kinds", ranked(&study));
        templates.add_global("tallies", counted(&study));
        templates.add_global("growth", grown(&study));
        templates.add_global("norms", worth(&study));
    }
    templates.add_function("run", move |wanted: Kwargs| one(&rows, &wanted));
    templates.add_filter("number", |value: f64, digits: u8| number(value, digits));
    templates.add_filter("count", |value: usize| count(value));
    templates.add_template("text", template).map_err(refused)?;
    templates.get_template("text").and_then(|text| text.render(context! {})).map_err(refused)
}

/// The kinds of problem of a study. Each has `name`, `case`, `grains`, `problems`, how many they are, and `ranked`: for each natural map
/// its `accuracy` and `methods`, the first first. A method has its `label`; `reached`, on how many problems; `low`, `median` and `high`
/// of its seconds there; `worst`, the greatest ratio to the fastest; and `ties`, true of those that the first is not faster than.
fn ranked(study: &Problems) -> Value {
    let method =
        |Standing { label, reached, seconds: Median { low, median, high }, worst, ties, .. }: Standing| context! { label, reached, low, median, high, worst, ties };
    let of_kind = |kind: &Kind| {
        let ranked = |accuracy: f64| {
            let methods: Vec<Value> = standings(&kind.runs, accuracy).into_iter().map(method).collect();
            context! { accuracy, methods }
        };
        let ranked: Vec<Value> = natural_maps(&study.runs).into_iter().map(ranked).collect();
        context! { name => kind.name.clone(), case => kind.case.clone(), grains => kind.grains, problems => kind.problems(), ranked }
    };
    kinds(&study.runs).iter().map(of_kind).collect()
}

/// In how many kinds of problem each method is first at each accuracy: the fields of [`Tally`].
fn counted(study: &Problems) -> Value {
    let of = |Tally { label, accuracy, kinds, alone, first, reached, problems, worst }: Tally| context! { label, accuracy, kinds, alone, first, reached, problems, worst };
    tallies(&kinds(&study.runs), &natural_maps(&study.runs)).into_iter().map(of).collect()
}

/// What subdomains cost over several packings: each has the `case`, the `kind`, the `method`, the `subdomains`, the `measure` and the
/// `accuracy`; `packings`, and on how many of them it is `reached`; and `low`, `median` and `high` of the ratio of iterations.
fn grown(study: &Problems) -> Value {
    let of = |growth: &Growth| {
        let Median { low, median, high } = growth.ratio?;
        Some(context! {
            case => growth.kind.case.clone(),
            kind => growth.kind.name.clone(),
            method => growth.label.clone(),
            subdomains => growth.subdomains,
            measure => growth.measure.name(),
            accuracy => 10f64.powf(growth.log),
            packings => growth.pairs,
            reached => growth.packings,
            low, median, high
        })
    };
    kinds(&study.runs)
        .iter()
        .flat_map(|kind| growth(kind).iter().filter_map(of).collect::<Vec<_>>())
        .collect()
}

/// What LMGC90's norm is worth: the fields of [`Norm`], with the `case`, the `name` and the `grains` of its kind.
fn worth(study: &Problems) -> Value {
    let of =
        |Norm { kind, label, tolerance, packings, met, natural_map: Median { low, median, high } }: Norm| context! { case => kind.case.clone(), name => kind.name.clone(), grains => kind.grains, label, tolerance, packings, met, low, median, high };
    kinds(&study.runs).iter().flat_map(|kind| norms(kind).into_iter().map(of).collect::<Vec<_>>()).collect()
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
