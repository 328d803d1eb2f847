//! A plan as it was asked for on the command line, quick, in part or changed.

use crate::inputs::Root;
use crate::methods::{key_value, repeated};
use crate::plan::{Plan, Variant};
use crate::problems::{PlannedProblem, planned};
use crate::solve::StopChanges;
use crate::suggest;
use anyhow::{Context, Result, bail};
use std::collections::BTreeSet;
use wildmatch::WildMatch;

/// A plan on the command line.
#[derive(Default, clap::Args)]
pub(crate) struct StudyArgs {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "paper")]
    plan: String,
    /// The quick form of the plan
    #[arg(long)]
    quick: bool,
    /// Only those of the runs with this problem, method or variant, such as method=latin-dd or problem=shear*; of several,
    /// all must hold
    #[arg(long, value_name = "KEY=PATTERN", value_parser = key_value)]
    only: Vec<(String, String)>,
    /// A setting of every method that has it, in place of the plan's; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    settings: Vec<(String, String)>,
    #[command(flatten)]
    stop: StopChanges,
}

/// A plan as it was asked for: every variant on every problem, before a problem is made.
pub(crate) struct Asked {
    /// The arguments that ask for it again.
    pub(crate) again: String,
    /// The plan; its name says whether it is quick or changed.
    pub(crate) plan: Plan,
    pub(crate) problems: Vec<PlannedProblem>,
    pub(crate) variants: Vec<Variant>,
    /// What was changed or left out, in words.
    pub(crate) notes: Vec<String>,
    only: Vec<Only>,
}

/// What the runs to be made have in common.
struct Only {
    of: fn(&str, &Variant) -> String,
    wanted: WildMatch,
}

impl StudyArgs {
    /// All runs of the plan, or of its quick form.
    pub(crate) fn plan(plan: &str, quick: bool) -> Self {
        Self { plan: plan.to_owned(), quick, ..Self::default() }
    }

    /// The arguments that ask for the same.
    fn again(&self) -> String {
        let mut words = vec![self.plan.clone()];
        words.extend(self.quick.then(|| "--quick".to_owned()));
        words.extend(self.only.iter().map(|(key, pattern)| format!("--only '{key}={pattern}'")));
        words.extend(self.settings.iter().map(|(key, value)| format!("--set '{key}={value}'")));
        words.extend(self.stop.again());
        words.join(" ")
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
        let mut asked =
            Asked { again: self.again(), plan, problems, variants, notes: Vec::new(), only: Vec::new() };
        // Its rows must not pass for those of the plan.
        if !changes.is_empty() {
            asked.plan.name += "-changed";
            asked.notes.push(format!("changed: {}", changes.join(", ")));
        }
        for (key, pattern) in &self.only {
            asked.keep(key, pattern)?;
        }
        if !self.only.is_empty() {
            let (some, all) = (asked.selected().count() * asked.rules(), asked.runs());
            asked.notes.push(format!("{some} of the {all} runs of the plan are asked for"));
        }
        Ok(asked)
    }

    /// Changes the stop rule as asked, and tells all that is changed.
    fn change_stop(&self, plan: &mut Plan) -> Result<Vec<String>> {
        let mut changes: Vec<String> =
            self.settings.iter().map(|(key, value)| format!("{key} = {value}")).collect();
        for (key, value) in self.stop.changed() {
            // What a rule of a study through time varies is then the same for all.
            plan.simulate.iter_mut().for_each(|simulate| simulate.forget(key));
            changes.push(format!("{key} = {value}"));
        }
        plan.stop = self.stop.of(plan.stop)?;
        Ok(changes)
    }
}

impl Asked {
    /// Number of runs of the plan.
    pub(crate) fn runs(&self) -> usize {
        self.problems.len() * self.variants.len() * self.rules()
    }

    /// Number of rules under which every variant meets every scene, in a study through time; else 1.
    pub(crate) fn rules(&self) -> usize {
        self.plan.rules().map_or(1, |rules| rules.len().max(1))
    }

    /// Whether the run of a variant on a problem is to be made.
    pub(crate) fn selects(&self, problem: &str, variant: &Variant) -> bool {
        self.only.iter().all(|only| only.wanted.matches(&(only.of)(problem, variant)))
    }

    /// The runs to be made, in the order of the plan.
    pub(crate) fn selected(&self) -> impl Iterator<Item = (&PlannedProblem, &Variant)> {
        let of_problem = |problem| self.variants.iter().map(move |variant| (problem, variant));
        let all = self.problems.iter().flat_map(of_problem);
        all.filter(|(problem, variant)| self.selects(&problem.name, variant))
    }

    /// Keeps, of the runs to be made, those whose `key` matches `pattern`, in which `*` stands for any text.
    fn keep(&mut self, key: &str, pattern: &str) -> Result<()> {
        const KEYS: [&str; 3] = ["problem", "method", "variant"];
        let of: fn(&str, &Variant) -> String = match key {
            "problem" => |problem, _| problem.to_owned(),
            "method" => |_, variant| variant.method.name.to_owned(),
            "variant" => |_, variant| variant.name.clone(),
            _ => {
                bail!("--only {key}={pattern}: it must name a {}{}", KEYS.join(", "), suggest::of(key, KEYS))
            }
        };
        let known: BTreeSet<String> =
            self.selected().map(|(problem, variant)| of(&problem.name, variant)).collect();
        self.only.push(Only { of, wanted: WildMatch::new(pattern) });
        if self.selected().next().is_none() {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let what = format!("--only {key}={pattern}: there is none");
            bail!("{}", suggest::among(&what, pattern, known.iter().copied()));
        }
        Ok(())
    }
}
