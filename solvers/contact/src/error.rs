//! Errors of a refused problem, setting or start: the key, the value, what would be accepted.

use thiserror::Error;

/// Why a contact problem makes no sense. Keys are those of the frozen problem file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ProblemError {
    /// A list has another length than the list that it belongs to.
    #[error("`{key}` has {found} values where {expected} are expected")]
    Length {
        /// Key of the list.
        key: &'static str,
        /// Its length.
        found: usize,
        /// The length of the list that it goes with.
        expected: usize,
    },
    /// A value is outside what has a meaning.
    #[error("`{key}[{index}]` is {value}: it must be {expected}")]
    Value {
        /// Key of the list.
        key: &'static str,
        /// Index in the list.
        index: usize,
        /// The value found.
        value: String,
        /// Description of the accepted values.
        expected: String,
    },
}

impl ProblemError {
    /// Accepts a list of `expected` values.
    ///
    /// # Errors
    /// Names `key` otherwise.
    pub fn unless_length<T>(key: &'static str, values: &[T], expected: usize) -> Result<(), Self> {
        let found = values.len();
        if found == expected { Ok(()) } else { Err(Self::Length { key, found, expected }) }
    }

    /// Accepts an item of a list without fault.
    ///
    /// # Errors
    /// Names the key and the value otherwise, and what is expected.
    pub fn of_fault(fault: Option<(&'static str, f64, &'static str)>, index: usize) -> Result<(), Self> {
        let Some((key, value, expected)) = fault else { return Ok(()) };
        Err(Self::Value { key, index, value: format!("{value:?}"), expected: expected.to_owned() })
    }

    /// Accepts a list whose values are all `valid`.
    ///
    /// # Errors
    /// Names `key` and the first value that is not as `expected`.
    pub fn unless_each<T: std::fmt::Debug>(
        key: &'static str,
        values: &[T],
        expected: &str,
        valid: impl Fn(&T) -> bool,
    ) -> Result<(), Self> {
        match values.iter().position(|value| !valid(value)) {
            None => Ok(()),
            Some(index) => {
                let value = format!("{:?}", values[index]);
                Err(Self::Value { key, index, value, expected: expected.to_owned() })
            }
        }
    }
}

/// Reports whether a quantity is positive and finite.
pub fn is_positive(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}

/// Reports whether a quantity is finite and not negative.
pub fn is_not_negative(x: f64) -> bool {
    x >= 0.0 && x.is_finite()
}

/// A number in an error: in full, or with an exponent where that is long.
pub fn shown(x: f64) -> String {
    let (full, exponent) = (format!("{x}"), format!("{x:e}"));
    if full.len() > 12 && exponent.len() < full.len() { exponent } else { full }
}

/// Why a method cannot start: the setting, its value, what would be accepted.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{key}` is {value}: it must be {expected}")]
pub struct SetupError {
    /// Name of the setting.
    pub key: &'static str,
    /// Its value.
    pub value: String,
    /// Description of the accepted values.
    pub expected: String,
}

impl SetupError {
    /// The error of a setting `key` whose `value` is not as `expected`.
    pub fn new(key: &'static str, value: impl std::fmt::Display, expected: impl Into<String>) -> Self {
        let value = value.to_string();
        // 1e200 has 201 digits; none that must stay.
        let long = if value.len() > 24 { value.parse().ok() } else { None };
        Self { key, value: long.map_or(value, shown), expected: expected.into() }
    }

    /// Accepts a `value` that is `valid`.
    ///
    /// # Errors
    /// Names `key` otherwise, and what is `expected`.
    pub fn unless(
        valid: bool,
        key: &'static str,
        value: impl std::fmt::Display,
        expected: impl Into<String>,
    ) -> Result<(), Self> {
        if valid { Ok(()) } else { Err(Self::new(key, value, expected)) }
    }

    /// Accepts a positive finite value.
    ///
    /// # Errors
    /// Names `key` otherwise.
    pub fn unless_positive(key: &'static str, value: f64) -> Result<(), Self> {
        Self::unless(is_positive(value), key, value, "positive and finite")
    }

    /// Accepts a finite value that is not negative.
    ///
    /// # Errors
    /// Names `key` otherwise.
    pub fn unless_not_negative(key: &'static str, value: f64) -> Result<(), Self> {
        Self::unless(is_not_negative(value), key, value, "finite and not negative")
    }
}
