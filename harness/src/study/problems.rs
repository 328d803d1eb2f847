//! A study of problems: every variant on every problem is a run.

use crate::identity::{code_version, first_hex};
use crate::plan::variants::Variant;
use crate::problems::files::Root;
use crate::problems::planned::{PlannedProblem, Problem};
use crate::run::execute::Conditions;
use crate::run::problem::{Wanted, run};
use crate::run::rows::{given_row, partitions, scene_rows};
use crate::study::selection::Selection;
use crate::study::tasks::{Kind, Listed, Task};
use anyhow::Result;
use contact::Measure;
use partition::Partition;
use reference::InteriorPoint;
use results::journal::Record;
use results::schema::{Provenance, Run};
use results::study::{Runs, Study as Rows};
use runner::Stop;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashSet};

/// A plan with those of its problems that are there: all that runs need, and others that need not be made.
pub(crate) struct OnProblems {
    selection: Selection,
    problems: Vec<Problem>,
}

impl Kind for OnProblems {
    type Record = Record;
    type What<'s> = &'s Problem;
    const TASKS: &'static str = "runs";

    fn new(selection: Selection, root: &Root, make: bool) -> Result<Self> {
        let needed = |problem: &PlannedProblem| {
            selection.variants.iter().any(|variant| selection.selects(&problem.name, variant))
        };
        let mut problems = Vec::new();
        for problem in &selection.problems {
            let there =
                if make && needed(problem) { Some(problem.made(root)?) } else { problem.at_hand(root) };
            problems.extend(there);
        }
        Ok(Self { selection, problems })
    }

    fn selection(&self) -> &Selection {
        &self.selection
    }

    fn repeats(&self, wanted: Option<u32>) -> Result<u32> {
        Ok(wanted.unwrap_or(self.selection.plan.repeats.get()))
    }

    fn tasks(&self) -> Result<Vec<Task<'_, Self>>> {
        let mut tasks = Vec::new();
        for problem in &self.problems {
            for variant in &self.selection.variants {
                let id = run_id(&problem.hash, variant, &self.selection.plan.stop);
                let selected = self.selection.selects(&problem.frozen.name, variant);
                tasks.push(Task { id, variant, selected, what: problem });
            }
        }
        Ok(tasks)
    }

    fn run(&self, task: &Task<Self>, conditions: &Conditions) -> Result<Option<Record>> {
        let (plan, problem, variant) = (&self.selection.plan, task.what, task.variant);
        run(&Wanted { plan, problem, variant, id: &task.id }, conditions)
    }

    fn size(&self) -> Result<usize> {
        Ok(self.selection.problems.len() * self.selection.variants.len())
    }

    fn asks(&self) -> Result<String> {
        Ok(format!("{} runs, {} on each problem", self.size()?, self.selection.variants.len()))
    }

    fn listed(&self, done: &HashSet<&str>) -> Result<Vec<Listed>> {
        // A problem that is not there has no run that has ended.
        let ended: HashSet<(&str, &str, &str)> = self
            .tasks()?
            .iter()
            .filter(|task| done.contains(task.id.as_str()))
            .map(|task| (&*task.what.frozen.name, task.variant.method.name, &*task.variant.name))
            .collect();
        let listed = |(problem, variant): (&PlannedProblem, &Variant)| Listed {
            problem: problem.name.clone(),
            method: variant.method.name.to_owned(),
            variant: variant.name.clone(),
            done: ended.contains(&(&*problem.name, variant.method.name, &*variant.name)),
        };
        Ok(self.selection.selected().map(listed).collect())
    }

    fn rows(&self, root: &Root, ended: Vec<(Task<Self>, Record)>, provenance: &Provenance) -> Result<Rows> {
        let plan = &self.selection.plan;
        let named = |(task, record): (Task<Self>, Record)| Record {
            run: Run {
                plan: plan.name.clone(),
                problem: task.what.frozen.name.clone(),
                problem_settings: task.what.settings.clone(),
                variant: task.variant.name.clone(),
                ..record.run
            },
            ..record
        };
        let mut rows = Runs { records: ended.into_iter().map(named).collect(), ..Runs::default() };
        for problem in &self.problems {
            if let Some(given) = &problem.given {
                let run = given_row(plan, problem, given, problem.known(root)?.truth(), provenance);
                rows.records.push(Record { run, curve: Vec::new(), snapshots: Vec::new() });
            }
        }
        let partitions = partitions(&self.selection.variants);
        // Without a partition there is nothing to draw.
        let drawn = plan.reference && !partitions.is_empty();
        for problem in self.problems.iter().filter(|_| drawn) {
            let impulses = problem.known(root)?.impulses();
            for (name, grid, scheme) in &partitions {
                // Runs with a partition that does not fit the problem were skipped.
                if let Ok(partition) = Partition::of_contacts(&problem.frozen.problem, *scheme, *grid) {
                    let (grains, contacts) = scene_rows(&problem.frozen, name, &partition, impulses);
                    rows.grains.extend(grains);
                    rows.contacts.extend(contacts);
                }
            }
        }
        Ok(Rows::Runs(rows))
    }
}

/// The same id means the same counts: on any machine, with any number of threads.
pub(crate) fn run_id(problem_hash: &str, variant: &Variant, stop: &Stop) -> String {
    let Variant { method, warm_start, .. } = variant;
    // Sorted, whatever the map of the JSON crate does with its keys.
    let settings: BTreeMap<_, _> = method.settings.iter().collect();
    // What stops on the error needs the solution, and whether ζ lied is judged by it.
    let truth = matches!(stop.on, Measure::VelocityError | Measure::Zeta).then(code_version::<InteriorPoint>);
    let stop = (stop.on, stop.tolerance, stop.max_iterations);
    let all = json!([problem_hash, method.name, method.code, settings, stop, warm_start, truth]);
    first_hex(Sha256::digest(all.to_string()).as_slice())
}
