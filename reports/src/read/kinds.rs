//! Kinds of problem: those of a case that differ in their samples alone.

use results::settings::{CASE, FRICTION, KNOWN, MARCH, MISSED_BEFORE, MOMENT, TIME_STEP};
use serde_json::Value;

use crate::read::{RunRow, find_or_push, problems};

/// Setting of a case for its number of grains.
const GRAINS: &str = "sample.grains";

/// Problems that differ in their samples alone.
pub(crate) struct Kind<'r> {
    /// Values of the case that differ from kind to kind, sizes aside.
    pub(crate) name: String,
    /// Name of the case, or of a frozen problem.
    pub(crate) case: String,
    pub(crate) grains: u32,
    pub(crate) runs: Vec<&'r RunRow>,
}

impl RunRow {
    /// Returns the number of grains that was asked for: another sample of as many may have one more or less that touches.
    pub(crate) fn grains_asked(&self) -> u32 {
        let asked = self.problem_settings.get(GRAINS).and_then(Value::as_u64);
        asked.map_or(self.grains, |grains| grains as u32)
    }
}

impl Kind<'_> {
    /// Number of problems.
    pub(crate) fn problems(&self) -> usize {
        problems(self.runs.iter().copied()).len()
    }
}

/// Reports whether a setting of a problem makes it another sample of its kind, or says its size or how it was reached.
fn is_of_the_sample(key: &str) -> bool {
    ["sample.seed", GRAINS, CASE, TIME_STEP, MOMENT, MISSED_BEFORE, MARCH, KNOWN].contains(&key)
        || key.starts_with("scene.box.")
}

/// The kinds of problem of a study, in its order; those of a size apart.
pub(crate) fn kinds(runs: &[RunRow]) -> Vec<Kind<'_>> {
    // A whole number has no fraction.
    let shown = |value: &Value| value.as_f64().map_or(value.to_string(), |value| value.to_string());
    let mut kinds: Vec<Kind> = Vec::new();
    for run in runs {
        let settings = &run.problem_settings;
        let text = |key: &str| settings.get(key).and_then(Value::as_str);
        let case = run.case().unwrap_or(&run.problem);
        let step = || settings.get(TIME_STEP).map(|step| format!("time step {step}"));
        let when = text(MOMENT).map(str::to_owned).or_else(step);
        let others = settings.iter().filter(|(key, _)| !is_of_the_sample(key));
        let others = others.map(|(key, value)| match key.as_str() {
            FRICTION => format!("μ = {}", shown(value)),
            key => format!("{} = {}", key.rsplit('.').next().unwrap_or(key), shown(value)),
        });
        let warm = run.warm_start.then(|| "warm".to_owned());
        let name = when.into_iter().chain(others).chain(warm).collect::<Vec<_>>().join(", ");
        let grains = run.grains_asked();
        let same = |kind: &Kind| kind.name == name && kind.case == case && kind.grains == grains;
        let new = || Kind { name: name.clone(), case: case.to_owned(), grains, runs: Vec::new() };
        find_or_push(&mut kinds, same, new).runs.push(run);
    }
    kinds
}
