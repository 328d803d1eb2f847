//! How many subdomains, as columns × rows.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// Columns × rows of subdomains, written `4x2`. A bare number n stands for its most square division with at least
/// as many columns as rows: 8 is `4x2`, 25 is `5x5`, 7 is `7x1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Columns, along x.
    pub nx: u32,
    /// Rows, along y.
    pub ny: u32,
}

impl Grid {
    /// One subdomain.
    pub const ONE: Self = Self { nx: 1, ny: 1 };

    /// The most square division of `count` ≥ 1 subdomains.
    pub fn of_count(count: u32) -> Self {
        let ny = (1..=count.isqrt()).rev().find(|ny| count.is_multiple_of(*ny)).unwrap_or(1);
        Self { nx: count / ny, ny }
    }

    /// Number of subdomains.
    pub fn count(self) -> u64 {
        u64::from(self.nx) * u64::from(self.ny)
    }
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.nx, self.ny)
    }
}

impl Serialize for Grid {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Grid {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct GridVisitor;
        impl Visitor<'_> for GridVisitor {
            type Value = Grid;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "a number of subdomains, at least 1, such as 8, or columns x rows such as \"4x2\"",
                )
            }

            fn visit_u64<E: Error>(self, count: u64) -> Result<Grid, E> {
                match u32::try_from(count) {
                    Ok(count) if count > 0 => Ok(Grid::of_count(count)),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Unsigned(count), &self)),
                }
            }

            fn visit_i64<E: Error>(self, count: i64) -> Result<Grid, E> {
                u64::try_from(count)
                    .map_err(|_| E::invalid_value(serde::de::Unexpected::Signed(count), &self))
                    .and_then(|count| self.visit_u64(count))
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Grid, E> {
                text.split_once('x')
                    .and_then(|(nx, ny)| Some(Grid { nx: nx.parse().ok()?, ny: ny.parse().ok()? }))
                    .filter(|grid| grid.count() > 0)
                    .ok_or_else(|| E::invalid_value(serde::de::Unexpected::Str(text), &self))
            }
        }
        deserializer.deserialize_any(GridVisitor)
    }
}

impl JsonSchema for Grid {
    fn schema_name() -> Cow<'static, str> {
        "Grid".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "title": "a number of subdomains such as 8, or columns x rows such as \"4x2\"",
            "anyOf": [
                { "type": "integer", "minimum": 1 },
                { "type": "string", "pattern": "^[1-9][0-9]*x[1-9][0-9]*$" },
            ],
        })
    }
}

#[cfg(test)]
mod tests;
