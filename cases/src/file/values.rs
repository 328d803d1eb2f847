//! Numbers of files, refused by key and value.

use contact::{is_not_negative, is_positive, shown};

/// A number of a file: its key, its value, whether that is valid, and what is expected.
pub(crate) type Number<'k> = (&'k str, f64, bool, &'k str);

/// A number that must be positive and finite.
pub(crate) fn positive(key: &str, value: f64) -> Number<'_> {
    (key, value, is_positive(value), "positive and finite")
}

/// A number that must be finite and not negative.
pub(crate) fn not_negative(key: &str, value: f64) -> Number<'_> {
    (key, value, is_not_negative(value), "finite and not negative")
}

/// Refuses the first number of a `table` that is not valid.
pub(crate) fn check<'k>(table: &str, numbers: impl IntoIterator<Item = Number<'k>>) -> Result<(), String> {
    match numbers.into_iter().find(|(_, _, valid, _)| !valid) {
        Some((key, value, _, expected)) => {
            Err(format!("`{table}.{key}` is {}: it must be {expected}", shown(value)))
        }
        None => Ok(()),
    }
}

/// Refuses a number that is not finite in the value of a `key`, or in what it holds.
pub(crate) fn check_finite(key: &str, value: &toml::Value) -> Result<(), String> {
    match value {
        toml::Value::Float(x) if !x.is_finite() => Err(format!("`{key}` is {x}: it must be finite")),
        toml::Value::Array(items) => {
            let mut items = items.iter().enumerate();
            items.try_for_each(|(index, item)| check_finite(&format!("{key}[{index}]"), item))
        }
        toml::Value::Table(table) => {
            table.iter().try_for_each(|(name, value)| check_finite(&format!("{key}.{name}"), value))
        }
        _ => Ok(()),
    }
}
