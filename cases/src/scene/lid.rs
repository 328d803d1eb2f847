//! A lid on the grains of a periodic box: a body that a given force presses down, and that its guides move along x.

use crate::detect::Grain;
use crate::file::values::{check, not_negative, positive};
use contact::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A lid. Without bumps it is flat; it has those of the floor.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lid {
    /// Its mass (kg).
    pub mass_kg: f64,
    /// Force that presses it down, its weight apart (N).
    pub force_n: f64,
    /// Speed at which its guides move it towards +x (m/s).
    #[serde(default)]
    pub speed_m_per_s: f64,
}

impl Lid {
    /// Returns it as one more grain, of this `radius`, on top of the `grains`, which its bumps just touch at most (m).
    pub(crate) fn body<P: Place>(&self, grains: &[Grain<P>], radius: f64, bumps: f64) -> Grain<P> {
        let tops = grains.iter().map(|grain| grain.position[1] + grain.radius);
        let surface = tops.fold(f64::NEG_INFINITY, f64::max) + bumps;
        Grain { radius, mass: self.mass_kg, position: P::of([0.0, surface + radius, 0.0]), motion: [0.0; 6] }
    }

    /// Refuses values without meaning.
    pub(crate) fn check(&self) -> Result<(), String> {
        check("scene.box.lid", [positive("mass_kg", self.mass_kg), not_negative("force_n", self.force_n)])
    }
}
