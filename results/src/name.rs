//! Columns of names: each a text in files, one of a few values in the program.

use contact::Measure;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

/// A value that a column holds by its name.
pub trait Name: Copy + PartialEq + 'static {
    /// The column.
    const COLUMN: &'static str;

    /// Every value with its name in files, in the order in which errors list them.
    const NAMES: &'static [(Self, &'static str)];

    /// Returns the name in files.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(value, _)| *value == self).map_or("", |(_, name)| name)
    }
}

/// Declares an enum of values with names in files, and its [`Name`].
macro_rules! names {
    ($(#[$of:meta])* $name:ident in $column:literal { $($(#[$each:meta])* $value:ident = $text:literal,)+ }) => {
        $(#[$of])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            $($(#[$each])* $value,)+
        }

        impl $crate::name::Name for $name {
            const COLUMN: &'static str = $column;
            const NAMES: &'static [(Self, &'static str)] = &[$((Self::$value, $text)),+];
        }
    };
}
pub(crate) use names;

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

    const NAMES: &'static [(Self, &'static str)] = &{
        let mut names = [(Self(Measure::NaturalMap), ""); Measure::ALL.len()];
        let mut k = 0;
        while k < names.len() {
            names[k] = (Self(Measure::ALL[k]), Measure::ALL[k].name());
            k += 1;
        }
        names
    };
}

pub(crate) fn serialize<N: Name, S: Serializer>(value: &N, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(value.name())
}

pub(crate) fn deserialize<'de, N: Name, D: Deserializer<'de>>(deserializer: D) -> Result<N, D::Error> {
    let name = String::deserialize(deserializer)?;
    let unknown = || {
        let known: Vec<&str> = N::NAMES.iter().map(|(_, name)| *name).collect();
        D::Error::custom(format!("`{}` is \"{name}\": it must be one of {}", N::COLUMN, known.join(", ")))
    };
    N::NAMES.iter().find(|(_, known)| *known == name).map(|(value, _)| *value).ok_or_else(unknown)
}
