//! A drum that turns about its axis, in space a cylinder along z.

use contact::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A hollow cylinder around the origin, in which the grains lie.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drum {
    /// Its inner radius (m).
    pub radius_m: f64,
    /// Rate at which it turns, anticlockwise (rad/s). Only friction feels it.
    #[serde(default)]
    pub spin_rad_per_s: f64,
}

impl Drum {
    /// Side of the square inside the drum (m).
    pub(crate) fn square(&self) -> f64 {
        std::f64::consts::SQRT_2 * self.radius_m
    }

    /// Returns the distance of a grain from the surface (m); negative outside.
    pub(crate) fn gap<P: Place>(&self, position: P, radius: f64) -> f64 {
        self.radius_m - Self::across(position).length() - radius
    }

    /// Projects a place onto the plane of x and y.
    pub(crate) fn across<P: Place>(place: P) -> P {
        P::of([place[0], place[1], 0.0])
    }
}
