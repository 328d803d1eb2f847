//! `gravel collection make`: the problems of a recipe, or the file of a problem that is not stored.

use crate::collection::{Collection, Recipe};
use crate::problems::CaseProblem;
use crate::root::Root;
use crate::terminal::{read_text, say};
use anyhow::{Context, Result, bail, ensure};
use lineup::content_hash;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(super) struct Make {
    /// A recipe file; or the id of a problem that is not stored, whose file is made in results/problems
    #[arg(value_name = "RECIPE|ID")]
    what: String,
    /// Seeds of the samples in place of the recipe's, one a line, for a hidden collection; needs --in
    #[arg(long, value_name = "FILE")]
    seeds_from: Option<PathBuf>,
}

impl Make {
    pub(super) fn run(&self, root: &Root, collection: &Collection, elsewhere: bool) -> Result<()> {
        let path = PathBuf::from(&self.what);
        if self.seeds_from.is_none() && !path.is_file() {
            return again(root, collection, &self.what);
        }
        let mut recipe = Recipe::read(&path)?;
        if let Some(file) = &self.seeds_from {
            ensure!(
                elsewhere,
                "--seeds-from: secret seeds make a hidden collection: name its folder by --in"
            );
            recipe = recipe.seeded(&seeds(file)?);
        }
        let [made, there] = recipe.make(root, collection)?;
        say(format_args!("{made} problems made, {there} were there"))
    }
}

/// Reads seeds, one a line.
fn seeds(file: &Path) -> Result<Vec<u64>> {
    let text = read_text(file)?;
    let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let seed = |(k, line): (usize, &str)| {
        let name =
            || format!("{}: line {k} is {line:?}: it must be a whole number, not negative", file.display());
        line.trim().parse().with_context(name)
    };
    let seeds = lines.map(seed).collect::<Result<Vec<u64>>>()?;
    ensure!(!seeds.is_empty(), "{}: it holds no seed, one a line", file.display());
    Ok(seeds)
}

/// Makes the file of a problem that is not stored.
fn again(root: &Root, collection: &Collection, id: &str) -> Result<()> {
    let entry = collection.entry(id).with_context(|| format!("{id} is no file of a recipe, and no id"))?;
    if let Some(place) = collection.place(&entry) {
        return say(format_args!("{} is there", place.display()));
    }
    let Some(made) = &entry.made else {
        let file =
            entry.foreign.map(|foreign| format!(": it is {}, sha256 {}", foreign.file, foreign.sha256));
        bail!("{id} has no recipe{}", file.unwrap_or_default());
    };
    let case = made.case(root)?;
    let (method, stop) = case.before()?;
    let how = CaseProblem::solved_by(&method, &stop);
    let mut frozen = case.marched(&method, &stop, &how, &|| false)?;
    frozen.rename(&entry.name);
    let found = content_hash(&*lineup::problem(frozen.clone()));
    ensure!(
        found == id,
        "{id}: its recipe makes a problem with the hash {found}: the code that marches has changed since"
    );
    collection.write_problem(id, &frozen, false)?;
    say(format_args!("{id} {}: made", entry.name))
}
