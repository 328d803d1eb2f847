//! Numbers of subdomains, as columns × rows, and layers in space.

use schemars::JsonSchema;
use serde::de::value::Error;
use serde::de::{Error as _, Unexpected};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Columns × rows of subdomains, written `4x2`, and in space layers, `4x2x2`. A bare number n stands for its most square division
/// with at least as many columns as rows, in one layer: 8 is `4x2`, 25 is `5x5`, 7 is `7x1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(try_from = "Written")]
#[schemars(
    inline,
    title = "a number of subdomains such as 8, or columns x rows such as \"4x2\", in space x layers such as \"4x2x2\""
)]
pub struct Grid {
    /// Columns, along x.
    pub nx: u32,
    /// Rows, along y.
    pub ny: u32,
    /// Layers, along z.
    pub nz: u32,
}

impl Grid {
    /// One subdomain.
    pub const ONE: Self = Self::of(1, 1);

    /// Columns × rows in one layer.
    pub const fn of(nx: u32, ny: u32) -> Self {
        Self { nx, ny, nz: 1 }
    }

    /// The most square division of `count` ≥ 1 subdomains.
    pub fn of_count(count: u32) -> Self {
        let ny = (1..=count.isqrt()).rev().find(|ny| count.is_multiple_of(*ny)).unwrap_or(1);
        Self::of(count / ny, ny)
    }

    /// Number of subdomains.
    pub fn count(self) -> u64 {
        u64::from(self.nx) * u64::from(self.ny) * u64::from(self.nz)
    }
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.nx, self.ny)?;
        if self.nz == 1 { Ok(()) } else { write!(f, "x{}", self.nz) }
    }
}

impl Serialize for Grid {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Representation of a grid in a file; it admits a number that is no count, so that an error names it.
#[derive(Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a number of subdomains, at least 1, such as 8, or columns x rows such as \"4x2\", in space x layers such as \"4x2x2\""
)]
enum Written {
    Count(#[schemars(range(min = 1))] i64),
    #[schemars(skip)]
    Number(f64),
    Columns(#[schemars(regex(pattern = r"^[1-9][0-9]*x[1-9][0-9]*(x[1-9][0-9]*)?$"))] String),
}

impl TryFrom<Written> for Grid {
    type Error = Error;

    fn try_from(written: Written) -> Result<Self, Error> {
        let grid = match &written {
            Written::Count(count) => u32::try_from(*count).ok().map(Self::of_count),
            Written::Number(_) => None,
            Written::Columns(text) => {
                let numbers: Option<Vec<u32>> = text.split('x').map(|number| number.parse().ok()).collect();
                match numbers.as_deref() {
                    Some(&[nx, ny]) => Some(Self::of(nx, ny)),
                    Some(&[nx, ny, nz]) => Some(Self { nx, ny, nz }),
                    _ => None,
                }
            }
        };
        let found = match &written {
            Written::Count(count) => Unexpected::Signed(*count),
            Written::Number(number) => Unexpected::Float(*number),
            Written::Columns(text) => Unexpected::Str(text),
        };
        let expected = "a number of subdomains, at least 1, such as 8, or columns x rows such as \"4x2\", in space x layers such as \"4x2x2\"";
        grid.filter(|grid| grid.count() > 0).ok_or_else(|| Error::invalid_value(found, &expected))
    }
}

#[cfg(test)]
mod tests;
