//! Hazards: problems of one case that are hard for one reason, and the values that vary among them.

use serde_json::Value;

use crate::read::{RunRow, problems};

/// The problems of one case that differ in the same values.
pub(crate) struct Hazard {
    /// Name of the case; of a frozen problem its own.
    pub(crate) name: String,
    /// Varied parameters with their values; empty for a problem alone.
    pub(crate) knob: String,
    pub(crate) problems: Vec<String>,
}

/// The problems of the study in its order, by hazard.
pub(crate) fn hazards(runs: &[RunRow]) -> Vec<Hazard> {
    // The case and its knobs, with the problems.
    type Known = ((String, Vec<String>), Vec<String>);
    let mut known: Vec<Known> = Vec::new();
    for problem in problems(runs) {
        let settings = runs.iter().find(|run| run.problem == problem).map(|run| &run.problem_settings);
        let case =
            settings.and_then(|settings| settings.get("case")).and_then(Value::as_str).unwrap_or(problem);
        let keys = knobs(case, problem).into_iter().map(|(key, _)| key.to_owned()).collect();
        let key = (case.to_owned(), keys);
        match known.iter_mut().find(|(other, _)| *other == key) {
            Some((_, problems)) => problems.push(problem.to_owned()),
            None => known.push((key, vec![problem.to_owned()])),
        }
    }
    known.into_iter().map(|((case, keys), problems)| Hazard::new(case, &keys, problems)).collect()
}

/// The `key=value` that distinguish a problem from the others of its case, by its name.
fn knobs<'p>(case: &str, problem: &'p str) -> Vec<(&'p str, &'p str)> {
    let rest = problem.strip_prefix(case).unwrap_or_default();
    rest.split(' ').filter_map(|word| word.split_once('=')).collect()
}

impl Hazard {
    fn new(case: String, keys: &[String], problems: Vec<String>) -> Self {
        let of = |key: &String| {
            let value = |problem: &String| {
                knobs(&case, problem).iter().find(|(k, _)| k == key).map(|(_, v)| (*v).to_owned())
            };
            let mut values: Vec<String> = problems.iter().filter_map(value).collect();
            values.dedup();
            format!("{key} {}", values.join(", "))
        };
        let knob = keys.iter().map(of).collect::<Vec<_>>().join("; ");
        Self { name: case, knob, problems }
    }
}
