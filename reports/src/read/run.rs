//! A run of a study on a problem, and the samples of its curve.

use std::collections::{BTreeSet, HashSet};

use results::schema::Snapshot;
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use crate::read::{Ending, counted, number};

/// A run with all that is stored of it, by the names of the columns.
#[derive(Clone, Deserialize)]
pub(crate) struct RunRow {
    pub(crate) run: u32,
    pub(crate) id: String,
    pub(crate) problem: String,
    /// What was set in the case of the problem.
    #[serde(deserialize_with = "json")]
    pub(crate) problem_settings: Map<String, Value>,
    pub(crate) grains: u32,
    pub(crate) contacts: u32,
    pub(crate) method: String,
    #[serde(deserialize_with = "json")]
    pub(crate) settings: Map<String, Value>,
    #[serde(deserialize_with = "json")]
    pub(crate) derived: Map<String, Value>,
    /// Empty in older studies.
    #[serde(default, deserialize_with = "json")]
    pub(crate) spectrum: Map<String, Value>,
    pub(crate) variant: String,
    /// The variant as it is read: a number or a truth value with the name of its setting.
    #[serde(skip)]
    pub(crate) words: String,
    pub(crate) subdomains: u32,
    pub(crate) stop_on: String,
    pub(crate) tolerance: Option<f64>,
    pub(crate) max_iterations: u64,
    pub(crate) status: String,
    #[serde(skip)]
    pub(crate) ending: Ending,
    /// Why it was skipped, if it was.
    pub(crate) reason: String,
    pub(crate) iterations: u64,
    pub(crate) iterations_to_zeta_1e_3: Option<u64>,
    pub(crate) iterations_to_zeta_1e_4: Option<u64>,
    pub(crate) iterations_to_natural_map_1e_2: Option<u64>,
    pub(crate) iterations_to_natural_map_1e_4: Option<u64>,
    pub(crate) setup_s: Option<f64>,
    pub(crate) iterating_s: Option<f64>,
    /// How often it was run for its seconds.
    pub(crate) repeats: u32,
    /// The last sample, whether or not a curve is stored.
    #[serde(skip)]
    pub(crate) end: Point,
    /// In the order of the iterations.
    #[serde(skip)]
    pub(crate) curve: Vec<Point>,
    #[serde(skip)]
    pub(crate) snapshots: Vec<Snapshot>,
    #[serde(skip)]
    pub(crate) origin: Origin,
}

/// Where a row comes from.
#[derive(Clone, Default, Deserialize)]
pub(crate) struct Origin {
    pub(crate) commit: String,
    pub(crate) processor: String,
    pub(crate) threads: u32,
    pub(crate) rustc: String,
    pub(crate) profile: String,
    pub(crate) started_utc: String,
    pub(crate) timed_alone: bool,
}

/// A sample of a curve, or of the end of a run; `None` where the measure is undefined, or its column newer than the study.
#[derive(Clone, Copy, Default, Deserialize)]
pub(crate) struct Point {
    #[serde(alias = "iterations")]
    pub(crate) iteration: u64,
    pub(crate) iterating_s: Option<f64>,
    #[serde(deserialize_with = "Option::deserialize")]
    pub(crate) zeta: Option<f64>,
    #[serde(deserialize_with = "Option::deserialize")]
    pub(crate) natural_map: Option<f64>,
    #[serde(rename = "penetration_rate_m_per_s")]
    pub(crate) penetration_rate: Option<f64>,
    pub(crate) quad_dv: Option<f64>,
    pub(crate) max_dv: Option<f64>,
    pub(crate) velocity_error: Option<f64>,
    pub(crate) contact_updates: u64,
    pub(crate) delassus_products: u64,
    pub(crate) triangular_solve_entries: u64,
    pub(crate) factorisations: u64,
}

/// A column of JSON.
fn json<'de, D: Deserializer<'de>>(cell: D) -> Result<Map<String, Value>, D::Error> {
    let text = String::deserialize(cell)?;
    serde_json::from_str(&text).map_err(|why| D::Error::custom(format!("`{text}` is no JSON object: {why}")))
}

impl RunRow {
    pub(crate) fn label(&self) -> String {
        // Such as a preconditioner that is none.
        let words = self.words.strip_prefix("none").unwrap_or(&self.words);
        label(&self.method, words.strip_prefix(", ").unwrap_or(words))
    }

    pub(crate) fn has_converged(&self) -> bool {
        self.ending == Ending::Converged
    }

    /// What it was to be stopped by, as a sentence says it.
    pub(crate) fn rule(&self) -> Option<String> {
        Some(format!("{} ≤ {}", self.stop_on.replace('_', " "), number(self.tolerance?, 2)))
    }

    /// Set-up and iterations (s).
    pub(crate) fn seconds(&self) -> Option<f64> {
        Some(self.setup_s? + self.iterating_s?)
    }
}

/// Method and variant, as a key says them.
pub(crate) fn label(method: &str, variant: &str) -> String {
    match variant {
        "" => method.to_owned(),
        grid if grid.starts_with(|c: char| c.is_ascii_digit()) => format!("{method} {grid}"),
        words => format!("{method}, {words}"),
    }
}

impl Point {
    /// The measure that a stop rule names.
    pub(crate) fn measure(&self, name: &str) -> Option<f64> {
        match name {
            "zeta" => self.zeta,
            "natural_map" => self.natural_map,
            "penetration_rate" => self.penetration_rate,
            "quad_dv" => self.quad_dv,
            "max_dv" => self.max_dv,
            "velocity_error" => self.velocity_error,
            _ => None,
        }
    }

    /// What a run was stopped on; the natural map, the working measure, stands for those that are no error.
    pub(crate) fn stopped_on(&self, run: &RunRow) -> Option<f64> {
        match run.stop_on.as_str() {
            "zeta" | "quad_dv" | "velocity_error" => self.measure(&run.stop_on),
            _ => self.natural_map,
        }
    }

    /// Counted work in sweeps over `contacts`: a contact updated counts as much as a contact passed in a product W p, that
    /// is eight multiply-adds (two components of two grains, read and written back); an entry of a triangular factor is one.
    /// Factorisations are not in it: a run that makes more than a few, as many as directions that adapt take, has no counted
    /// work; nor has one that counts none after an iteration.
    pub(crate) fn work(&self, run: &RunRow) -> Option<f64> {
        let few = self.factorisations <= 6 * (u64::from(run.subdomains) + 1);
        let contacts = f64::from(run.contacts.max(1));
        let visits = self.contact_updates as f64 + contacts * self.delassus_products as f64;
        let work = visits + self.triangular_solve_entries as f64 / 8.0;
        (few && (work > 0.0 || self.iteration == 0)).then_some(work / contacts)
    }
}

/// A variant that is the value of one setting, such as `0.5` or `false`, says of which: `relaxation=0.5`, `no polish`.
pub(crate) fn words(
    variant: &str,
    (method, settings): (&str, &Map<String, Value>),
    differing: &BTreeSet<(String, String)>,
) -> String {
    let (value, start) = variant.find(',').map_or((variant, ""), |comma| variant.split_at(comma));
    let number = value.parse::<f64>().ok();
    let is = |of: &&Value| match of {
        Value::Bool(truth) => truth.to_string() == value,
        Value::Number(of) => number.is_some() && of.as_f64() == number,
        _ => false,
    };
    let keys = differing.iter().filter(|(of, _)| of == method).map(|(_, key)| key);
    let mut keys = keys.filter(|key| settings.get(*key).as_ref().is_some_and(is));
    match (keys.next(), keys.next()) {
        (Some(key), None) if value == "true" => format!("{key}{start}"),
        (Some(key), None) if value == "false" => format!("no {key}{start}"),
        (Some(key), None) => format!("{key}={value}{start}"),
        _ => variant.to_owned(),
    }
}

/// How often each was run for its seconds, as a note says it.
pub(crate) fn repeats(runs: &[RunRow]) -> String {
    match range(runs, |run| run.repeats) {
        (_, 1) => "One run each.".to_owned(),
        (least, most) if least == most => format!("Seconds: medians of {most} runs each."),
        (least, most) => format!("Seconds: medians of {least} to {most} runs each."),
    }
}

/// How many threads the runs had, in words.
pub(crate) fn threads(runs: &[RunRow]) -> String {
    match range(runs, |run| run.origin.threads) {
        (least, most) if least == most => counted(most as usize, "thread"),
        (least, most) => format!("{least} to {most} threads"),
    }
}

fn range(runs: &[RunRow], of: fn(&RunRow) -> u32) -> (u32, u32) {
    let (least, most) = (runs.iter().map(of).min(), runs.iter().map(of).max());
    (least.unwrap_or(1), most.unwrap_or(1))
}

/// Whether the tolerance of all runs is a natural map of 10⁻², which figures show beside tighter ones.
pub(crate) fn stopped_at_1e_2<'r>(runs: impl IntoIterator<Item = &'r RunRow>) -> bool {
    runs.into_iter().all(|run| run.stop_on == "natural_map" && run.tolerance == Some(1e-2))
}

/// The problems in the order of the study.
pub(crate) fn problems<'r>(runs: impl IntoIterator<Item = &'r RunRow>) -> Vec<&'r str> {
    let mut seen = HashSet::new();
    runs.into_iter().map(|run| run.problem.as_str()).filter(|problem| seen.insert(*problem)).collect()
}

#[cfg(test)]
mod tests;
