//! A simulation of a study through time, and the rows of its series.

use serde::Deserialize;

use crate::read::{Origin, label};

/// A simulation with its series, by the names of the columns.
#[derive(Deserialize)]
pub(crate) struct Simulation {
    #[serde(rename = "simulation")]
    pub(crate) number: u32,
    pub(crate) scene: String,
    pub(crate) role: String,
    pub(crate) method: String,
    pub(crate) variant: String,
    pub(crate) warm_start: bool,
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: u64,
    pub(crate) status: String,
    /// Why it ended early, if it did.
    pub(crate) reason: String,
    pub(crate) mass_kg: f64,
    pub(crate) mean_diameter_m: f64,
    pub(crate) gravity_m_per_s2: f64,
    pub(crate) time_step_s: f64,
    pub(crate) time_steps: u64,
    pub(crate) missed_time_steps: u64,
    pub(crate) iterations: u64,
    pub(crate) contact_updates: u64,
    pub(crate) delassus_products: u64,
    pub(crate) setup_s: Option<f64>,
    pub(crate) iterating_s: Option<f64>,
    #[serde(skip)]
    pub(crate) origin: Origin,
    #[serde(skip)]
    pub(crate) series: Vec<Instant>,
}

/// A row of a series.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub(crate) struct Instant {
    pub(crate) kinetic_energy_j: f64,
    pub(crate) mean_height_m: f64,
    pub(crate) greatest_overlap_m: f64,
    /// Of the wall, since the row before (N·s).
    pub(crate) floor_impulse_n_s: f64,
    pub(crate) left_impulse_n_s: f64,
    pub(crate) right_impulse_n_s: f64,
}

impl Simulation {
    pub(crate) fn is_run(&self) -> bool {
        self.role == "run"
    }

    pub(crate) fn label(&self) -> String {
        label(&self.method, &self.variant)
    }

    /// Seconds in the method for each second simulated, as far as it came.
    pub(crate) fn seconds_per_second(&self) -> Option<f64> {
        let simulated = self.time_steps as f64 * self.time_step_s;
        (simulated > 0.0).then_some((self.setup_s? + self.iterating_s?) / simulated)
    }
}

/// The simulation of a scene in this role, if there is one.
pub(crate) fn in_role<'s>(all: &'s [Simulation], scene: &str, role: &str) -> Option<&'s Simulation> {
    all.iter().find(|other| other.scene == scene && other.role == role)
}

/// A time step as it is read, without zeros behind it (ms).
pub(crate) fn milliseconds(time_step_s: f64) -> f64 {
    (1e6 * time_step_s).round() / 1e3
}
