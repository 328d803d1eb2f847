//! Baselines: the counts of a plan's runs as they were accepted, and the failures that are expected.

use crate::plan::{as_typed, method};
use crate::problems::Problem;
use crate::run::{Task, decades};
use crate::study::by_id;
use crate::terminal::read_text;
use anyhow::{Context, Result, bail};
use contact::{Measure, Work};
use csv::StringRecord;
use results::journal::Record;
use results::name::Name;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::path::Path;

/// The columns of `results/baseline/<plan>.csv`, before those of the work. The settings are those that are not the method's
/// defaults: a default that changes shows in the counts. Of the measures, the first iterations with at most 0.1, 0.01, …, as far
/// as the run came. Seconds are no counts.
const COLUMNS: [&str; 8] =
    ["problem", "method", "settings", "problem_hash", "status", "iterations", ZETA, NATURAL_MAP];
const ZETA: &str = "zeta";
const NATURAL_MAP: &str = "natural_map";

fn columns() -> Vec<&'static str> {
    COLUMNS.into_iter().chain(Work::default().named().map(|(name, _)| name)).collect()
}

/// Counts of one run: a line of a baseline.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Counts(Vec<String>);

impl Counts {
    /// The counts of a study's runs, in the order of their names.
    pub(crate) fn of(tasks: &[Task<&Problem>], records: &[Record]) -> Result<Vec<Self>> {
        let known = by_id(records);
        let mut all = Vec::new();
        for Task { id, variant, what: problem, .. } in tasks {
            let problem = &problem.name;
            let missing = || format!("{} on {problem} has no run", variant.label());
            let Record { run, curve, .. } = known.get(id.as_str()).with_context(missing)?;
            let decades = |measure| {
                decades(curve, measure).iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
            };
            let mut row = vec![problem.clone(), run.method.clone()];
            row.push(not_default(&run.method, &variant.method.settings)?);
            row.extend([run.problem_hash.clone(), run.status.name().to_owned(), run.iterations.to_string()]);
            row.extend([Measure::Zeta, Measure::NaturalMap].map(decades));
            row.extend(run.end.work.named().map(|(_, count)| count.to_string()));
            all.push(Self(row));
        }
        all.sort();
        Ok(all)
    }

    /// The run: problem, method and settings.
    pub(crate) fn run(&self) -> String {
        self.0[..3].join(" ").trim_end().to_owned()
    }

    pub(crate) fn status(&self) -> &str {
        &self.0[4]
    }

    /// Returns problem, method, settings, hash of the problem, status and iterations.
    pub(crate) fn named(&self) -> [&str; 6] {
        [0, 1, 2, 3, 4, 5].map(|column| self.0[column].as_str())
    }

    /// The counts that differ from those `before`: name, before, now. Of the decades of a measure, the first.
    pub(crate) fn differences(&self, before: &Self) -> Vec<[String; 3]> {
        let all = columns().into_iter().zip(before.0.iter().zip(&self.0));
        let differ = all.filter(|(_, (before, now))| before != now);
        differ.map(|(column, (before, now))| difference(column, before, now)).collect()
    }
}

fn difference(column: &str, before: &str, now: &str) -> [String; 3] {
    if ![ZETA, NATURAL_MAP].contains(&column) {
        return [column, before, now].map(str::to_owned);
    }
    let iteration = |list: &str, decade| list.split(' ').nth(decade).unwrap_or_default().to_owned();
    let differs = |decade: &usize| iteration(before, *decade) != iteration(now, *decade);
    let decade = (0..before.len().max(now.len())).find(differs).unwrap_or(0);
    [format!("{column} 1e-{}", decade + 1), iteration(before, decade), iteration(now, decade)]
}

/// The settings that differ from the defaults, such as `relaxation=1.5 sweeps=2`.
fn not_default(name: &str, settings: &Map<String, Value>) -> Result<String> {
    let defaults = method(name).with_context(|| format!("no method `{name}`"))?.defaults()?;
    let set = settings.iter().filter(|(key, value)| defaults.get(*key) != Some(*value));
    Ok(set.map(|(key, value)| format!("{key}={}", as_typed(value))).collect::<Vec<_>>().join(" "))
}

/// Reads a baseline.
pub(crate) fn read_baseline(path: &Path) -> Result<Vec<Counts>> {
    let read = || {
        let mut reader = csv::Reader::from_path(path)?;
        if *reader.headers()? != columns() {
            bail!("its columns must be `{}`", columns().join("`, `"));
        }
        let counts = |row: StringRecord| Counts(row.iter().map(str::to_owned).collect());
        Ok(reader.records().map(|row| row.map(counts)).collect::<Result<_, _>>()?)
    };
    read().with_context(|| path.display().to_string())
}

/// The text of a baseline.
pub(crate) fn baseline_text(counts: &[Counts]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns())?;
    counts.iter().try_for_each(|run| writer.write_record(&run.0))?;
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// A run that is expected to fail.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExpectedFailure {
    pub(crate) plan: String,
    /// Problem, method and settings, as `gravel regress` names the run.
    pub(crate) run: String,
    /// Status of the failed run.
    pub(crate) status: String,
    /// Reason why that is right.
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
