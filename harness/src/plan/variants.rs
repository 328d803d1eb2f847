//! The methods of a plan: every combination of their settings is a variant, named by what sets it apart, and no more.

use crate::plan::{Method, Plan, Settings, combinations};
use crate::terminal::suggest;
use anyhow::{Context, Result, bail};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use wildmatch::WildMatch;

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
    /// True where its runs begin from the impulses of the time step before; `[false, true]` for both.
    #[serde(default)]
    pub(crate) warm_start: Option<WarmStart>,
    /// Names of the problems that it meets, in which `*` stands for any text; all of them without any.
    #[serde(default)]
    pub(crate) problems: Vec<String>,
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
    /// Patterns of the problems that it meets; all of them without any.
    pub(crate) problems: Vec<String>,
}

impl Variant {
    /// Reports whether the plan asks for its run on a problem.
    pub(crate) fn meets(&self, problem: &str) -> bool {
        self.problems.is_empty()
            || self.problems.iter().any(|pattern| WildMatch::new(pattern).matches(problem))
    }

    /// Method and variant, as a figure names them.
    pub(crate) fn label(&self) -> String {
        format!("{} {}", self.method.name, self.name).trim_end().to_owned()
    }
}

impl Plan {
    /// Every method with every combination of its axes, in the order of the plan. Each of `changes` replaces a setting of
    /// every method that has it; runs that are the same then are one.
    pub(crate) fn variants(&self, changes: &[(String, String)]) -> Result<Vec<Variant>> {
        let mut methods: Vec<(Method, bool)> = Vec::new();
        let mut met: Vec<Vec<String>> = Vec::new();
        let mut seen = HashMap::new();
        let mut unused: Vec<&(String, String)> = changes.iter().collect();
        for planned in &self.methods {
            for (method, warm_start) in planned.methods(self.warm_start.is_warm())? {
                let (known, changed) = (method.settings.clone(), method.changed(changes)?);
                unused.retain(|(key, _)| !known.contains_key(key));
                let settings = Value::Object(changed.settings.clone()).to_string();
                let index = *seen.entry((changed.name, settings, warm_start)).or_insert(methods.len());
                if index == methods.len() {
                    methods.push((changed, warm_start));
                    met.push(planned.problems.clone());
                    continue;
                }
                // Apart only by their problems, or by what was changed.
                let both: &mut Vec<String> = &mut met[index];
                let all = both.is_empty() || planned.problems.is_empty();
                let apart = !all && !planned.problems.iter().any(|pattern| both.contains(pattern));
                if changes.is_empty() && !apart {
                    bail!("method `{}`: two runs have the settings {}", method.name, Value::Object(known));
                }
                both.extend(planned.problems.iter().cloned());
                if all {
                    both.clear();
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
        let names = of_variants(&methods);
        let variant =
            |(((method, warm_start), name), problems)| Variant { method, warm_start, name, problems };
        Ok(methods.into_iter().zip(names).zip(met).map(variant).collect())
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

/// Returns, for each method, the settings in which it differs from the others of the same name: the value where there is one
/// such setting, as `4x2`; with several of them, `key=value` of each that is not left open. Then whether it begins warm, if
/// some other begins cold.
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

/// Returns, for each of `keys`, such as `scene.box.width_m`, its last part where no other of them ends so.
pub(crate) fn last_parts<'k>(keys: &[&'k str]) -> Vec<&'k str> {
    let last = |key: &'k str| key.rsplit_once('.').map_or(key, |(_, last)| last);
    let alone = |key: &str| keys.iter().filter(|other| last(other) == key).count() == 1;
    keys.iter().map(|key| if alone(last(key)) { last(key) } else { *key }).collect()
}
