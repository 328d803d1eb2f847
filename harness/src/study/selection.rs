//! A selection of a plan on the command line: quick, in part or changed.

use crate::plan::{Plan, Variant};
use crate::problems::PlannedProblem;
use crate::terminal::suggest;
use anyhow::{Result, bail};
use std::collections::BTreeSet;
use wildmatch::WildMatch;

/// A plan as it is selected: every variant on every problem, before a problem is computed.
pub(crate) struct Selection {
    /// The arguments that ask for it again.
    pub(crate) again: String,
    /// The plan; its name says whether it is quick or changed.
    pub(crate) plan: Plan,
    pub(crate) problems: Vec<PlannedProblem>,
    pub(crate) variants: Vec<Variant>,
    /// Changes and omissions, in words.
    pub(crate) notes: Vec<String>,
    /// Patterns that the selected runs match: a key, and the pattern for the value that [`part`] gives of it.
    pub(crate) only: Vec<(String, WildMatch)>,
}

impl Selection {
    /// Number of runs of the plan.
    pub(crate) fn runs(&self) -> usize {
        self.met().count() * self.rules()
    }

    /// Number of rules under which every variant meets every scene, in a study through time; else 1.
    pub(crate) fn rules(&self) -> usize {
        self.plan.rules().map_or(1, |rules| rules.len().max(1))
    }

    /// Reports whether the run of a variant on a problem is selected.
    pub(crate) fn selects(&self, problem: &str, variant: &Variant) -> bool {
        let mut only = self.only.iter();
        only.all(|(key, pattern)| part(key, problem, variant).is_some_and(|part| pattern.matches(part)))
    }

    /// The runs of the plan, in its order.
    pub(crate) fn met(&self) -> impl Iterator<Item = (&PlannedProblem, &Variant)> {
        let of_problem = |problem| self.variants.iter().map(move |variant| (problem, variant));
        let all = self.problems.iter().flat_map(of_problem);
        all.filter(|(problem, variant)| variant.meets(&problem.name))
    }

    /// The selected runs.
    pub(crate) fn selected(&self) -> impl Iterator<Item = (&PlannedProblem, &Variant)> {
        self.met().filter(|(problem, variant)| self.selects(&problem.name, variant))
    }

    /// Refuses a method that meets none of the problems.
    pub(crate) fn check(&self) -> Result<()> {
        let meets_none =
            |variant: &&Variant| !self.problems.iter().any(|problem| variant.meets(&problem.name));
        let Some(variant) = self.variants.iter().find(meets_none) else { return Ok(()) };
        let what = format!(
            "method `{}`: `problems` is {:?}: no problem of the plan has such a name",
            variant.method.name, variant.problems
        );
        bail!(
            "{}",
            suggest::among(&what, &variant.problems[0], self.problems.iter().map(|p| p.name.as_str()))
        )
    }

    /// Keeps, of the selected runs, those whose `key` matches `pattern`, in which `*` stands for any text.
    pub(crate) fn keep(&mut self, key: &str, pattern: &str) -> Result<()> {
        const KEYS: [&str; 3] = ["problem", "method", "variant"];
        if !KEYS.contains(&key) {
            bail!("--only {key}={pattern}: the key is one of {}{}", KEYS.join(", "), suggest::of(key, KEYS));
        }
        let parts = self.selected().filter_map(|(problem, variant)| part(key, &problem.name, variant));
        let known: BTreeSet<String> = parts.map(str::to_owned).collect();
        self.only.push((key.to_owned(), WildMatch::new(pattern)));
        if self.selected().next().is_none() {
            let what = format!("--only {key}={pattern}: there is none");
            bail!("{}", suggest::among(&what, pattern, known.iter().map(String::as_str)));
        }
        Ok(())
    }
}

/// Returns the value of a run under a key of `--only`.
fn part<'a>(key: &str, problem: &'a str, variant: &'a Variant) -> Option<&'a str> {
    match key {
        "problem" => Some(problem),
        "method" => Some(variant.method.name),
        "variant" => Some(&variant.name),
        _ => None,
    }
}
