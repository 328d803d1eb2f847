//! Arguments that several commands share.

use crate::collection::Collection;
use crate::plan::{Method, Plan, all_typed, key_value, refuse_repeated};
use crate::problems::{CaseProblem, planned};
use crate::root::{Root, is_toml};
use crate::study::Selection;
use anyhow::{Context, Result, bail};
use cases::AnyFrozen;
use contact::Measure;
use runner::Stop;
use serde::Deserialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A plan on the command line.
#[derive(Default, clap::Args)]
pub(crate) struct PlanArgs {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "paper")]
    plan: String,
    /// The quick form of the plan
    #[arg(long)]
    pub(crate) quick: bool,
}

/// A plan on the command line, in part or changed.
#[derive(Default, clap::Args)]
pub(crate) struct StudyArgs {
    #[command(flatten)]
    plan: PlanArgs,
    /// Only the runs with this problem, method or variant, such as method=latin-dd or problem=shear*; may be repeated:
    /// a run must match all
    #[arg(long, value_name = "KEY=PATTERN", value_parser = key_value)]
    only: Vec<(String, String)>,
    /// A setting of every method that has it, in place of the plan's; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    settings: Vec<(String, String)>,
    #[command(flatten)]
    stop: StopArgs,
}

/// Changes to a case on the command line, and its time step.
#[derive(clap::Args)]
pub(crate) struct SceneArgs {
    #[command(flatten)]
    pub(crate) case: CaseArgs,
    /// The time step of a case, counted from 1, or one of its moments [default: the case's `solve_at`]; those before
    /// it are solved by preconditioned cg, or with friction by active-set, whatever the method
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(crate) time_step: Option<String>,
}

/// A method and until when it runs, on the command line.
#[derive(clap::Args)]
pub(crate) struct SolverArgs {
    /// A method; `gravel list methods` shows them with their settings [default: active-set; on ranks cg]
    #[arg(long, value_name = "M")]
    method: Option<String>,
    /// A setting of the method, such as relaxation=0.8 or subdomains=4x2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    settings: Vec<(String, String)>,
    #[command(flatten)]
    stop: StopArgs,
}

/// A stop rule on the command line.
#[derive(Default, clap::Args)]
pub(crate) struct StopArgs {
    /// A run has converged when the measure is at most this; with 0 it makes all its iterations, or ends as it stalls [default: as the plan or the stored run has it, else 1e-6]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = real)]
    tolerance: Option<f64>,
    /// The measure that decides: zeta, natural_map, penetration_rate, quad_dv, max_dv or velocity_error [default: as the
    /// plan or the stored run has it, else natural_map]
    #[arg(long, value_name = "MEASURE", value_parser = measure)]
    on: Option<Measure>,
    /// Stop a run after this many iterations [default: as the plan or the stored run has it, else 100000]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_iterations: Option<u64>,
}

/// Changes to a case on the command line.
#[derive(clap::Args)]
pub(crate) struct CaseArgs {
    /// A value of the case file to replace, such as sample.grains=250 or scene.law=iqs; may be repeated
    #[arg(long = "scene", value_name = "KEY=VALUE", value_parser = key_value)]
    pub(crate) overrides: Vec<(String, String)>,
}

/// A number on the command line.
fn real(text: &str) -> Result<f64> {
    text.parse().ok().with_context(|| format!("`{text}` is no number such as 1e-6"))
}

/// Arguments `--NAME 'KEY=VALUE'`.
fn pairs<'a>(name: &'a str, pairs: &'a [(String, String)]) -> impl Iterator<Item = String> + use<'a> {
    pairs.iter().map(move |(key, value)| format!("--{name} '{key}={value}'"))
}

impl PlanArgs {
    /// The arguments that select the same.
    pub(crate) fn again(&self) -> String {
        format!("{}{}", self.plan, if self.quick { " --quick" } else { "" })
    }

    pub(crate) fn path(&self, root: &Root) -> Result<PathBuf> {
        root.plan(&self.plan)
    }
}

impl StudyArgs {
    /// All runs of the plan, or of its quick form.
    pub(crate) fn plan(plan: &str, quick: bool) -> Self {
        Self { plan: PlanArgs { plan: plan.to_owned(), quick }, ..Self::default() }
    }

    /// The arguments that select the same.
    fn again(&self) -> String {
        let mut words = vec![self.plan.again()];
        words.extend(pairs("only", &self.only).chain(pairs("set", &self.settings)));
        words.extend(self.stop.again());
        words.join(" ")
    }

    pub(crate) fn selection(&self, root: &Root) -> Result<Selection> {
        refuse_repeated(&self.settings)?;
        let path = self.plan.path(root)?;
        let mut plan = Plan::read(&path, self.plan.quick)?;
        let changes = self.change_stop(&mut plan)?;
        let in_plan = || path.display().to_string();
        let collected = match &plan.collected[..] {
            [] => Vec::new(),
            patterns => Collection::of(root, None, false)?.matching(patterns).with_context(in_plan)?,
        };
        let problems = planned(root, &plan, collected).with_context(in_plan)?;
        let variants = plan.variants(&self.settings).with_context(in_plan)?;
        let (again, notes, only) = (self.again(), Vec::new(), Vec::new());
        let mut selection = Selection { again, plan, problems, variants, notes, only };
        selection.check().with_context(in_plan)?;
        // Its rows must not pass for those of the plan.
        if !changes.is_empty() {
            selection.plan.name += "-changed";
            selection.notes.push(format!("changed: {}", changes.join(", ")));
        }
        for (key, pattern) in &self.only {
            selection.keep(key, pattern)?;
        }
        if !self.only.is_empty() {
            let (some, all) = (selection.selected().count() * selection.rules(), selection.runs());
            selection.notes.push(format!("{some} of the {all} runs of the plan are selected"));
        }
        Ok(selection)
    }

    /// Changes the stop rule of the plan, and lists all changes.
    fn change_stop(&self, plan: &mut Plan) -> Result<Vec<String>> {
        let settings = self.settings.iter().map(|(key, value)| format!("{key} = {value}"));
        let mut changes: Vec<String> = settings.collect();
        for (key, value) in self.stop.changed() {
            // What a rule of a study through time varies is then the same for all.
            plan.simulate.iter_mut().for_each(|simulate| simulate.forget(key));
            changes.push(format!("{key} = {value}"));
        }
        plan.stop = self.stop.of(plan.stop)?;
        Ok(changes)
    }
}

impl SceneArgs {
    /// Refuses them where `what`, such as "x.json is a frozen problem", leaves nothing to change.
    pub(crate) fn refused(&self, what: &str) -> Result<()> {
        if let Some((key, _)) = self.case.overrides.first() {
            bail!("--scene {key}: {what}, it has no scene");
        }
        if self.time_step.is_some() {
            bail!("--time-step: {what}, it has no other time step");
        }
        Ok(())
    }

    /// The arguments that change the same.
    pub(crate) fn again(&self) -> impl Iterator<Item = String> {
        let time_step = self.time_step.iter().map(|moment| format!("--time-step {moment}"));
        pairs("scene", &self.case.overrides).chain(time_step)
    }

    /// The problem of a file.
    pub(crate) fn problem(&self, path: &Path) -> Result<AnyFrozen> {
        if is_toml(path) {
            return self.case.at(path, self.time_step.as_deref())?.problem();
        }
        self.refused(&format!("{} is a frozen problem", path.display()))?;
        Ok(AnyFrozen::read(path)?)
    }
}

impl CaseArgs {
    /// The case of a file at a time step.
    pub(crate) fn at(&self, path: &Path, time_step: Option<&str>) -> Result<CaseProblem> {
        CaseProblem::read(path, self.overrides.clone(), "--time-step", time_step)
    }
}

impl SolverArgs {
    /// Returns the method, or else the active set.
    pub(crate) fn read(&self) -> Result<(Method, Stop)> {
        self.or((Method::unless_named()?, Stop::default()))
    }

    /// The method, or else this one; it stops as given here, unless an argument says otherwise.
    pub(crate) fn or(&self, (method, stop): (Method, Stop)) -> Result<(Method, Stop)> {
        let method = method.or_named(self.method.as_deref(), all_typed(&self.settings)?)?;
        Ok((method, self.stop.of(stop)?))
    }
}

impl StopArgs {
    /// The keys of the stop rule that are changed, and their new values.
    fn changed(&self) -> impl Iterator<Item = (&'static str, String)> {
        let tolerance = self.tolerance.map(|tolerance| ("tolerance", format!("{tolerance:e}")));
        let on = self.on.map(|on| ("on", on.to_string()));
        let max_iterations = self.max_iterations.map(|n| ("max_iterations", n.to_string()));
        tolerance.into_iter().chain(on).chain(max_iterations)
    }

    /// The arguments that change the same.
    pub(crate) fn again(&self) -> impl Iterator<Item = String> {
        self.changed().map(|(key, value)| format!("--{} {value}", key.replace('_', "-")))
    }

    /// `stop` with these changes.
    pub(crate) fn of(&self, stop: Stop) -> Result<Stop> {
        let stop = Stop {
            on: self.on.unwrap_or(stop.on),
            tolerance: self.tolerance.unwrap_or(stop.tolerance),
            max_iterations: self.max_iterations.unwrap_or(stop.max_iterations),
        };
        stop.check()?;
        Ok(stop)
    }
}

/// A value as the settings of a method have it.
pub(crate) fn read<T: for<'v> Deserialize<'v>>(text: &str) -> Result<T, String> {
    let value = serde_json::from_str(text).unwrap_or_else(|_| Value::from(text));
    T::deserialize(value).map_err(|error| error.to_string())
}

fn measure(name: &str) -> Result<Measure, String> {
    Measure::ALL.into_iter().find(|measure| measure.name() == name).ok_or_else(|| {
        let names: Vec<&str> = Measure::ALL.iter().map(|measure| measure.name()).collect();
        format!("there are {}", names.join(", "))
    })
}
