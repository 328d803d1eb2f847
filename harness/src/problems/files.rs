//! Where cases, frozen problems and plans are, and how a name or a path becomes one of them.

use crate::plan::identity::first_hex;
use crate::plan::methods::Method;
use crate::terminal::progress;
use crate::terminal::suggest;
use anyhow::{Context, Result, bail};
use cases::{Case, Frozen, March};
use runner::{Status, Stop};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// The checkout.
pub(crate) struct Root(PathBuf);

impl Root {
    /// The folder asked for, or the nearest one above the current folder that holds cases and plans.
    pub(crate) fn find(asked: Option<PathBuf>) -> Result<Self> {
        let is_root =
            |folder: &Path| folder.join("cases/frozen").is_dir() && folder.join("harness/plans").is_dir();
        if let Some(folder) = asked {
            if !is_root(&folder) {
                bail!("--root {}: this folder has no cases/frozen and harness/plans", folder.display());
            }
            return Ok(Self(folder));
        }
        // A relative path keeps what is printed short.
        let mut folder = PathBuf::from(".");
        for _ in std::env::current_dir()?.ancestors() {
            if is_root(&folder) {
                return Ok(Self(folder.strip_prefix(".").map_or(folder.clone(), Path::to_owned)));
            }
            folder.push("..");
        }
        bail!(
            "no folder from here up holds cases/frozen and harness/plans: run gravel in its checkout, or give --root DIR"
        )
    }

    /// A path inside the checkout.
    pub(crate) fn join(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }

    /// Paths of all case files, by name.
    pub(crate) fn cases(&self) -> Result<Vec<PathBuf>> {
        listing(&self.join("cases"), ".toml", &["Cargo.toml"])
    }

    /// Paths of all frozen problems, by name.
    pub(crate) fn frozen(&self) -> Result<Vec<PathBuf>> {
        let mut frozen = listing(&self.join("cases/frozen"), ".json", &[])?;
        // An answer that another code gave lies beside its problem.
        frozen.retain(|path| !path.to_string_lossy().ends_with(".solution.json"));
        Ok(frozen)
    }

    /// Paths of all plans, by name.
    pub(crate) fn plans(&self) -> Result<Vec<PathBuf>> {
        listing(&self.join("harness/plans"), ".toml", &[])
    }

    /// The file of a case, given by name or path.
    pub(crate) fn case(&self, name: &str) -> Result<PathBuf> {
        checked(named_or_path(name, "case", &self.cases()?)?, &[Kind::Case])
    }

    /// The file of a plan, given by name or path.
    pub(crate) fn plan(&self, name: &str) -> Result<PathBuf> {
        checked(named_or_path(name, "plan", &self.plans()?)?, &[Kind::Plan])
    }

    /// The file of a frozen problem, given by name or path.
    pub(crate) fn problem(&self, name: &str) -> Result<PathBuf> {
        checked(named_or_path(name, "frozen problem", &self.frozen()?)?, &[Kind::Frozen])
    }

    /// The file of a frozen problem or a case, given by name or path.
    pub(crate) fn problem_or_case(&self, name: &str) -> Result<PathBuf> {
        let mut known = self.frozen()?;
        known.extend(self.cases()?);
        checked(named_or_path(name, "problem or case", &known)?, &[Kind::Case, Kind::Frozen])
    }
}

/// Name of a file without its ending.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

fn listing(folder: &Path, ending: &str, except: &[&str]) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.ends_with(ending) && !except.contains(&&*name) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn named_or_path(name: &str, kind: &str, known: &[PathBuf]) -> Result<PathBuf> {
    if let Some(path) = known.iter().find(|path| stem(path) == name) {
        return Ok(path.clone());
    }
    let path = PathBuf::from(name);
    if path.is_file() {
        return Ok(path);
    }
    if path.is_dir() {
        bail!("{name} is a folder: give a {kind}, by name or by the path of its file");
    }
    let names: Vec<String> = known.iter().map(|path| stem(path)).collect();
    // What is there and cannot be reached, such as a link to itself, is not a wrong name.
    if let (Ok(_), Err(error)) = (path.symlink_metadata(), path.metadata()) {
        bail!("{name}: it cannot be read: {error}");
    }
    let what = format!("no {kind} `{name}`, and no file of that path seen from the current folder");
    bail!("{}", suggest::among(&what, name, names.iter().map(String::as_str)))
}

/// What a file holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Case,
    Plan,
    Frozen,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Case => "a case",
            Self::Plan => "a plan",
            Self::Frozen => "a frozen problem",
        }
    }

    /// Of a file that cannot be taken for anything else; whether it is right in itself is not asked.
    fn of(path: &Path) -> Option<Self> {
        if !is_toml(path) {
            return path.extension().is_some_and(|ending| ending == "json").then_some(Self::Frozen);
        }
        let table: toml::Table = std::fs::read_to_string(path).ok()?.parse().ok()?;
        let has = |key| table.contains_key(key);
        match (has("scene") || has("sample"), has("methods") || has("problems")) {
            (true, false) => Some(Self::Case),
            (false, true) => Some(Self::Plan),
            _ => None,
        }
    }
}

/// Refuses a file that holds something else than is asked.
fn checked(path: PathBuf, asked: &[Kind]) -> Result<PathBuf> {
    let ending = |kind: &Kind| if *kind == Kind::Frozen { ".json" } else { ".toml" };
    let found = Kind::of(&path);
    // What is wrong inside a file is told by whoever reads it.
    let unclear = found.is_none() && is_toml(&path) && asked.iter().any(|kind| ending(kind) == ".toml");
    if unclear || found.is_some_and(|found| asked.contains(&found)) {
        return Ok(path);
    }
    let list = |words: Vec<&str>| words.join(" or ");
    let is = found.map_or_else(String::new, |found| format!(" is {}", found.name()));
    bail!(
        "{}{is}: {} is asked, a file that ends in {}",
        path.display(),
        list(asked.iter().map(|kind| kind.name()).collect()),
        list(asked.iter().map(ending).collect())
    )
}

/// Whether a file is a case or a plan, by its name.
pub(crate) fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "toml")
}

/// Marches a case to its `time_step`-th problem, counted from 1, with a bar on anything long; says how many of the time
/// steps before it did not converge, if any.
pub(crate) fn march_to(
    march: &mut March,
    time_step: u64,
    method: &Method,
    stop: &Stop,
) -> Result<(Frozen, Option<String>)> {
    let mut missed = 0;
    let bar = progress::bar(time_step - 1, "time steps");
    while march.time_steps() + 1 < time_step {
        let (outcome, _) = march.time_step(&*method.solver, stop)?;
        missed += u64::from(outcome.status != Status::Converged);
        bar.set_message(format!("{} iterations", outcome.iterations));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let note = format!("{missed} of the {} time steps before did not converge.", time_step - 1);
    Ok((march.next()?.frozen, (missed > 0).then_some(note)))
}

/// The time step of `case` that `moment` names, as the value of `key`: a number, or one of the case's moments.
pub(crate) fn time_step(case: &Case, key: &str, moment: &str) -> Result<u64> {
    match (moment.parse(), case.moments.get(moment)) {
        (Ok(0), _) => bail!("{key} 0: time steps are counted from 1"),
        (Ok(time_step), _) => Ok(time_step),
        (Err(_), Some(time_step)) => Ok(*time_step),
        (Err(_), None) => {
            let mut accepted = "a number from 1".to_owned();
            for name in case.moments.keys() {
                accepted.extend([", or ", name.as_str()]);
            }
            let nearest = suggest::of(moment, case.moments.keys().map(String::as_str));
            bail!("{key} {moment}: it must be {accepted}{nearest}")
        }
    }
}

/// Hash of everything that a method sees: two problems with the same hash are the same problem.
pub(crate) fn content_hash(frozen: &Frozen) -> String {
    let mut hash = Sha256::new();
    let mut number = |x: f64| hash.update(x.to_bits().to_le_bytes());
    let problem = &frozen.problem;
    // The lengths first: no two problems are the same numbers otherwise cut.
    number(problem.grain_count() as f64);
    number(problem.contact_count() as f64);
    problem.mass().iter().for_each(|m| number(*m));
    problem.position().iter().chain(problem.free_velocity()).flatten().for_each(|x| number(*x));
    for contact in problem.contacts() {
        number(f64::from(contact.candidate));
        number(contact.antagonist.map_or(-1.0, f64::from));
        contact.normal.iter().for_each(|x| number(*x));
        number(contact.offset);
    }
    frozen.start.iter().for_each(|r| number(*r));
    first_hex(hash.finalize().as_slice())
}
