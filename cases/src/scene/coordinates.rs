//! Lists of numbers whose last, along z, spheres have and discs have not.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A list of `N` numbers of spheres, and of one fewer of discs, whose z is 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Coordinates<const N: usize> {
    list: [f64; N],
    in_space: bool,
}

/// A point or a vector, as [x, y] or [x, y, z].
pub type Point = Coordinates<3>;

/// A time (s) and the velocity then, as [t, `v_x`, `v_y`] or [t, `v_x`, `v_y`, `v_z`] (m/s).
pub type Row = Coordinates<4>;

impl<const N: usize> Coordinates<N> {
    /// Returns the numbers; z is 0 of discs.
    pub fn list(&self) -> [f64; N] {
        self.list
    }

    /// Returns the numbers that were given.
    pub(crate) fn given(&self) -> &[f64] {
        &self.list[..N - usize::from(!self.in_space)]
    }

    /// Checks that there are as many numbers as spheres, `in_space`, or discs have; 0 alone has no dimension. `key` names the list.
    pub(crate) fn check(&self, key: &str, in_space: bool) -> Result<(), String> {
        if self.in_space == in_space || self.list == [0.0; N] {
            return Ok(());
        }
        let (grains, expected) = if in_space { ("spheres", N) } else { ("discs", N - 1) };
        let found = self.given().len();
        Err(format!("`{key}` has {found} numbers: of {grains} it must have {expected}"))
    }
}

impl Point {
    /// The origin of discs.
    pub(crate) const ORIGIN: Self = Self { list: [0.0; 3], in_space: false };
}

impl<const N: usize> TryFrom<Vec<f64>> for Coordinates<N> {
    type Error = String;

    fn try_from(given: Vec<f64>) -> Result<Self, String> {
        let mut list = [0.0; N];
        let count = given.len();
        if count != N && count + 1 != N {
            return Err(format!(
                "a list of {count} numbers: {} are expected of discs, {N} of spheres",
                N - 1
            ));
        }
        list[..count].copy_from_slice(&given);
        Ok(Self { list, in_space: count == N })
    }
}

impl<const N: usize> From<Coordinates<N>> for Vec<f64> {
    fn from(coordinates: Coordinates<N>) -> Self {
        coordinates.given().to_vec()
    }
}

impl<const N: usize> JsonSchema for Coordinates<N> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Coordinates".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": { "type": "number" }, "minItems": N - 1, "maxItems": N })
    }
}
