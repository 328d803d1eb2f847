//! A plan of simulations: which it asks for, each with its identity and its part in the study.

use crate::identity::{code_version, first_hex};
use crate::plan::rules::Rule;
use crate::plan::variants::Variant;
use crate::problems::planned::PlannedProblem;
use crate::problems::scene::Scene;
use crate::study::selection::Selection;
use anyhow::{Context, Result};
use cases::March;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashMap, HashSet};

/// A study through time and all that it names.
pub(crate) struct Study {
    pub(crate) selection: Selection,
    rules: Vec<Rule>,
    /// Each scene once, with a time step shorter than any of the plan.
    refined: Vec<Scene>,
    /// What solves the references, and until when.
    reference: (Variant, Rule),
}

/// One simulation that a study asks for.
#[derive(Clone)]
pub(crate) struct Task<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) variant: &'s Variant,
    pub(crate) rule: Rule,
    /// Its part in the study, as the column `role` says it.
    pub(crate) role: &'static str,
    pub(crate) id: String,
}

impl Study {
    pub(crate) fn new(selection: Selection) -> Result<Self> {
        let simulate = selection.plan.simulate.as_ref().context("the plan has no table [simulate]")?;
        let mut shortest: Vec<&Scene> = Vec::new();
        for scene in selection.problems.iter().filter_map(PlannedProblem::scene) {
            let h = |scene: &Scene| scene.case.scene.time_step_s;
            match shortest.iter_mut().find(|other| other.name == scene.name) {
                Some(other) if h(other) > h(scene) => *other = scene,
                Some(_) => {}
                None => shortest.push(scene),
            }
        }
        let refine = simulate.reference.refine.get();
        let refined = shortest.into_iter().map(|scene| scene.refined(refine)).collect::<Result<_>>()?;
        let reference = simulate.reference(&selection.plan.stop)?;
        let rules = selection.plan.rules()?.into_iter().map(|(rule, _)| rule).collect();
        Ok(Self { selection, rules, refined, reference })
    }

    /// The scenes of the plan, with the names that `--only` knows.
    fn scenes(&self) -> impl Iterator<Item = (&str, &Scene)> {
        self.selection.problems.iter().filter_map(|problem| Some((problem.name.as_str(), problem.scene()?)))
    }

    /// Whether a simulation is to be made: a run that is asked for, or what such runs are compared with.
    pub(crate) fn selects(&self, task: &Task) -> bool {
        let (selection, is_run) = (&self.selection, task.role == "run");
        let variants = || selection.variants.iter().filter(|v| !is_run || std::ptr::eq(*v, task.variant));
        let same = |scene: &Scene| {
            if is_run { std::ptr::eq(scene, task.scene) } else { scene.name == task.scene.name }
        };
        let mut scenes = self.scenes().filter(|(_, scene)| same(scene));
        scenes.any(|(name, _)| variants().any(|variant| selection.selects(name, variant)))
    }

    /// Every simulation: references and their twins, floors, then the runs in the order of the plan.
    pub(crate) fn tasks(&self) -> Result<Vec<Task<'_>>> {
        let (method, tight) = &self.reference;
        let mut loose = *tight;
        loose.stop.tolerance *= 10.0;
        let mut tasks = Vec::new();
        for scene in &self.refined {
            tasks.push(task(scene, method, *tight, "reference")?);
            tasks.push(task(scene, method, loose, "twin")?);
        }
        for (_, scene) in self.scenes() {
            tasks.push(task(scene, method, *tight, "floor")?);
        }
        for (_, scene) in self.scenes() {
            for variant in &self.selection.variants {
                for rule in &self.rules {
                    tasks.push(task(scene, variant, *rule, "run")?);
                }
            }
        }
        Ok(tasks)
    }
}

fn task<'s>(scene: &'s Scene, variant: &'s Variant, rule: Rule, role: &'static str) -> Result<Task<'s>> {
    let march = code_version::<March>().context("the crate `cases` has no version")?;
    let method = &variant.method;
    // Sorted, whatever the map of the JSON crate does with its keys.
    let settings: BTreeMap<_, _> = method.settings.iter().collect();
    let time = [scene.time_steps, scene.every];
    let all = json!([scene.hash, time, method.name, method.code, settings, rule.keys(), march]);
    let id = first_hex(Sha256::digest(all.to_string()).as_slice());
    Ok(Task { scene, variant, rule, role, id })
}

/// The tasks whose id is not in `done`, each once.
pub(crate) fn missing<'s>(tasks: &[Task<'s>], done: &HashSet<&str>) -> Vec<Task<'s>> {
    let mut known = HashSet::new();
    let lacks = |task: &&Task| !done.contains(task.id.as_str()) && known.insert(task.id.clone());
    tasks.iter().filter(lacks).cloned().collect()
}

/// The simulations that count, by id: of two, the later.
pub(crate) fn by_id(
    records: &[results::simulation::Simulated],
) -> HashMap<&str, &results::simulation::Simulated> {
    records.iter().map(|record| (record.simulation.id.as_str(), record)).collect()
}

impl Task<'_> {
    /// The simulation, as it is told to the user.
    pub(crate) fn name(&self) -> String {
        format!("{} on {}, {}", self.variant.label(), self.scene.name, self.rule())
    }

    /// Its time step, and until when each is solved from what.
    pub(crate) fn rule(&self) -> String {
        let start = if self.rule.warm_start { "" } else { ", cold" };
        let (h, stop) = (self.scene.case.scene.time_step_s, &self.rule.stop);
        format!("h = {h} s, {} ≤ {:e}{start}", stop.on, stop.tolerance)
    }
}
