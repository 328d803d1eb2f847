//! Kinds of problem: those of a case that differ in their samples alone.

use serde_json::Value;

use crate::read::{RunRow, find_or_push, problems};

/// Problems that differ in their samples alone.
pub(crate) struct Kind<'r> {
    /// Values of the case that differ from kind to kind, sizes aside.
    pub(crate) name: String,
    /// Name of the case, or of a frozen problem.
    pub(crate) case: String,
    pub(crate) grains: u32,
    pub(crate) runs: Vec<&'r RunRow>,
}

impl Kind<'_> {
    /// Number of problems.
    pub(crate) fn problems(&self) -> usize {
        problems(self.runs.iter().copied()).len()
    }
}

/// Settings of a problem that make it another sample of its kind, or say its size.
fn is_of_the_sample(key: &str) -> bool {
    ["sample.seed", "sample.grains", "time_step", "missed_before", "march"].contains(&key)
        || key.starts_with("scene.box.")
}

/// The kinds of problem of a study, in its order; those of a size apart.
pub(crate) fn kinds(runs: &[RunRow]) -> Vec<Kind<'_>> {
    let mut kinds: Vec<Kind> = Vec::new();
    for run in runs {
        let settings = &run.problem_settings;
        let case = settings.get("case").and_then(Value::as_str).unwrap_or(&run.problem);
        let step = |key: &str| settings.get(key).map(|step| format!("time step {step}"));
        let moment = settings.get("moment").and_then(Value::as_str).map(str::to_owned);
        let others = settings
            .iter()
            .filter(|(key, _)| !["case", "moment"].contains(&key.as_str()) && !is_of_the_sample(key));
        // A whole number has no fraction.
        let shown = |value: &Value| value.as_f64().map_or(value.to_string(), |value| value.to_string());
        let others = others.map(|(key, value)| match key.as_str() {
            "scene.friction" => format!("μ = {}", shown(value)),
            key => format!("{} = {}", key.rsplit('.').next().unwrap_or(key), shown(value)),
        });
        let warm = run.warm_start.then(|| "warm".to_owned());
        let name = moment
            .or_else(|| step("time_step"))
            .into_iter()
            .chain(others)
            .chain(warm)
            .collect::<Vec<_>>()
            .join(", ");
        // Another sample of as many grains may have one more or less that touches.
        let grains =
            settings.get("sample.grains").and_then(Value::as_u64).map_or(run.grains, |grains| grains as u32);
        let same = |kind: &Kind| kind.name == name && kind.case == case && kind.grains == grains;
        let new = || Kind { name: name.clone(), case: case.to_owned(), grains, runs: Vec::new() };
        find_or_push(&mut kinds, same, new).runs.push(run);
    }
    kinds
}
