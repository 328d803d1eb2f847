//! Recipes: a file that says which time steps of which cases are the problems of a collection.

use super::answers::Answers;
use super::entry::{Entry, Made, State, facts, of_file};
use super::folder::Collection;
use super::sought::sought;
use crate::plan::{PlannedCase, Settings, yes};
use crate::problems::{CaseProblem, Problem, combined};
use crate::root::Root;
use crate::terminal::say;
use anyhow::{Context, Result, bail, ensure};
use cases::AnyFrozen;
use results::settings::TIME_STEP;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// A recipe.
#[derive(JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Recipe {
    /// Reason why these problems are here, in a sentence.
    #[expect(dead_code, reason = "for readers of the file")]
    why: String,
    /// Licence of the problems' data.
    licence: String,
    /// True where the problems are stored; else they are made again from their entries.
    #[serde(default = "yes")]
    stored: bool,
    /// The cases, as plans have them; a `time_step` that is `rest`, `onset` or `sheared` says the state.
    cases: Vec<PlannedCase>,
}

/// Key of the seed of a sample.
const SEED: &str = "sample.seed";

/// A problem that is to be made.
struct Wanted {
    name: String,
    state: State,
    made: Made,
}

impl Recipe {
    /// Reads a recipe.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let recipe: Self = of_file(path)?;
        ensure!(!recipe.cases.is_empty(), "{}: `cases` is empty: no problem is asked for", path.display());
        Ok(recipe)
    }

    /// Replaces the seeds of its samples.
    pub(crate) fn seeded(mut self, seeds: &[u64]) -> Self {
        for case in &mut self.cases {
            case.scene.remove(SEED);
            case.zip.remove(SEED);
            case.axes.insert(SEED.to_owned(), json!(seeds));
        }
        self
    }

    /// Makes the problems that the collection does not have, one march for all time steps of a scene, and seeks their answers.
    /// Returns how many were made and how many were there.
    pub(crate) fn make(&self, root: &Root, collection: &Collection) -> Result<[usize; 2]> {
        let marches = self.marches(root)?;
        let entries = collection.entries()?;
        let known: Vec<&Made> = entries.iter().filter_map(|entry| entry.made.as_ref()).collect();
        let [mut made, mut there] = [0, 0];
        for wanted in marches {
            let (old, new): (Vec<_>, Vec<_>) =
                wanted.into_iter().partition(|wanted| known.contains(&&wanted.made));
            there += old.len();
            let Some(first) = new.first() else { continue };
            let case = first.made.case(root)?;
            let (method, stop) = case.before()?;
            let how = CaseProblem::solved_by(&method, &stop);
            let time_steps: Vec<u64> = new.iter().map(|wanted| wanted.made.time_step).collect();
            let problems = case.marched_through(&time_steps, (&method, &stop, &how), &|| false)?;
            for (wanted, mut frozen) in new.into_iter().zip(problems) {
                frozen.rename(&wanted.name);
                let about = About { state: wanted.state, licence: self.licence.clone() };
                let entry = about.add(collection, frozen, Some(wanted.made), self.stored)?;
                say(format_args!("{} {}: {}", entry.id, entry.name, entry.known.status.name()))?;
                made += 1;
            }
        }
        Ok([made, there])
    }

    /// Returns the problems by marches: those of one scene, by ascending time steps.
    fn marches(&self, root: &Root) -> Result<Vec<Vec<Wanted>>> {
        let mut marches: BTreeMap<(usize, String), Vec<Wanted>> = BTreeMap::new();
        for (k, planned) in self.cases.iter().enumerate() {
            let path = root.case(&planned.case)?;
            let all = combined(planned).with_context(|| format!("`cases`: case `{}`", planned.case))?;
            for (name, mut scene) in all {
                let moment = scene.remove(TIME_STEP).or_else(|| planned.time_step.clone());
                let moment = moment.as_ref().map(crate::plan::as_typed);
                let replaced = crate::problems::overrides(&scene);
                let case = CaseProblem::read(&path, replaced, "`time_step`", moment.as_deref())?;
                let state = moment.as_deref().map_or(State::Other, State::of_moment);
                let (march, time_step) = (planned.march.clone(), case.time_step);
                let made = Made { case: planned.case.clone(), time_step, march, scene };
                let scene = serde_json::to_string::<Settings>(&made.scene)?;
                marches.entry((k, scene)).or_default().push(Wanted { name, state, made });
            }
        }
        let mut marches: Vec<Vec<Wanted>> = marches.into_values().collect();
        for march in &mut marches {
            march.sort_by_key(|wanted| wanted.made.time_step);
        }
        Ok(marches)
    }
}

/// Facts about a problem that its content does not hold.
pub(crate) struct About {
    pub(crate) state: State,
    pub(crate) licence: String,
}

impl About {
    /// Adds a problem with the answers that are found.
    pub(crate) fn add(
        &self,
        collection: &Collection,
        frozen: AnyFrozen,
        made: Option<Made>,
        stored: bool,
    ) -> Result<Entry> {
        let origin = frozen.source().to_owned();
        let copy = frozen.clone();
        let problem = Problem::alone(frozen, false);
        let (entry, answers) = self.entry(collection, &problem, origin)?;
        let entry = Entry { made, ..entry };
        // The entry last: without it the other files are nothing.
        if stored || entry.made.is_some() {
            collection.write_problem(&entry.id, &copy, stored)?;
        }
        collection.write(&entry, &answers)?;
        Ok(entry)
    }

    /// Returns the entry of a problem that the collection does not have, and the answers that are found.
    pub(crate) fn entry(
        &self,
        collection: &Collection,
        problem: &Problem,
        origin: String,
    ) -> Result<(Entry, Answers)> {
        if let Ok(there) = collection.entry(&problem.hash) {
            bail!("{} is in the collection already, as {} ({})", problem.name, there.id, there.name);
        }
        let (answers, how) = sought(problem)?;
        let known = answers.standing(&problem.posed).with_context(|| problem.name.clone())?;
        let (mechanics, grains, contacts, friction) = facts(&problem.posed);
        let (id, name) = (problem.hash.clone(), problem.name.clone());
        let (state, licence) = (self.state, self.licence.clone());
        let (made, foreign) = (None, None);
        let entry = Entry {
            id,
            name,
            mechanics,
            grains,
            contacts,
            friction,
            state,
            origin,
            licence,
            by: Entry::by_this(),
            how,
            known,
            made,
            foreign,
        };
        Ok((entry, answers))
    }
}
