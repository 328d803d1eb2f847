//! A plan: which methods meet which problems, along which axes, until when.

mod axes;
mod names;

pub(crate) use axes::{Settings, combinations, values};
pub(crate) use names::{last_parts, pairs};

use crate::methods::Method;
use crate::suggest;
use anyhow::{Context, Result, anyhow, bail};
use contact::Stop;
use reports::Chart;
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeSet, HashSet};
use std::num::NonZeroU32;
use std::path::Path;

fn default_charts() -> Vec<String> {
    Chart::default_set().iter().map(|chart| chart.name().to_owned()).collect()
}

/// A study.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plan {
    /// Name, in results and of their folders.
    pub(crate) name: String,
    /// What the study asks, in a sentence.
    pub(crate) why: String,
    /// Names of frozen problems.
    #[serde(default)]
    pub(crate) problems: Vec<String>,
    /// Cases whose problems are made for the study.
    #[serde(default)]
    pub(crate) cases: Vec<PlannedCase>,
    /// Whether runs begin from the impulses of the time step before.
    #[serde(default)]
    pub(crate) warm_start: bool,
    /// How often each run is made for its seconds, which are then medians.
    #[serde(default = "once")]
    pub(crate) repeats: NonZeroU32,
    /// Until when.
    pub(crate) stop: Stop,
    /// Which samples of a run are kept.
    #[serde(default)]
    pub(crate) curves: Curves,
    /// Names of the figures.
    #[serde(default = "default_charts")]
    charts: Vec<String>,
    /// The methods.
    methods: Vec<PlannedMethod>,
    /// The same study in under a minute: these keys replace those of the plan.
    #[serde(default)]
    quick: Option<toml::Table>,
}

fn once() -> NonZeroU32 {
    NonZeroU32::MIN
}

/// A case, with the values of its file that the plan replaces; every combination is a problem.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlannedCase {
    /// Its name, or the path of its file.
    pub(crate) case: String,
    /// The time step, counted from 1, or one of the case's moments; the case's `solve_at` where there is none.
    pub(crate) time_step: Option<Value>,
    /// Values that are the same for all, such as `"scene.law" = "iqs"`.
    #[serde(default)]
    pub(crate) scene: Settings,
    /// Values that are taken together.
    #[serde(default)]
    pub(crate) zip: Settings,
    /// Values that are combined.
    #[serde(default)]
    pub(crate) axes: Settings,
}

/// A method with fixed settings, and settings along which it varies; every combination is a run.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlannedMethod {
    method: String,
    #[serde(default)]
    set: Settings,
    #[serde(default)]
    zip: Settings,
    #[serde(default)]
    axes: Settings,
}

/// Which samples of a run are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Curves {
    /// Enough to draw its curve.
    #[default]
    Whole,
    /// The first, the last, those of iterations 1, 2, 4, …, and those at which a measure first passes a power of ten.
    Ends,
}

/// A method of a plan, with the settings in which it differs from the plan's other runs of it.
pub(crate) struct Variant {
    pub(crate) method: Method,
    pub(crate) name: String,
}

impl Plan {
    /// Reads a plan, in its quick form if asked, and checks every method in both.
    pub(crate) fn read(path: &Path, quick: bool) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let read = || {
            let plan: Self = toml::from_str(&text)?;
            plan.check()?;
            let short = plan.quick(&text).context("`quick`")?;
            match (quick, short) {
                (false, _) => Ok(plan),
                (true, Some(short)) => Ok(short),
                (true, None) => Err(anyhow!("--quick: the plan has no table [quick]")),
            }
        };
        read().with_context(|| path.display().to_string())
    }

    /// The plan with the keys of `quick` in place of its own: those of `stop` one by one, all others whole.
    fn quick(&self, text: &str) -> Result<Option<Self>> {
        let Some(quick) = &self.quick else { return Ok(None) };
        let mut plan: toml::Table = toml::from_str(text)?;
        plan.remove("quick");
        for (key, value) in quick {
            match (key.as_str(), plan.get_mut(key).and_then(toml::Value::as_table_mut), value.as_table()) {
                ("name" | "quick", ..) => bail!("`{key}`: a quick study has the name of its plan and -quick"),
                ("stop", Some(stop), Some(quick)) => stop.extend(quick.clone()),
                _ => drop(plan.insert(key.clone(), value.clone())),
            }
        }
        let mut plan: Self = serde_path_to_error::deserialize(plan)
            .map_err(|error| anyhow!("`{}`: {}", error.path(), error.inner().message()))?;
        plan.name += "-quick";
        plan.check()?;
        Ok(Some(plan))
    }

    fn check(&self) -> Result<()> {
        if self.problems.is_empty() && self.cases.is_empty() {
            bail!("`problems` is empty, and there are no `cases`");
        }
        self.charts()?;
        self.stop.check().context("`stop`")?;
        self.variants(&[]).map(|_| ())
    }

    /// The figures of the study.
    pub(crate) fn charts(&self) -> Result<Vec<Chart>> {
        let known = || Chart::all().iter().map(|chart| chart.name());
        let read = |name: &String| {
            name.parse().map_err(|error| anyhow!("`charts`: {error}{}", suggest::of(name, known())))
        };
        self.charts.iter().map(read).collect()
    }

    /// Every method with every combination of its axes, in the order of the plan. Each of `changes` replaces a setting of
    /// every method that has it; runs that are the same then are one.
    pub(crate) fn variants(&self, changes: &[(String, String)]) -> Result<Vec<Variant>> {
        let mut methods: Vec<Method> = Vec::new();
        let mut seen = HashSet::new();
        let mut unused: Vec<&(String, String)> = changes.iter().collect();
        for planned in &self.methods {
            for method in planned.methods()? {
                let (known, changed) = (method.settings.clone(), method.changed(changes)?);
                unused.retain(|(key, _)| !known.contains_key(key));
                let new = seen.insert((changed.name, Value::Object(changed.settings.clone()).to_string()));
                if new {
                    methods.push(changed);
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
                methods.iter().flat_map(|method| method.settings.keys()).map(String::as_str).collect();
            bail!("--set {key}={value}: no method of the plan has `{key}`{}", suggest::of(key, known));
        }
        let names = names::of_variants(&methods);
        Ok(methods.into_iter().zip(names).map(|(method, name)| Variant { method, name }).collect())
    }
}

impl PlannedMethod {
    fn methods(&self) -> Result<Vec<Method>> {
        let settings = combinations(&self.set, &self.zip, &self.axes)
            .with_context(|| format!("method `{}`", self.method))?;
        settings.into_iter().map(|settings| Method::new(&self.method, settings)).collect()
    }
}

#[cfg(test)]
mod tests;
