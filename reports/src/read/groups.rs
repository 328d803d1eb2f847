//! Runs that belong together: those of a method that agree in all settings but some.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use crate::families::METHODS;

/// Methods, each with a setting, other than those in `except`, in which some of its runs differ.
pub(crate) fn differing<'r>(
    runs: impl IntoIterator<Item = (&'r String, &'r Map<String, Value>)>,
    except: &[&str],
) -> BTreeSet<(String, String)> {
    let mut first = BTreeMap::new();
    let mut differing = BTreeSet::new();
    for (method, settings) in runs {
        let first: &Map<String, Value> = first.entry(method).or_insert(settings);
        for (key, value) in settings {
            if first.get(key) != Some(value) && !except.contains(&key.as_str()) {
                differing.insert((method.clone(), key.clone()));
            }
        }
    }
    differing
}

/// Writes those settings of a run that are in `keys`: `4x2`, `4x2, relaxation=0.8`; the name of a method with its key, as in
/// `start=cg`. What is unset or `none` is left out.
pub(crate) fn settings_text(
    (method, settings): (&str, &Map<String, Value>),
    keys: &BTreeSet<(String, String)>,
) -> String {
    let word = |(_, key): &(String, String)| match settings.get(key)? {
        Value::Null => None,
        Value::Bool(true) => Some(key.clone()),
        Value::Bool(false) => Some(format!("no {key}")),
        Value::String(text) if text == "none" => None,
        Value::String(text) if METHODS.iter().any(|(method, _)| method == text) => {
            Some(format!("{key}={text}"))
        }
        Value::String(text) => Some(text.clone()),
        // A whole number has no fraction.
        value => Some(format!("{key}={}", value.as_f64().map_or(value.to_string(), |x| x.to_string()))),
    };
    keys.iter().filter(|(of, _)| of == method).filter_map(word).collect::<Vec<_>>().join(", ")
}
