//! Counts as columns × rows.

use super::*;
use serde::de::IntoDeserializer;

#[test]
fn bare_count_is_divided_as_squarely_as_it_goes() {
    for (count, nx, ny) in [(1, 1, 1), (2, 2, 1), (4, 2, 2), (7, 7, 1), (8, 4, 2), (25, 5, 5), (64, 8, 8)] {
        assert_eq!(Grid::of_count(count), Grid::of(nx, ny));
    }
}

#[test]
fn counts_and_columns_are_read_and_what_is_refused_is_named() {
    let columns = |text: &'static str| -> Result<Grid, Error> { Grid::deserialize(text.into_deserializer()) };
    let count = |count: i64| -> Result<Grid, Error> { Grid::deserialize(count.into_deserializer()) };
    assert_eq!(columns("4x2"), Ok(Grid::of(4, 2)));
    assert_eq!(count(8), Ok(Grid::of(4, 2)));
    assert_eq!(columns("4x2x3"), Ok(Grid { nz: 3, ..Grid::of(4, 2) }));
    assert_eq!(Grid { nz: 3, ..Grid::of(4, 2) }.to_string(), "4x2x3");
    for refused in ["0x3", "ax2", "4", "4x2x0", "4x2x1x1"] {
        let error = columns(refused).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("invalid value: string {refused:?}, expected a number")),
            "{error}"
        );
    }
    for refused in [0, -3, 1 << 40] {
        let error = count(refused).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("invalid value: integer `{refused}`, expected a number")),
            "{error}"
        );
    }
}

#[test]
fn number_that_is_no_count_is_named_and_not_in_the_schema() {
    let read: Result<Grid, Error> = Grid::deserialize(1.5.into_deserializer());
    let error = read.unwrap_err().to_string();
    assert!(error.starts_with("invalid value: floating point `1.5`, expected a number of"), "{error}");
    let schema = schemars::schema_for!(Grid);
    assert_eq!(schema.as_value()["anyOf"].as_array().map(Vec::len), Some(2));
}
