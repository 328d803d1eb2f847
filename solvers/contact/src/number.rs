//! Numbers in JSON, which has none for what is undefined or infinite: NaN is null, the infinities are texts. For `with` of
//! serde; formats that are not for people have the numbers as they are.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Representation of a number in the file.
#[derive(Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number, null, \"inf\" or \"-inf\"")]
enum Written {
    Number(f64),
    Infinite(Infinite),
    Undefined,
}

#[derive(Serialize, Deserialize)]
enum Infinite {
    #[serde(rename = "inf")]
    Above,
    #[serde(rename = "-inf")]
    Below,
}

/// Writes a number.
///
/// # Errors
/// Those of the format.
pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    let written = match *value {
        value if !serializer.is_human_readable() => Written::Number(value),
        value if value.is_nan() => Written::Undefined,
        f64::INFINITY => Written::Infinite(Infinite::Above),
        f64::NEG_INFINITY => Written::Infinite(Infinite::Below),
        value => Written::Number(value),
    };
    written.serialize(serializer)
}

/// Reads a number.
///
/// # Errors
/// Where there is something else.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(match Written::deserialize(deserializer)? {
        Written::Number(value) => value,
        Written::Infinite(Infinite::Above) => f64::INFINITY,
        Written::Infinite(Infinite::Below) => f64::NEG_INFINITY,
        Written::Undefined => f64::NAN,
    })
}

/// Lists of such numbers.
pub mod list {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    #[serde(transparent)]
    struct Number(#[serde(with = "super")] f64);

    /// Writes a list of numbers.
    ///
    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(values.iter().map(|value| Number(*value)))
    }

    /// Reads a list of numbers.
    ///
    /// # Errors
    /// Where there is something else.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
        let values: Vec<Number> = Vec::deserialize(deserializer)?;
        Ok(values.into_iter().map(|value| value.0).collect())
    }
}
