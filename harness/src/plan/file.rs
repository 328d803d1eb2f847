//! A plan: which methods meet which problems, along which axes, until when.

use crate::plan::{Marcher, PlannedMethod, Rule, Settings, Simulate, Variant};
use crate::terminal::{read_text, suggest};
use anyhow::{Context, Result, anyhow, bail};
use cases::{Start, all_missing, of_toml};
use reports::Chart;
use runner::Stop;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::fmt::Display;
use std::num::NonZeroU32;
use std::path::Path;

/// A study.
#[derive(Debug, JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plan {
    /// Name, in results and of their folders.
    pub(crate) name: String,
    /// Question of the study, in a sentence.
    pub(crate) why: String,
    /// The text that discusses the study, by its path in the checkout, such as `"reports/giens2009.md"`.
    pub(crate) text: Option<String>,
    /// Names of frozen problems.
    #[serde(default)]
    pub(crate) problems: Vec<String>,
    /// Names of stored problems of the collection, in which `*` stands for any text, such as `"rough-shear-box grains=250*"`.
    #[serde(default)]
    pub(crate) collected: Vec<String>,
    /// Cases whose problems are computed for the study.
    #[serde(default)]
    pub(crate) cases: Vec<PlannedCase>,
    /// True where runs begin from the impulses of the time step before, unless a method says otherwise; through time also a
    /// name, such as `"extrapolated"`.
    #[serde(default)]
    pub(crate) warm_start: Start,
    /// True where rows hold the eigenvalues of their problems, which explain failures.
    #[serde(default)]
    pub(crate) spectra: bool,
    /// Number of repeats of each run for its seconds, which are then medians; a run of less than a millisecond is repeated more often.
    #[serde(default = "once")]
    pub(crate) repeats: NonZeroU32,
    /// Threads that methods may use, where `--threads` does not say it.
    pub(crate) threads: Option<NonZeroU32>,
    /// True where errors against reference solutions are measured, and scenes are kept to be drawn; false is for problems so
    /// large that this would take longer than the runs.
    #[serde(default = "yes")]
    pub(crate) reference: bool,
    /// Stop rule of the runs.
    pub(crate) stop: Stop,
    /// Makes of the study one through time: simulations of its cases, instead of problems.
    pub(crate) simulate: Option<Simulate>,
    /// Samples of a run that are kept.
    #[serde(default)]
    pub(crate) curves: Curves,
    /// Names of the figures.
    #[serde(default, deserialize_with = "charts")]
    #[schemars(schema_with = "charts_schema")]
    charts: Option<Vec<Chart>>,
    /// Runs whose iterations the page of the study shows.
    pub(crate) view: Option<View>,
    /// The methods.
    pub(crate) methods: Vec<PlannedMethod>,
    /// Short version of the study, which takes less than a minute: these keys replace those of the plan.
    #[serde(default)]
    #[schemars(with = "Settings")]
    quick: Option<toml::Table>,
}

/// The chart of this name, on the command line or in a plan.
pub(crate) fn chart(name: &str) -> Result<Chart, String> {
    let known = Chart::all().iter().map(|chart| chart.name);
    Chart::named(name).ok_or_else(|| suggest::among(&format!("no chart `{name}`"), name, known))
}

fn charts<'de, D: Deserializer<'de>>(charts: D) -> Result<Option<Vec<Chart>>, D::Error> {
    let refused = |error: &dyn Display| D::Error::custom(format!("`charts`: {error}"));
    let read = |one: toml::Value| match one {
        toml::Value::String(name) => chart(&name).map_err(|error| refused(&error)),
        own => Chart::own(own.try_into().map_err(|error| refused(&error))?).map_err(|error| refused(&error)),
    };
    Vec::<toml::Value>::deserialize(charts)?.into_iter().map(read).collect::<Result<_, _>>().map(Some)
}

fn charts_schema(_: &mut SchemaGenerator) -> Schema {
    let names: Vec<&str> = Chart::all().iter().map(|chart| chart.name).collect();
    let own = json_schema!({
        "type": "object",
        "required": ["name", "x", "y"],
        "additionalProperties": false,
        "properties": {
            "name": { "type": "string" },
            "title": { "type": "string" },
            "x": { "type": "string" },
            "y": { "type": "array", "items": { "type": "string" } },
            "varied": { "type": "string" },
            "fit": { "type": "boolean" },
        },
    });
    json_schema!({ "type": "array", "items": { "anyOf": [{ "enum": names }, { "allOf": [own] }] } })
}

pub(crate) fn yes() -> bool {
    true
}

fn once() -> NonZeroU32 {
    NonZeroU32::MIN
}

/// A case, with the values of its file that the plan replaces; every combination is a problem.
#[derive(Debug, JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlannedCase {
    /// Its name, or the path of its file.
    pub(crate) case: String,
    /// The time step, counted from 1, or one of the case's moments; the case's `solve_at` where there is none.
    pub(crate) time_step: Option<Value>,
    /// The time to simulate, in a study through time; the plan's where there is none (s).
    pub(crate) duration_s: Option<f64>,
    /// The method that solves the time steps before, such as `{ method = "active-set", stop = { tolerance = 1e-4 } }`; without it
    /// `active-set`, to 1e-4, where there is friction, `cg` where there is none.
    pub(crate) march: Option<Marcher>,
    /// Values that are the same for all, such as `"scene.law" = "iqs"`.
    #[serde(default)]
    pub(crate) scene: Settings,
    /// Values that are taken together.
    #[serde(default)]
    pub(crate) zip: Settings,
    /// Values that are combined; `time_step` may be one of them.
    #[serde(default)]
    pub(crate) axes: Settings,
}

/// Runs of which iterates are kept, for the viewer of the page.
#[derive(Debug, JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct View {
    /// Name of the problem.
    pub(crate) problem: String,
    /// Runs by method and variant, such as `nsgs-dd 4x2`.
    pub(crate) runs: Vec<String>,
}

/// Samples of a run that are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Curves {
    /// Enough to draw its curve.
    #[default]
    Whole,
    /// The first, the last, those of iterations 1, 2, 4, …, and those at which a measure first passes a power of ten.
    Ends,
}

impl Plan {
    /// Reads a plan, in its quick form if `quick` says so, and checks every method in both.
    pub(crate) fn read(path: &Path, quick: bool) -> Result<Self> {
        let text = read_text(path)?;
        // All keys that it lacks at once, if that is what is wrong.
        let lacks = |(_, error): (String, toml::de::Error)| match toml::from_str::<toml::Table>(&text) {
            Ok(content) => anyhow!(all_missing::<Self>(&content, error.to_string())),
            Err(_) => error.into(),
        };
        let read = || {
            let plan: Self = of_toml(&text).map_err(lacks)?;
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

    /// Returns the question of a plan, of which nothing else is checked.
    pub(crate) fn why_of(path: &Path) -> Result<String> {
        #[derive(Deserialize)]
        struct Head {
            why: String,
        }
        let read = |text: String| Ok(toml::from_str::<Head>(&text)?.why);
        read_text(path).and_then(read).with_context(|| path.display().to_string())
    }

    /// The plan with the keys of `quick` in place of its own: those of `stop` and `simulate` one by one, all others whole.
    fn quick(&self, text: &str) -> Result<Option<Self>> {
        let Some(quick) = &self.quick else { return Ok(None) };
        let mut plan: toml::Table = toml::from_str(text)?;
        plan.remove("quick");
        for (key, value) in quick {
            match (key.as_str(), plan.get_mut(key).and_then(toml::Value::as_table_mut), value.as_table()) {
                ("name" | "quick", ..) => bail!("`{key}`: a quick study has the name of its plan and -quick"),
                ("stop" | "simulate", Some(table), Some(quick)) => table.extend(quick.clone()),
                _ => drop(plan.insert(key.clone(), value.clone())),
            }
        }
        let mut plan: Self = of_toml(&plan.to_string()).map_err(|(key, error)| {
            anyhow!(all_missing::<Self>(&plan, format!("`{key}`: {}", error.message())))
        })?;
        plan.name += "-quick";
        plan.check()?;
        Ok(Some(plan))
    }

    /// Reports whether the study is of simulations, not of problems.
    pub(crate) fn through_time(&self) -> bool {
        self.simulate.is_some()
    }

    /// The rules of a study through time, each with its name; none for a study of problems.
    pub(crate) fn rules(&self) -> Result<Vec<(Rule, String)>> {
        self.simulate.as_ref().map_or(Ok(Vec::new()), |simulate| simulate.rules(&self.stop, self.warm_start))
    }

    /// The figures of the study.
    pub(crate) fn charts(&self) -> Vec<Chart> {
        self.charts.clone().unwrap_or_else(|| Chart::default_set(self.through_time()))
    }
}

impl View {
    /// Reports whether the iterates of a run are kept.
    pub(crate) fn shows(&self, problem: &str, variant: &Variant) -> bool {
        problem == self.problem && self.runs.contains(&variant.label())
    }
}
