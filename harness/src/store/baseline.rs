//! Baselines: the counts of a plan's runs as they were accepted, and the failures that are expected.

use crate::plan::methods::METHODS;
use crate::plan::names::as_typed;
use crate::run::curve::decades;
use crate::study::problems::OnProblems;
use crate::study::tasks::{Task, by_id};
use crate::terminal::output::read_text;
use anyhow::{Context, Result, bail};
use contact::Measure;
use results::journal::Record;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::Path;

/// What one run counted: a line of `results/baseline/<plan>.csv`. Seconds are no counts.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Counts {
    pub(crate) problem: String,
    pub(crate) method: String,
    /// The settings that are not the method's defaults: a default that changes shows in the counts.
    pub(crate) settings: String,
    pub(crate) problem_hash: String,
    pub(crate) status: String,
    pub(crate) iterations: u64,
    /// First iterations with ζ ≤ 0.1, 0.01, …, as far as the run came.
    pub(crate) zeta: String,
    /// First iterations with `natural_map` ≤ 0.1, 0.01, …, as far as the run came.
    pub(crate) natural_map: String,
    pub(crate) contact_updates: u64,
    pub(crate) delassus_products: u64,
    pub(crate) interface_values: u64,
    pub(crate) triangular_solve_entries: u64,
    pub(crate) factorisations: u64,
}

impl Counts {
    /// The counts of a study's runs, in the order of their names.
    pub(crate) fn of(tasks: &[Task<OnProblems>], records: &[Record]) -> Result<Vec<Self>> {
        let known = by_id(records);
        let mut all = Vec::new();
        for Task { id, variant, what: problem, .. } in tasks {
            let problem = &problem.frozen.name;
            let missing = || format!("{} on {problem} has no run", variant.label());
            let Record { run, curve, .. } = known.get(id.as_str()).with_context(missing)?;
            let list = |measure| {
                let iterations = decades(curve, measure);
                iterations.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
            };
            let work = run.end.work;
            all.push(Self {
                problem: problem.clone(),
                method: run.method.clone(),
                settings: not_default(&run.method, &variant.method.settings)?,
                problem_hash: run.problem_hash.clone(),
                status: run.status.clone(),
                iterations: run.iterations,
                zeta: list(Measure::Zeta),
                natural_map: list(Measure::NaturalMap),
                contact_updates: work.contact_updates,
                delassus_products: work.delassus_products,
                interface_values: work.interface_values,
                triangular_solve_entries: work.triangular_solve_entries,
                factorisations: work.factorisations,
            });
        }
        all.sort();
        Ok(all)
    }

    /// The run: problem, method and settings.
    pub(crate) fn run(&self) -> String {
        format!("{} {} {}", self.problem, self.method, self.settings).trim_end().to_owned()
    }

    /// The counts that differ from those `before`: name, before, now. Of the decades of a measure, the first.
    pub(crate) fn differences(&self, before: &Self) -> Result<Vec<(String, String, String)>> {
        let (Value::Object(now), before) = (serde_json::to_value(self)?, serde_json::to_value(before)?)
        else {
            bail!("counts are an object");
        };
        let mut all = Vec::new();
        for (key, now) in now.iter().filter(|(key, now)| **now != before[*key]) {
            let (before, now) = (as_typed(&before[key]), as_typed(now));
            if !["zeta", "natural_map"].contains(&key.as_str()) {
                all.push((key.clone(), before, now));
                continue;
            }
            let iteration = |list: &str, decade| list.split(' ').nth(decade).unwrap_or_default().to_owned();
            let decades = 0..before.len().max(now.len());
            let differs = |decade: &usize| iteration(&before, *decade) != iteration(&now, *decade);
            let decade = decades.into_iter().find(differs).unwrap_or(0);
            let name = format!("{key} 1e-{}", decade + 1);
            all.push((name, iteration(&before, decade), iteration(&now, decade)));
        }
        Ok(all)
    }
}

/// The settings that differ from the defaults, such as `relaxation=1.5 sweeps=2`.
fn not_default(method: &str, settings: &Map<String, Value>) -> Result<String> {
    let entry = METHODS.iter().find(|entry| entry.name == method);
    let defaults = entry.with_context(|| format!("no method `{method}`"))?.defaults()?;
    let set = settings.iter().filter(|(key, value)| defaults.get(*key) != Some(*value));
    Ok(set.map(|(key, value)| format!("{key}={}", as_typed(value))).collect::<Vec<_>>().join(" "))
}

/// Reads a baseline.
pub(crate) fn read(path: &Path) -> Result<Vec<Counts>> {
    let mut reader = csv::Reader::from_path(path).with_context(|| path.display().to_string())?;
    let counts = reader.deserialize().collect::<Result<_, _>>();
    counts.with_context(|| path.display().to_string())
}

/// The text of a baseline.
pub(crate) fn to_csv(counts: &[Counts]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for run in counts {
        writer.serialize(run)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// A run that is expected to fail.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExpectedFailure {
    pub(crate) plan: String,
    /// Problem, method and settings, as `gravel regress` names the run.
    pub(crate) run: String,
    /// How it fails.
    pub(crate) status: String,
    /// Why that is right.
    pub(crate) why: String,
}

/// The expected failures of a plan; none without a file.
pub(crate) fn expected_failures(path: &Path, plan: &str) -> Result<Vec<ExpectedFailure>> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Ledger {
        #[serde(default)]
        failure: Vec<ExpectedFailure>,
    }
    if !path.exists() {
        return Ok(Vec::new());
    }
    let ledger: Ledger = toml::from_str(&read_text(path)?).with_context(|| path.display().to_string())?;
    for failure in &ledger.failure {
        if failure.why.trim().is_empty() {
            bail!("{}: `{}` has no `why`", path.display(), failure.run);
        }
    }
    Ok(ledger.failure.into_iter().filter(|failure| failure.plan == plan).collect())
}
