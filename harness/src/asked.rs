//! A plan as it was asked for on the command line, quick, in part or changed.

use crate::inputs::Root;
use crate::methods::{key_value, repeated};
use crate::plan::{Plan, Variant};
use crate::problems::{PlannedProblem, planned};
use crate::solve::measure;
use crate::study::Study;
use crate::suggest;
use anyhow::{Context, Result, bail};
use contact::Measure;
use wildmatch::WildMatch;

/// A plan on the command line.
#[derive(clap::Args)]
pub(crate) struct StudyArgs {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "paper")]
    plan: String,
    /// The quick form of the plan
    #[arg(long)]
    quick: bool,
    /// Only the runs with this problem, method or variant, such as method=latin-dd or problem=shear*; of several, all
    /// must hold
    #[arg(long, value_name = "KEY=PATTERN", value_parser = key_value)]
    only: Vec<(String, String)>,
    /// A setting of every method that has it, in place of the plan's; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    settings: Vec<(String, String)>,
    /// A run has converged when the measure is at most this [default: the plan's]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// The measure that decides: zeta, natural_map, penetration_rate, quad_dv or max_dv [default: the plan's]
    #[arg(long, value_name = "MEASURE", value_parser = measure)]
    on: Option<Measure>,
    /// A run ends after this many iterations at the latest [default: the plan's]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_iterations: Option<u64>,
}

/// The runs to be made, every variant on every problem, before the problems are made.
pub(crate) struct Asked {
    /// How the user named the plan, and how a run of the same is asked for again.
    pub(crate) again: String,
    /// The plan; its name says whether it is quick, changed or not the whole one.
    pub(crate) plan: Plan,
    pub(crate) problems: Vec<PlannedProblem>,
    pub(crate) variants: Vec<Variant>,
    /// What was changed or left out, in words.
    pub(crate) notes: Vec<String>,
}

impl StudyArgs {
    /// All runs of the plan, or of its quick form.
    pub(crate) fn plan(plan: &str, quick: bool) -> Self {
        Self {
            plan: plan.to_owned(),
            quick,
            only: Vec::new(),
            settings: Vec::new(),
            tolerance: None,
            on: None,
            max_iterations: None,
        }
    }

    /// The arguments that ask for the same.
    fn again(&self) -> String {
        let mut words = vec![self.plan.clone()];
        words.extend(self.quick.then(|| "--quick".to_owned()));
        words.extend(self.only.iter().map(|(key, pattern)| format!("--only '{key}={pattern}'")));
        words.extend(self.settings.iter().map(|(key, value)| format!("--set '{key}={value}'")));
        words.extend(self.tolerance.map(|tolerance| format!("--tolerance {tolerance:e}")));
        words.extend(self.on.map(|on| format!("--on {on}")));
        words.extend(self.max_iterations.map(|n| format!("--max-iterations {n}")));
        words.join(" ")
    }

    /// The runs that are asked for, with their problems made.
    pub(crate) fn study(&self, root: &Root) -> Result<Study> {
        self.asked(root)?.made(root)
    }

    pub(crate) fn asked(&self, root: &Root) -> Result<Asked> {
        if let Some((key, _)) = repeated(&self.settings) {
            bail!("--set {key}: it is given twice");
        }
        let path = root.plan(&self.plan)?;
        let mut plan = Plan::read(&path, self.quick)?;
        let changes = self.change_stop(&mut plan)?;
        let in_plan = || path.display().to_string();
        let problems = planned(root, &plan).with_context(in_plan)?;
        let variants = plan.variants(&self.settings).with_context(in_plan)?;
        let whole = problems.len() * variants.len();
        let mut asked = Asked { again: self.again(), plan, problems, variants, notes: Vec::new() };
        for (key, pattern) in &self.only {
            asked.keep(key, pattern)?;
        }
        // Its rows must not pass for those of the plan.
        if !changes.is_empty() {
            asked.plan.name += "-changed";
            asked.notes.push(format!("changed: {}", changes.join(", ")));
        }
        if asked.runs() < whole {
            asked.plan.name += "-part";
            asked.notes.push(format!("{} of the {whole} runs of the plan", asked.runs()));
        }
        Ok(asked)
    }

    /// Changes the stop rule as asked, and tells all that is changed.
    fn change_stop(&self, plan: &mut Plan) -> Result<Vec<String>> {
        let mut changes: Vec<String> =
            self.settings.iter().map(|(key, value)| format!("{key} = {value}")).collect();
        if let Some(tolerance) = self.tolerance {
            plan.stop.tolerance = tolerance;
            changes.push(format!("tolerance = {tolerance:e}"));
        }
        if let Some(on) = self.on {
            plan.stop.on = on;
            changes.push(format!("on = {on}"));
        }
        if let Some(max_iterations) = self.max_iterations {
            plan.stop.max_iterations = max_iterations;
            changes.push(format!("max_iterations = {max_iterations}"));
        }
        plan.stop.check()?;
        Ok(changes)
    }
}

impl Asked {
    /// Makes the problems of cases.
    pub(crate) fn made(self, root: &Root) -> Result<Study> {
        let Self { again, plan, problems, variants, notes } = self;
        let problems = problems.into_iter().map(|problem| problem.made(root)).collect::<Result<_>>()?;
        Ok(Study { again, plan, problems, variants, notes })
    }

    /// Number of runs.
    pub(crate) fn runs(&self) -> usize {
        self.problems.len() * self.variants.len()
    }

    /// Keeps the runs whose `key` matches `pattern`, in which `*` stands for any text.
    fn keep(&mut self, key: &str, pattern: &str) -> Result<()> {
        let wanted = WildMatch::new(pattern);
        let mut known: Vec<String> = match key {
            "problem" => self.problems.iter().map(|problem| problem.name.clone()).collect(),
            "method" => self.variants.iter().map(|variant| variant.method.name.to_owned()).collect(),
            "variant" => self.variants.iter().map(|variant| variant.name.clone()).collect(),
            _ => {
                let keys = ["problem", "method", "variant"];
                bail!("--only {key}={pattern}: it must name a {}{}", keys.join(", "), suggest::of(key, keys));
            }
        };
        match key {
            "problem" => self.problems.retain(|problem| wanted.matches(&problem.name)),
            "method" => self.variants.retain(|variant| wanted.matches(variant.method.name)),
            _ => self.variants.retain(|variant| wanted.matches(&variant.name)),
        }
        if self.runs() == 0 {
            known.dedup();
            let nearest = suggest::of(pattern, known.iter().map(String::as_str));
            bail!("--only {key}={pattern}: there is none; there are {}{nearest}", known.join(", "));
        }
        Ok(())
    }
}
