//! The method of a plan that leads to the problems of a case.

use crate::plan::{Method, Settings, as_typed};
use anyhow::{Context, Result};
use runner::Stop;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method that solves the time steps before the problem of a case, each from the impulses of the one before.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Marcher {
    /// Its name.
    method: String,
    /// Its settings; those left out have their defaults.
    #[serde(default)]
    set: Settings,
    /// Stop rule of the solve of a time step.
    #[serde(default)]
    stop: Stop,
}

impl Marcher {
    /// Returns the method, and when the solve of a time step ends.
    pub(crate) fn read(&self) -> Result<(Method, Stop)> {
        self.stop.check().context("`march.stop`")?;
        Ok((Method::new(&self.method, self.set.clone()).context("`march`")?, self.stop))
    }

    /// Returns its method, settings and stop rule in a word: what is not left out, or not the default.
    pub(crate) fn in_words(&self) -> String {
        let (Stop { on, tolerance, max_iterations }, default) = (self.stop, Stop::default());
        let mut words = vec![self.method.clone()];
        words.extend(self.set.iter().map(|(key, value)| format!("{key}={}", as_typed(value))));
        words.extend((on != default.on).then(|| format!("on={on}")));
        words.extend((tolerance != default.tolerance).then(|| format!("tolerance={tolerance:e}")));
        let changed = max_iterations != default.max_iterations;
        words.extend(changed.then(|| format!("max_iterations={max_iterations}")));
        words.join(",")
    }
}
