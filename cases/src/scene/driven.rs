//! Force that drives a segment along one direction.

use crate::file::values::{check, positive};
use crate::scene::coordinates::Point;
use contact::{Place, is_positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Drive of a segment, which begins at rest and on which gravity acts too. Other segments and walls do not stop it.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Driven {
    /// Its mass (kg).
    pub mass_kg: f64,
    /// Force along its direction, its weight apart (N).
    pub force_n: f64,
    /// The direction along which alone it moves, as [x, y] or [x, y, z] of any length but 0 (–).
    pub direction: Point,
}

impl Driven {
    /// Unit vector along which it moves (–).
    pub(crate) fn along<P: Place>(&self) -> P {
        let ([x, y, z], length) = (self.direction.list(), self.length());
        P::of([x / length, y / length, z / length])
    }

    fn length(&self) -> f64 {
        let [x, y, z] = self.direction.list();
        x.hypot(y).hypot(z)
    }

    /// Refuses values without meaning, of the segment that stands at `place` in the file.
    pub(crate) fn check(&self, place: &str) -> Result<(), String> {
        let length = self.length();
        let direction = ("direction", length, is_positive(length), "of finite length, and not of none");
        check(&format!("{place}.driven"), [positive("mass_kg", self.mass_kg), direction])
    }
}
