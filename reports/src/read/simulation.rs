//! A simulation of a study through time, and the rows of its series.

use std::ops::Deref;

use results::settings::{CASE, FRICTION};
use results::simulation::{Observed, Role, Simulated, Simulation as Row, SimulationEnding};
use serde_json::Value;

use super::run::{defined, label};

/// A simulation with its series.
pub(crate) struct Simulation {
    simulated: Simulated,
    /// The settings in which runs of its method differ, as they are read.
    pub(crate) words: String,
}

impl Deref for Simulation {
    type Target = Row;

    fn deref(&self) -> &Row {
        &self.simulated.simulation
    }
}

impl Simulation {
    pub(crate) fn of(simulated: &Simulated) -> Self {
        Self { simulated: simulated.clone(), words: String::new() }
    }

    pub(crate) fn series(&self) -> &[Observed] {
        &self.simulated.series
    }

    pub(crate) fn is_run(&self) -> bool {
        self.role == Role::Run
    }

    pub(crate) fn label(&self) -> String {
        label(&self.method, &self.words)
    }

    /// The name of its case; of its scene, where that has none.
    pub(crate) fn case(&self) -> &str {
        self.scene_settings.get(CASE).and_then(Value::as_str).unwrap_or(&self.scene)
    }

    /// μ of its grains, where the study sets it (–).
    pub(crate) fn friction(&self) -> Option<f64> {
        self.scene_settings.get(FRICTION)?.as_f64()
    }

    /// Reports whether it came to its end, and met its tolerance in every time step.
    pub(crate) fn is_solved(&self) -> bool {
        self.status == SimulationEnding::Completed && self.totals.missed_time_steps == 0
    }

    /// Seconds in the method for each second simulated, as far as it came.
    pub(crate) fn seconds_per_second(&self) -> Option<f64> {
        let simulated = self.totals.time_steps as f64 * self.time_step_s;
        let seconds = defined(self.totals.setup_s + self.totals.iterating_s)?;
        (simulated > 0.0).then_some(seconds / simulated)
    }
}

/// The simulation of a scene in this role, if there is one.
pub(crate) fn in_role<'s>(all: &'s [Simulation], scene: &str, role: Role) -> Option<&'s Simulation> {
    all.iter().find(|other| other.scene == scene && other.role == role)
}

/// A time step as it is read, without zeros behind it (ms).
pub(crate) fn milliseconds(time_step_s: f64) -> f64 {
    (1e6 * time_step_s).round() / 1e3
}
