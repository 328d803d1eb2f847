//! Runs that belong together: those of a method that agree in all settings but some.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::rows::RunRow;

/// The settings, other than those in `except`, in which some runs of one method differ.
pub(crate) fn differing(runs: &[RunRow], except: &[&str]) -> BTreeSet<String> {
    let mut first = std::collections::BTreeMap::new();
    let mut differing = BTreeSet::new();
    for run in runs {
        let reference: &RunRow = first.entry(&run.method).or_insert(run);
        for (key, value) in &run.settings {
            if reference.settings.get(key) != Some(value) && !except.contains(&key.as_str()) {
                differing.insert(key.clone());
            }
        }
    }
    differing
}

/// What of `keys` a run has, as text: `4x2`, `4x2, relaxation=0.8`. What is unset or `none` is left out.
pub(crate) fn settings_text(run: &RunRow, keys: &BTreeSet<String>) -> String {
    let word = |key: &String| match run.settings.get(key)? {
        Value::Null => None,
        Value::Bool(true) => Some(key.clone()),
        Value::Bool(false) => Some(format!("no {key}")),
        Value::String(text) if text == "none" => None,
        Value::String(text) => Some(text.clone()),
        value => Some(format!("{key}={value}")),
    };
    keys.iter().filter_map(word).collect::<Vec<_>>().join(", ")
}
