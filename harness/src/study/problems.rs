//! A study of problems: every variant on every problem is a run.

use crate::identity::{code_version, provenance};
use crate::plan::Variant;
use crate::problems::{PlannedProblem, Problem};
use crate::root::Root;
use crate::run::{Conditions, Task, given_row, partitions, run_on_problem, scene_rows};
use crate::study::{Kind, Listed, Selection};
use anyhow::Result;
use contact::Measure;
use lineup::{Posed, hash_of};
use results::journal::Record;
use results::study::{Runs, Study as Rows};
use runner::Stop;
use serde_json::json;
use std::collections::{BTreeMap, HashSet};

/// A plan with those of its problems that are there: all that runs need, and others that need not be computed.
pub(crate) struct OnProblems {
    selection: Selection,
    problems: Vec<Problem>,
}

impl Kind for OnProblems {
    type Record = Record;
    type What<'s> = &'s Problem;
    const TASKS: &'static str = "runs";

    fn new(selection: Selection, root: &Root, compute: bool) -> Result<Self> {
        let needed = |problem: &PlannedProblem| {
            let mut met = selection.variants.iter().filter(|variant| variant.meets(&problem.name));
            met.any(|variant| selection.selects(&problem.name, variant))
        };
        let mut problems = Vec::new();
        for problem in &selection.problems {
            problems.extend(problem.problem(root, compute && needed(problem))?);
        }
        Ok(Self { selection, problems })
    }

    fn selection(&self) -> &Selection {
        &self.selection
    }

    fn tasks(&self) -> Vec<Task<'_, &Problem>> {
        let mut tasks = Vec::new();
        for what in &self.problems {
            let met = self.selection.variants.iter().filter(|variant| variant.meets(&what.name));
            tasks.extend(met.map(|variant| Task {
                id: self.run_id(what, variant),
                variant,
                selected: self.selection.selects(&what.name, variant),
                what,
            }));
        }
        tasks
    }

    fn run(&self, task: &Task<&Problem>, conditions: &Conditions) -> Result<Option<Record>> {
        run_on_problem(&self.selection.plan, task, conditions)
    }

    fn size(&self) -> usize {
        self.selection.runs()
    }

    fn asks(&self) -> String {
        let (size, variants) = (self.size(), self.selection.variants.len());
        let most = if size == variants * self.selection.problems.len() { "" } else { "at most " };
        format!("{size} runs, {most}{variants} on each problem")
    }

    fn listed(&self, done: &HashSet<&str>) -> Vec<Listed> {
        // A problem that is not there has no run that has ended.
        let there = |name: &str| self.problems.iter().find(|problem| problem.name == name);
        let listed = |(problem, variant): (&PlannedProblem, &Variant)| Listed {
            problem: problem.name.clone(),
            method: variant.method.name,
            variant: variant.name.clone(),
            done: there(&problem.name).is_some_and(|there| done.contains(&*self.run_id(there, variant))),
        };
        self.selection.selected().map(listed).collect()
    }

    fn rows(&self, root: &Root, ended: Vec<(Task<&Problem>, Record)>) -> Result<Rows> {
        let plan = &self.selection.plan;
        let mut rows = Runs::default();
        for (Task { variant, what: problem, .. }, mut record) in ended {
            record.run.plan.clone_from(&plan.name);
            record.run.problem.clone_from(&problem.name);
            record.run.problem_settings.clone_from(&problem.settings);
            record.run.variant.clone_from(&variant.name);
            rows.records.push(record);
        }
        for problem in &self.problems {
            if let Some(run) = given_row(plan, problem, root, provenance()?)? {
                rows.records.push(Record { run, curve: Vec::new(), snapshots: Vec::new() });
            }
        }
        let partitions = partitions(&self.selection.variants);
        // Without a partition there is nothing to draw.
        let drawn = plan.reference && !partitions.is_empty();
        for problem in self.problems.iter().filter(|_| drawn) {
            let Posed::Grains(posed) = &problem.posed else { continue };
            let r = problem.known(root)?.impulses.first().map(Vec::as_slice);
            let (grains, contacts) = scene_rows((&problem.name, &**posed), &partitions, r);
            rows.grains.extend(grains);
            rows.contacts.extend(contacts);
        }
        Ok(Rows::Runs(rows))
    }
}

impl OnProblems {
    fn run_id(&self, problem: &Problem, variant: &Variant) -> String {
        run_id(&problem.hash, variant, &self.selection.plan.stop)
    }
}

/// Returns the id of a run. Equal ids mean equal counts: on any machine, with any number of threads.
pub(crate) fn run_id(problem_hash: &str, variant: &Variant, stop: &Stop) -> String {
    let Variant { method, warm_start, .. } = variant;
    // Sorted, whatever the map of the JSON crate does with its keys.
    let settings: BTreeMap<_, _> = method.settings.iter().collect();
    // What stops on the error needs the solution, and whether ζ lied is judged by it.
    let truth = matches!(stop.on, Measure::VelocityError | Measure::Zeta).then(|| code_version("reference"));
    let stop = (stop.on, stop.tolerance, stop.max_iterations);
    hash_of(&json!([problem_hash, method.name, method.code(), settings, stop, warm_start, truth]))
}
