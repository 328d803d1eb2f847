//! A study through time: every variant on every scene under every rule is a simulation; and so are those that they are
//! compared with.

use crate::identity::code_version;
use crate::plan::{Rule, Variant};
use crate::problems::{PlannedProblem, Scene};
use crate::root::Root;
use crate::run::{Conditions, Task, Through, run_simulation};
use crate::study::{Kind, Listed, Selection, missing};
use anyhow::{Context, Result};
use lineup::hash_of;
use results::simulation::{Role, Simulated};
use results::study::Study as Rows;
use serde_json::json;
use std::collections::{BTreeMap, HashSet};

/// A study through time and all that it names.
pub(crate) struct ThroughTime {
    selection: Selection,
    rules: Vec<Rule>,
    /// Each scene once, with a time step shorter than any of the plan; none without references.
    refined: Vec<Scene>,
    /// Variant that computes the references, and its rule, if they are asked for.
    reference: Option<(Variant, Rule)>,
    /// Version of the code of the march.
    march: &'static str,
}

impl ThroughTime {
    /// The scenes of the plan, with the names that `--only` knows.
    fn scenes(&self) -> impl Iterator<Item = (&str, &Scene)> {
        self.selection.problems.iter().filter_map(|problem| Some((problem.name.as_str(), problem.scene()?)))
    }

    /// Reports whether a simulation is selected: a run, or the reference of selected runs.
    fn selects(&self, scene: &Scene, variant: &Variant, role: Role) -> bool {
        let (selection, is_run) = (&self.selection, role == Role::Run);
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
        role: Role,
    ) -> Task<'s, Through<'s>> {
        let method = &variant.method;
        // Sorted, whatever the map of the JSON crate does with its keys.
        let settings: BTreeMap<_, _> = method.settings.iter().collect();
        let time = [scene.time_steps, scene.every];
        let all = json!([scene.hash, time, method.name, method.code(), settings, rule.keys(), self.march]);
        let selected = self.selects(scene, variant, role);
        Task { id: hash_of(&all), variant, selected, what: Through { scene, rule, role } }
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
        let refined = simulate.reference.as_ref().map(|reference| {
            shortest.into_iter().map(|scene| scene.refined(reference.refine.get())).collect::<Result<_>>()
        });
        let refined = refined.transpose()?.unwrap_or_default();
        let reference = simulate.reference(&selection.plan.stop)?;
        let rules = selection.plan.rules()?.into_iter().map(|(rule, _)| rule).collect();
        let march = code_version("cases").context("the crate `cases` has no version")?;
        Ok(Self { selection, rules, refined, reference, march })
    }

    fn selection(&self) -> &Selection {
        &self.selection
    }

    /// References and their twins, floors, then the runs in the order of the plan.
    fn tasks(&self) -> Vec<Task<'_, Through<'_>>> {
        let mut tasks = Vec::new();
        if let Some((method, tight)) = &self.reference {
            let mut loose = *tight;
            loose.stop.tolerance *= 10.0;
            for scene in &self.refined {
                tasks.push(self.task(scene, method, *tight, Role::Reference));
                tasks.push(self.task(scene, method, loose, Role::Twin));
            }
            for (_, scene) in self.scenes() {
                tasks.push(self.task(scene, method, *tight, Role::Floor));
            }
        }
        for (name, scene) in self.scenes() {
            for variant in self.selection.variants.iter().filter(|variant| variant.meets(name)) {
                tasks.extend(self.rules.iter().map(|rule| self.task(scene, variant, *rule, Role::Run)));
            }
        }
        tasks
    }

    fn run(&self, task: &Task<Through>, conditions: &Conditions) -> Result<Option<Simulated>> {
        run_simulation(&self.selection.plan.name, task, conditions)
    }

    fn size(&self) -> usize {
        missing(&self.tasks(), &HashSet::new()).len()
    }

    fn asks(&self) -> String {
        let tasks = self.tasks();
        let runs = tasks.iter().filter(|task| task.what.role == Role::Run).count();
        match tasks.len() - runs {
            0 => format!("{runs} simulations"),
            others => format!("{runs} simulations, and {others} to compare them with"),
        }
    }

    fn listed(&self, done: &HashSet<&str>) -> Vec<Listed> {
        let listed = |task: Task<Through>| Listed {
            problem: task.what.scene.name.clone(),
            method: task.variant.method.name,
            variant: format!("{} {}", task.variant.name, task.what.in_words()),
            done: done.contains(task.id.as_str()),
        };
        self.tasks().into_iter().filter(|task| task.selected).map(listed).collect()
    }

    fn rows(&self, _: &Root, ended: Vec<(Task<Through>, Simulated)>) -> Result<Rows> {
        let mut rows = Vec::new();
        for (Task { variant, what: Through { scene, role, .. }, .. }, mut simulated) in ended {
            let simulation = &mut simulated.simulation;
            simulation.plan.clone_from(&self.selection.plan.name);
            simulation.scene.clone_from(&scene.name);
            simulation.variant.clone_from(&variant.name);
            simulation.role = role;
            rows.push(simulated);
        }
        Ok(Rows::Simulations(rows))
    }
}
