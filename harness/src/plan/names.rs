//! Names of runs and of computed problems: what sets them apart, and no more.

use crate::plan::axes::Settings;
use crate::plan::methods::Method;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// For each method, the settings in which it differs from the others of the same name: the value where there is one such
/// setting, as `4x2`; with several of them, `key=value` of each that is not left open. Then whether it begins warm, if some
/// other begins cold.
pub(crate) fn of_variants(methods: &[(Method, bool)]) -> Vec<String> {
    let mut first: BTreeMap<&str, &Settings> = BTreeMap::new();
    let mut differing: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (Method { name, settings, .. }, _) in methods {
        let first = *first.entry(name).or_insert(settings);
        let differs = settings.iter().filter(|(key, value)| first.get(*key) != Some(*value));
        differing.entry(name).or_default().extend(differs.map(|(key, _)| key.as_str()));
    }
    let name = |Method { name, settings, .. }: &Method| {
        let keys = &differing[name];
        let set = || settings.iter().filter(|(key, value)| keys.contains(key.as_str()) && !value.is_null());
        match (keys.len(), set().next()) {
            (0, _) => String::new(),
            (_, None) => "default".to_owned(),
            (1, Some((_, value))) => short(value),
            _ => pairs(set().map(|(key, value)| (key.as_str(), value))),
        }
    };
    let some_begin_cold = methods.iter().any(|(_, warm_start)| !warm_start);
    let with_start =
        |(method, warm_start): &(Method, bool)| match (name(method), warm_start & some_begin_cold) {
            (name, false) => name,
            (name, true) if name.is_empty() => "warm start".to_owned(),
            (name, true) => name + ", warm start",
        };
    methods.iter().map(with_start).collect()
}

/// `key=value` of each, in their order.
pub(crate) fn pairs<'a>(settings: impl Iterator<Item = (&'a str, &'a Value)>) -> String {
    settings.map(|(key, value)| format!("{key}={}", short(value))).collect::<Vec<_>>().join(" ")
}

/// A value as it is typed: text without quotes.
pub(crate) fn as_typed(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// A value as it is read: text without quotes, a whole number without a fraction.
fn short(value: &Value) -> String {
    match value.as_f64() {
        // Of the shortest two, the one with fewer characters: 1000, but 1e-7.
        Some(x) => {
            let (plain, scientific) = (format!("{x}"), format!("{x:e}"));
            if scientific.len() < plain.len() && plain.len() > 5 { scientific } else { plain }
        }
        None => as_typed(value),
    }
}

/// For each of `keys`, such as `scene.box.width_m`, its last part where no other of them ends so.
pub(crate) fn last_parts<'k>(keys: &[&'k str]) -> Vec<&'k str> {
    let last = |key: &'k str| key.rsplit_once('.').map_or(key, |(_, last)| last);
    let alone = |key: &str| keys.iter().filter(|other| last(other) == key).count() == 1;
    keys.iter().map(|key| if alone(last(key)) { last(key) } else { *key }).collect()
}
