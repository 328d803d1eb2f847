//! A simulation of a study through time, and the rows of its series.

use std::ops::Deref;

use results::simulation::{Observed, Simulated, Simulation as Row};

use super::run::{defined, label};

/// A simulation with its series.
pub(crate) struct Simulation(Simulated);

impl Deref for Simulation {
    type Target = Row;

    fn deref(&self) -> &Row {
        &self.0.simulation
    }
}

impl Simulation {
    pub(crate) fn of(simulated: &Simulated) -> Self {
        Self(simulated.clone())
    }

    pub(crate) fn series(&self) -> &[Observed] {
        &self.0.series
    }

    pub(crate) fn is_run(&self) -> bool {
        self.role == "run"
    }

    pub(crate) fn label(&self) -> String {
        // A truth value says of which setting it is, if that is the only one.
        let mut truths = self.settings.iter().filter(|(_, value)| value.is_boolean());
        match (self.variant.as_str(), truths.next(), truths.next()) {
            (variant @ ("true" | "false"), Some((key, _)), None) => {
                label(&self.method, &format!("{key}={variant}"))
            }
            (variant, ..) => label(&self.method, variant),
        }
    }

    /// Seconds in the method for each second simulated, as far as it came.
    pub(crate) fn seconds_per_second(&self) -> Option<f64> {
        let simulated = self.totals.time_steps as f64 * self.time_step_s;
        let seconds = defined(self.totals.setup_s + self.totals.iterating_s)?;
        (simulated > 0.0).then_some(seconds / simulated)
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
