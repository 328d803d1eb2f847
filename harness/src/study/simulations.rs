//! A study through time: every variant on every scene under every rule is a simulation; and so are those that they are
//! compared with.

use crate::identity::{code_version, first_hex};
use crate::plan::rules::Rule;
use crate::plan::variants::Variant;
use crate::problems::files::Root;
use crate::problems::planned::PlannedProblem;
use crate::problems::scene::Scene;
use crate::run::execute::Conditions;
use crate::run::simulation::{Wanted, run};
use crate::study::selection::Selection;
use crate::study::tasks::{Kind, Listed, Task, missing};
use anyhow::{Context, Result, bail};
use cases::March;
use results::schema::Provenance;
use results::simulation::{Simulated, Simulation};
use results::study::Study as Rows;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashSet};

/// A study through time and all that it names.
pub(crate) struct ThroughTime {
    selection: Selection,
    rules: Vec<Rule>,
    /// Each scene once, with a time step shorter than any of the plan.
    refined: Vec<Scene>,
    /// What solves the references, and until when.
    reference: (Variant, Rule),
}

/// A scene through time.
#[derive(Clone, Copy)]
pub(crate) struct Through<'s> {
    scene: &'s Scene,
    rule: Rule,
    /// Its part in the study, as the column `role` says it.
    role: &'static str,
}

impl ThroughTime {
    /// The scenes of the plan, with the names that `--only` knows.
    fn scenes(&self) -> impl Iterator<Item = (&str, &Scene)> {
        self.selection.problems.iter().filter_map(|problem| Some((problem.name.as_str(), problem.scene()?)))
    }

    /// Whether a simulation is selected: a run that is asked for, or what such runs are compared with.
    fn selects(&self, scene: &Scene, variant: &Variant, role: &str) -> bool {
        let (selection, is_run) = (&self.selection, role == "run");
        let variants = || selection.variants.iter().filter(|v| !is_run || std::ptr::eq(*v, variant));
        let same = |other: &Scene| if is_run { std::ptr::eq(other, scene) } else { other.name == scene.name };
        let mut scenes = self.scenes().filter(|(_, other)| same(other));
        scenes.any(|(name, _)| variants().any(|variant| selection.selects(name, variant)))
    }

    fn task<'s>(
        &'s self,
        scene: &'s Scene,
        variant: &'s Variant,
        rule: Rule,
        role: &'static str,
    ) -> Result<Task<'s, Self>> {
        let march = code_version::<March>().context("the crate `cases` has no version")?;
        let method = &variant.method;
        // Sorted, whatever the map of the JSON crate does with its keys.
        let settings: BTreeMap<_, _> = method.settings.iter().collect();
        let time = [scene.time_steps, scene.every];
        let all = json!([scene.hash, time, method.name, method.code, settings, rule.keys(), march]);
        let id = first_hex(Sha256::digest(all.to_string()).as_slice());
        let selected = self.selects(scene, variant, role);
        Ok(Task { id, variant, selected, what: Through { scene, rule, role } })
    }
}

impl Kind for ThroughTime {
    type Record = Simulated;
    type What<'s> = Through<'s>;
    const TASKS: &'static str = "simulations";

    fn new(selection: Selection, _: &Root, _: bool) -> Result<Self> {
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

    fn selection(&self) -> &Selection {
        &self.selection
    }

    fn repeats(&self, wanted: Option<u32>) -> Result<u32> {
        if wanted.is_some_and(|repeats| repeats > 1) {
            bail!("--repeats: a simulation is run once; its seconds are those of many time steps");
        }
        Ok(1)
    }

    /// References and their twins, floors, then the runs in the order of the plan.
    fn tasks(&self) -> Result<Vec<Task<'_, Self>>> {
        let (method, tight) = &self.reference;
        let mut loose = *tight;
        loose.stop.tolerance *= 10.0;
        let mut tasks = Vec::new();
        for scene in &self.refined {
            tasks.push(self.task(scene, method, *tight, "reference")?);
            tasks.push(self.task(scene, method, loose, "twin")?);
        }
        for (_, scene) in self.scenes() {
            tasks.push(self.task(scene, method, *tight, "floor")?);
        }
        for (_, scene) in self.scenes() {
            for variant in &self.selection.variants {
                for rule in &self.rules {
                    tasks.push(self.task(scene, variant, *rule, "run")?);
                }
            }
        }
        Ok(tasks)
    }

    fn run(&self, task: &Task<Self>, conditions: &Conditions) -> Result<Option<Simulated>> {
        let Through { scene, rule, role } = task.what;
        let name = format!("{} on {}, {}", task.variant.label(), scene.name, task.what.in_words());
        let (plan, variant, id) = (&self.selection.plan.name, task.variant, &task.id);
        run(&Wanted { plan, scene, variant, rule, role, id, name }, conditions)
    }

    fn size(&self) -> Result<usize> {
        Ok(missing(&self.tasks()?, &HashSet::new()).len())
    }

    fn asks(&self) -> Result<String> {
        let tasks = self.tasks()?;
        let runs = tasks.iter().filter(|task| task.what.role == "run").count();
        Ok(format!("{runs} simulations, and {} to compare them with", tasks.len() - runs))
    }

    fn listed(&self, done: &HashSet<&str>) -> Result<Vec<Listed>> {
        let listed = |task: Task<Self>| Listed {
            problem: task.what.scene.name.clone(),
            method: task.variant.method.name.to_owned(),
            variant: format!("{} {}", task.variant.name, task.what.in_words()),
            done: done.contains(task.id.as_str()),
        };
        Ok(self.tasks()?.into_iter().filter(|task| task.selected).map(listed).collect())
    }

    fn rows(&self, _: &Root, ended: Vec<(Task<Self>, Simulated)>, _: &Provenance) -> Result<Rows> {
        let named = |(task, simulated): (Task<Self>, Simulated)| {
            let simulation = Simulation {
                plan: self.selection.plan.name.clone(),
                scene: task.what.scene.name.clone(),
                variant: task.variant.name.clone(),
                role: task.what.role.to_owned(),
                ..simulated.simulation
            };
            Simulated { simulation, ..simulated }
        };
        Ok(Rows::Simulations(ended.into_iter().map(named).collect()))
    }
}

impl Through<'_> {
    /// Its time step, and until when each is solved from what.
    fn in_words(&self) -> String {
        let start = if self.rule.warm_start { "" } else { ", cold" };
        let (h, stop) = (self.scene.case.scene.time_step_s, &self.rule.stop);
        format!("h = {h} s, {} ≤ {:e}{start}", stop.on, stop.tolerance)
    }
}
