//! Columns of names: each a text in files, one of a few values in the program.

use contact::Measure;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

/// A value that a column holds by its name.
pub trait Name: Copy + 'static {
    /// The column.
    const COLUMN: &'static str;

    /// Returns every value, in the order in which errors list them.
    fn all() -> impl Iterator<Item = Self>;

    /// Returns the name in files.
    fn name(self) -> &'static str;
}

/// The measure that is asked to stop a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StopOn(pub Measure);

/// The working measure.
impl Default for StopOn {
    fn default() -> Self {
        Self(Measure::NaturalMap)
    }
}

impl Name for StopOn {
    const COLUMN: &'static str = "stop_on";

    fn all() -> impl Iterator<Item = Self> {
        Measure::ALL.into_iter().map(Self)
    }

    fn name(self) -> &'static str {
        self.0.name()
    }
}

pub(crate) fn serialize<N: Name, S: Serializer>(value: &N, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(value.name())
}

pub(crate) fn deserialize<'de, N: Name, D: Deserializer<'de>>(deserializer: D) -> Result<N, D::Error> {
    let name = String::deserialize(deserializer)?;
    let unknown = || {
        let known: Vec<&str> = N::all().map(N::name).collect();
        D::Error::custom(format!("`{}` is \"{name}\": it must be one of {}", N::COLUMN, known.join(", ")))
    };
    N::all().find(|value| value.name() == name).ok_or_else(unknown)
}
