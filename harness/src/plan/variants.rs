//! The methods of a plan: every combination of their settings is a variant.

use crate::plan::axes::{Settings, combinations};
use crate::plan::file::Plan;
use crate::plan::methods::Method;
use crate::plan::names;
use crate::terminal::suggest;
use anyhow::{Context, Result, bail};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::{BTreeSet, HashSet};

/// A method with fixed settings, and settings along which it varies; every combination is a run.
#[derive(Debug, JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlannedMethod {
    pub(crate) method: String,
    #[serde(default)]
    set: Settings,
    #[serde(default)]
    pub(crate) zip: Settings,
    #[serde(default)]
    pub(crate) axes: Settings,
    /// Whether its runs begin from the impulses of the time step before; `[false, true]` for both.
    #[serde(default)]
    pub(crate) warm_start: Option<WarmStart>,
}

/// One way to begin, or several.
#[derive(Clone, Debug, JsonSchema, Deserialize)]
#[serde(untagged, expecting = "expected true, false or a list of them")]
pub(crate) enum WarmStart {
    One(bool),
    Several(Vec<bool>),
}

/// A method of a plan and how it begins, with what sets it apart from the plan's other runs of it.
pub(crate) struct Variant {
    pub(crate) method: Method,
    pub(crate) warm_start: bool,
    pub(crate) name: String,
}

impl Variant {
    /// Method and variant, as a figure names them.
    pub(crate) fn label(&self) -> String {
        format!("{} {}", self.method.name, self.name).trim_end().to_owned()
    }

    /// A setting, where the method has one of that name and type.
    pub(crate) fn setting<T: DeserializeOwned>(&self, key: &str) -> Option<T> {
        self.method.settings.get(key).and_then(|value| T::deserialize(value).ok())
    }
}

impl Plan {
    /// Every method with every combination of its axes, in the order of the plan. Each of `changes` replaces a setting of
    /// every method that has it; runs that are the same then are one.
    pub(crate) fn variants(&self, changes: &[(String, String)]) -> Result<Vec<Variant>> {
        let mut methods: Vec<(Method, bool)> = Vec::new();
        let mut seen = HashSet::new();
        let mut unused: Vec<&(String, String)> = changes.iter().collect();
        for planned in &self.methods {
            for (method, warm_start) in planned.methods(self.warm_start)? {
                let (known, changed) = (method.settings.clone(), method.changed(changes)?);
                unused.retain(|(key, _)| !known.contains_key(key));
                let settings = Value::Object(changed.settings.clone()).to_string();
                if seen.insert((changed.name, settings, warm_start)) {
                    methods.push((changed, warm_start));
                } else if changes.is_empty() {
                    bail!("method `{}`: two runs have the settings {}", method.name, Value::Object(known));
                }
            }
        }
        if methods.is_empty() {
            bail!("`methods` is empty");
        }
        if let Some((key, value)) = unused.first() {
            let known: BTreeSet<&str> =
                methods.iter().flat_map(|(method, _)| method.settings.keys()).map(String::as_str).collect();
            bail!("--set {key}={value}: no method of the plan has `{key}`{}", suggest::of(key, known));
        }
        let names = names::of_variants(&methods);
        let variant = |((method, warm_start), name)| Variant { method, warm_start, name };
        Ok(methods.into_iter().zip(names).map(variant).collect())
    }
}

impl PlannedMethod {
    /// Every combination of its settings, with every way to begin.
    fn methods(&self, warm_start: bool) -> Result<Vec<(Method, bool)>> {
        let of_method = || format!("method `{}`", self.method);
        let settings = combinations(&self.set, &self.zip, &self.axes).with_context(of_method)?;
        let starts = match &self.warm_start {
            None => vec![warm_start],
            Some(WarmStart::One(start)) => vec![*start],
            Some(WarmStart::Several(starts)) => starts.clone(),
        };
        if starts.is_empty() {
            bail!("{}: `warm_start` is empty", of_method());
        }
        let each = settings.iter().flat_map(|settings| starts.iter().map(move |start| (settings, *start)));
        each.map(|(settings, start)| Ok((Method::new(&self.method, settings.clone())?, start))).collect()
    }
}
