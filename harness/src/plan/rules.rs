//! The table `[simulate]`: a plan with it is a study through time, of simulations instead of single problems.

use crate::plan::{Method, Settings, Variant, combinations, count, last_parts, pairs};
use crate::terminal::merged;
use anyhow::{Context, Result, anyhow, bail};
use cases::Start;
use contact::{Measure, shown};
use runner::Stop;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::num::NonZeroU32;

/// Simulations of a study: every combination of the values of `set`, `zip` and `axes` is a rule; each scene meets each method
/// under each rule.
#[derive(Debug, JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Simulate {
    /// The time to simulate, where a case has no `duration_s` of its own (s).
    pub(crate) duration_s: Option<f64>,
    /// Time between two rows of a series (s): a whole multiple of every time step.
    pub(crate) sample_every_s: f64,
    /// Keys of a rule that are the same for all.
    #[serde(default)]
    set: Settings,
    /// Keys whose values are taken together.
    #[serde(default)]
    zip: Settings,
    /// Keys whose values are combined.
    #[serde(default)]
    axes: Settings,
    /// Simulation with which the others of a scene are compared, if they are.
    pub(crate) reference: Option<Reference>,
}

/// A simulation of each scene that the others are compared with.
#[derive(Debug, JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Reference {
    method: String,
    #[serde(default)]
    set: Settings,
    tolerance: f64,
    /// Its time step is the scene's shortest over this.
    #[serde(default = "quarter")]
    pub(crate) refine: NonZeroU32,
}

fn quarter() -> NonZeroU32 {
    NonZeroU32::MIN.saturating_add(3)
}

/// Stop rule of each time step, and the start of its solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rule {
    pub(crate) stop: Stop,
    pub(crate) warm_start: Start,
}

/// A rule, key by key.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    on: Measure,
    tolerance: f64,
    max_iterations: u64,
    warm_start: Start,
}

impl Simulate {
    /// Every rule with its name; what it leaves open is the plan's.
    pub(crate) fn rules(&self, stop: &Stop, warm_start: Start) -> Result<Vec<(Rule, String)>> {
        if !(self.sample_every_s > 0.0 && self.sample_every_s.is_finite()) {
            bail!(
                "`simulate.sample_every_s` is {}: it must be positive and finite",
                shown(self.sample_every_s)
            );
        }
        let Stop { on, tolerance, max_iterations } = *stop;
        let plan = serde_json::to_value(Keys { on, tolerance, max_iterations, warm_start })?;
        let naming: Vec<&str> = self.zip.keys().chain(self.axes.keys()).map(String::as_str).collect();
        let mut rules = Vec::new();
        for settings in combinations(&self.set, &self.zip, &self.axes).context("`simulate`")? {
            let named = last_parts(&naming).into_iter().zip(naming.iter().map(|key| &settings[*key]));
            let name = pairs(named);
            let Keys { on, tolerance, max_iterations, warm_start } =
                serde_path_to_error::deserialize(merged(plan.clone(), settings.into()))
                    .map_err(|error| anyhow!("`simulate`: `{}`: {}", error.path(), error.inner()))?;
            let stop = Stop { on, tolerance, max_iterations };
            stop.check().context("`simulate`")?;
            if on == Measure::VelocityError {
                bail!("`simulate`: `on` is {on}: the true velocity of a time step is not known");
            }
            rules.push((Rule { stop, warm_start }, name));
        }
        Ok(rules)
    }

    /// Number of rules.
    pub(crate) fn count(&self) -> Result<f64> {
        count(&self.zip, &self.axes).context("`simulate`")
    }

    /// A key that the command line gives in place of the plan's no longer varies.
    pub(crate) fn forget(&mut self, key: &str) {
        for settings in [&mut self.set, &mut self.zip, &mut self.axes] {
            settings.remove(key);
        }
    }

    /// The method of the references and their rule, if there are any; that of their twins has ten times its tolerance.
    pub(crate) fn reference(&self, stop: &Stop) -> Result<Option<(Variant, Rule)>> {
        let Some(Reference { method, set, tolerance, .. }) = &self.reference else { return Ok(None) };
        let method = Method::new(method, set.clone()).context("`simulate.reference`")?;
        method.ours().context("`simulate.reference`")?;
        let stop = Stop { on: Measure::NaturalMap, tolerance: *tolerance, ..*stop };
        stop.check().context("`simulate.reference`")?;
        let name = "reference".to_owned();
        Ok(Some((
            Variant { method, warm_start: true, name, problems: Vec::new() },
            Rule { stop, warm_start: Start::Previous },
        )))
    }
}

impl Rule {
    /// Its keys, for what is shown and hashed.
    pub(crate) fn keys(&self) -> Value {
        let Stop { on, tolerance, max_iterations } = self.stop;
        serde_json::json!([on, tolerance, max_iterations, self.warm_start])
    }
}
