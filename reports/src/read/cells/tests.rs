use polars::df;
use serde::Deserialize;

use super::*;

#[derive(Debug, Deserialize, PartialEq)]
struct Row {
    name: String,
    count: u64,
    value: Option<f64>,
}

#[test]
fn undefined_values_are_none_infinite_ones_are_kept_and_other_columns_do_not_matter() {
    let table = df!(
        "other" => [true, false, true],
        "value" => [Some(f64::INFINITY), Some(f64::NAN), None],
        "count" => [1_u64, 2, 3],
        "name" => ["a", "b", "c"],
    );
    let row = |name: &str, count, value| Row { name: name.into(), count, value };
    let expected = [row("a", 1, Some(f64::INFINITY)), row("b", 2, None), row("c", 3, None)];
    assert_eq!(rows::<Row>(&table.unwrap()).unwrap(), expected);
}

#[test]
fn missing_column_empty_cell_and_wrong_kind_are_errors_that_name_column_and_row() {
    let error = |table: DataFrame| rows::<Row>(&table).unwrap_err().to_string();
    let missing = df!("name" => ["a"], "value" => [1.0]).unwrap();
    assert!(error(missing).contains("row 0: missing field `count`"));
    let empty = df!("name" => [Some("a"), None], "count" => [1_u64, 2]).unwrap();
    assert!(error(empty).contains("row 1: column `name`: invalid type"));
    let wrong = df!("name" => ["a"], "count" => ["many"]).unwrap();
    assert!(error(wrong).contains("row 0: column `count`: invalid type: string \"many\", expected u64"));
}
