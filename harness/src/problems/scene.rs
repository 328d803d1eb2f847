//! A scene of a study through time: a case with its values replaced, for a while.

use crate::plan::Settings;
use crate::problems::first_hash;
use anyhow::{Context, Result};
use cases::Case;
use contact::shown;
use lineup::hash_of;
use serde_json::json;

/// The key of the time step: scenes that differ in it alone have one name, and one reference.
pub(crate) const TIME_STEP: &str = "scene.time_step_s";

/// A case for a while, seen at equal times.
pub(crate) struct Scene {
    /// Its name, without its time step.
    pub(crate) name: String,
    pub(crate) case: Case,
    /// Values set in the case.
    pub(crate) settings: Settings,
    /// The time to simulate (s).
    pub(crate) duration_s: f64,
    /// Time between two rows of its series (s).
    every_s: f64,
    pub(crate) time_steps: u64,
    /// Time steps from a row of its series to the next.
    pub(crate) every: u64,
    /// Hash of its grains and of what surrounds them.
    pub(crate) hash: String,
}

impl Scene {
    /// A case with `settings`, of this duration (s) and with a row in every so many seconds.
    pub(crate) fn new(
        case: Case,
        name: String,
        settings: Settings,
        duration_s: f64,
        every_s: f64,
    ) -> Result<Self> {
        let h = case.scene.time_step_s;
        let multiple = |key: &str, value: f64, of: &str, unit: f64| {
            let (ratio, value, unit) = (whole(value / unit), shown(value), shown(unit));
            ratio.with_context(|| format!("`{key}` is {value}: it must be a whole number of {of}, {unit} s"))
        };
        let every = multiple("simulate.sample_every_s", every_s, "the time step", h)?;
        let rows = multiple("duration_s", duration_s, "`sample_every_s`", every_s)?;
        // The first problem of the case holds its sample, which other files may hold.
        let first = first_hash(&case)?;
        let hash = hash_of(&json!([case.sample, case.scene, first]));
        Ok(Self { name, case, settings, duration_s, every_s, time_steps: rows * every, every, hash })
    }

    /// Returns the scene with a time step `refine` times shorter.
    pub(crate) fn refined(&self, refine: u32) -> Result<Self> {
        let mut case = self.case.clone();
        case.scene.time_step_s /= f64::from(refine);
        let mut settings = self.settings.clone();
        settings.insert(TIME_STEP.to_owned(), case.scene.time_step_s.into());
        Self::new(case, self.name.clone(), settings, self.duration_s, self.every_s)
    }
}

/// The whole number that a ratio is, to the rounding of decimal fractions.
pub(crate) fn whole(ratio: f64) -> Option<u64> {
    let whole = ratio.round();
    ((1.0..1e12).contains(&whole) && (ratio - whole).abs() <= 1e-9 * whole).then_some(whole as u64)
}
