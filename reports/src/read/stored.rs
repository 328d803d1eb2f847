//! From the rows of a study as they are stored to those that everything else reads.

use std::collections::BTreeMap;

use results::schema::{Ending, Run};
use results::study::{Runs, Study as Stored};
use serde_json::{Map, Value};

use super::groups::{differing, settings_text};
use super::run::RunRow;
use super::scene::scenes;
use super::{Problems, Simulation, Study};

impl From<&Stored> for Study {
    fn from(study: &Stored) -> Self {
        match study {
            Stored::Runs(runs) => Self::Problems(runs.into()),
            Stored::Simulations(all) => {
                let mut all: Vec<Simulation> = all.iter().map(Simulation::of).collect();
                let runs = all.iter().filter(|one| one.is_run());
                let differing = differing(runs.map(|run| (&run.method, &run.settings)), &[]);
                for one in &mut all {
                    one.words = settings_text((&one.method, &one.settings), &differing);
                }
                Self::Simulations(all)
            }
        }
    }
}

impl From<&Runs> for Problems {
    fn from(study: &Runs) -> Self {
        let rows = (0..).zip(&study.records).map(|(number, record)| RunRow::of(number, record));
        let (given, mut runs): (Vec<RunRow>, Vec<RunRow>) = rows.partition(|row| row.status == Ending::Given);
        let differing = differing(runs.iter().map(|run| (&run.method, &run.settings)), &[]);
        let some_begin_cold = runs.iter().any(|run| !run.warm_start);
        for run in &mut runs {
            let start = (run.warm_start && some_begin_cold).then(|| "warm start".to_owned());
            run.set = settings_text((&run.method, &run.settings), &differing);
            let settings = Some(run.set.clone()).filter(|text| !text.is_empty());
            run.words = settings.into_iter().chain(start).collect::<Vec<_>>().join(", ");
        }
        Self { runs, given, scenes: scenes(&study.grains, &study.contacts) }
    }
}

/// A run by the names of its columns, as a template asks for them; what a column holds as JSON is an object.
pub(crate) fn by_column(run: &Run) -> Result<BTreeMap<String, Value>, serde_json::Error> {
    let fields: Map<String, Value> = serde_json::from_value(serde_json::to_value(run)?)?;
    let mut row = BTreeMap::new();
    for (name, field) in fields {
        match field {
            Value::Object(part) => row.extend(part),
            value => drop(row.insert(name, value)),
        }
    }
    let objects = [
        ("problem_settings", &run.problem_settings),
        ("settings", &run.settings),
        ("derived", &run.derived),
        ("spectrum", &run.spectrum),
    ];
    row.extend(objects.map(|(name, object)| (name.to_owned(), Value::Object(object.clone()))));
    Ok(row)
}
