//! A plan: which methods meet which problems, along which axes, until when.

use crate::methods::Method;
use anyhow::{Context, Result, bail};
use contact::Stop;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::path::Path;

/// A study.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plan {
    /// Name, in results and of their folders.
    pub(crate) name: String,
    /// What the study asks, in a sentence.
    pub(crate) why: String,
    /// Names of frozen problems.
    pub(crate) problems: Vec<String>,
    /// Whether runs begin from the impulses of the time step before.
    #[serde(default)]
    pub(crate) warm_start: bool,
    /// How often each run is made for its seconds, which are then medians.
    #[serde(default = "once")]
    pub(crate) repeats: NonZeroU32,
    /// Until when.
    pub(crate) stop: Stop,
    /// The methods.
    methods: Vec<PlannedMethod>,
}

fn once() -> NonZeroU32 {
    NonZeroU32::MIN
}

/// A method with fixed settings, and settings along which it varies.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlannedMethod {
    method: String,
    #[serde(default)]
    set: Map<String, Value>,
    /// Every combination of the listed values is a run.
    #[serde(default)]
    axes: BTreeMap<String, Vec<Value>>,
}

/// A method of a plan, with the settings in which it differs from the plan's other runs of it.
pub(crate) struct Variant {
    pub(crate) method: Method,
    pub(crate) name: String,
}

impl Plan {
    /// Reads a plan and checks every method in it.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let plan: Self = toml::from_str(&text).with_context(|| path.display().to_string())?;
        if plan.problems.is_empty() {
            bail!("{}: `problems` is empty", path.display());
        }
        plan.stop.check().with_context(|| format!("{}: `stop`", path.display()))?;
        plan.variants().with_context(|| path.display().to_string())?;
        Ok(plan)
    }

    /// Every method with every combination of its axes, in the order of the plan.
    pub(crate) fn variants(&self) -> Result<Vec<Variant>> {
        let mut methods = Vec::new();
        for planned in &self.methods {
            for settings in planned.combinations()? {
                methods.push(Method::new(&planned.method, settings)?);
            }
        }
        if methods.is_empty() {
            bail!("`methods` is empty");
        }
        let names: Vec<String> = methods.iter().map(|method| differences(method, &methods)).collect();
        Ok(methods.into_iter().zip(names).map(|(method, name)| Variant { method, name }).collect())
    }
}

impl PlannedMethod {
    fn combinations(&self) -> Result<Vec<Map<String, Value>>> {
        let mut combinations = vec![self.set.clone()];
        for (key, values) in &self.axes {
            if values.is_empty() {
                bail!("method `{}`: the axis `{key}` is empty", self.method);
            }
            if self.set.contains_key(key) {
                bail!("method `{}`: `{key}` is set and an axis", self.method);
            }
            let with = |settings: &Map<String, Value>, value: &Value| {
                let mut settings = settings.clone();
                settings.insert(key.clone(), value.clone());
                settings
            };
            combinations = combinations
                .iter()
                .flat_map(|settings| values.iter().map(move |v| with(settings, v)))
                .collect();
        }
        Ok(combinations)
    }
}

/// The values of those settings in which the runs of one method differ, such as `4x2`.
fn differences(method: &Method, all: &[Method]) -> String {
    let same_method = |other: &&Method| other.name == method.name;
    let differs =
        |key: &str| all.iter().filter(same_method).any(|other| other.settings[key] != method.settings[key]);
    let values = method.settings.iter().filter(|(key, _)| differs(key)).map(|(_, value)| match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    });
    values.collect::<Vec<_>>().join(" ")
}
