//! Hazards: problems of one case that are hard for one reason, and the values that vary among them.

use serde_json::{Map, Value};

use crate::read::{RunRow, find_or_push, problems, unique};

/// The problems of one case that replace the same values of it.
pub(crate) struct Hazard {
    /// Name of the case; of a problem alone its own.
    pub(crate) name: String,
    /// Values that differ among the problems.
    pub(crate) setting: String,
    pub(crate) problems: Vec<String>,
}

/// The problems of the study in its order, by hazard.
pub(crate) fn hazards(runs: &[RunRow]) -> Vec<Hazard> {
    let mut all: Vec<(Hazard, Vec<&Map<String, Value>>)> = Vec::new();
    for problem in problems(runs) {
        let Some(run) = runs.iter().find(|run| run.problem == problem) else { continue };
        let settings = &run.problem_settings;
        let name = run.case().unwrap_or(problem);
        let same = |(hazard, others): &(Hazard, Vec<&Map<String, Value>>)| {
            hazard.name == name && others[0].keys().eq(settings.keys())
        };
        let new =
            || (Hazard { name: name.to_owned(), setting: String::new(), problems: Vec::new() }, Vec::new());
        let (hazard, others) = find_or_push(&mut all, same, new);
        hazard.problems.push(problem.to_owned());
        others.push(settings);
    }
    let varied = |(mut hazard, settings): (Hazard, Vec<&Map<String, Value>>)| {
        let setting = |key: &String| {
            let values = unique(settings.iter().map(|settings| settings[key].to_string()));
            let key = key.rsplit_once('.').map_or(key.as_str(), |(_, last)| last);
            (values.len() > 1).then(|| format!("{key} {}", values.join(", ")))
        };
        if let [problem] = &hazard.problems[..] {
            problem.clone_into(&mut hazard.name);
        }
        hazard.setting = settings[0].keys().filter_map(setting).collect::<Vec<_>>().join("; ");
        hazard
    };
    all.into_iter().map(varied).collect()
}
