//! The collection on disk: of each problem an entry, its file and its known answers, all named after the hash of its content.

use crate::plan::{Marcher, Settings};
use crate::problems::{CaseProblem, Problem, overrides};
use crate::root::{Root, is_id, stem};
use crate::terminal::{read_sealed, read_text, write_kept, write_sealed};
use anyhow::{Context, Result, anyhow, bail, ensure};
use cases::{AnyFrozen, all_missing, of_toml};
use clap::ValueEnum;
use lineup::{Law, OneProblem, Posed};
use reference::{ROUND_OFF, RoughSolution, take};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// A collection of problems, as a folder.
pub(crate) struct Collection<'r> {
    root: &'r Root,
    folder: PathBuf,
}

/// Facts about a problem and its status, as its file in `entries` has them.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    /// Hash of all that a method sees of the problem.
    pub(crate) id: String,
    /// Name of the problem.
    pub(crate) name: String,
    /// Name of the mechanics in files; `local` of W alone.
    pub(crate) mechanics: String,
    /// Number of grains; 0 of W alone.
    pub(crate) grains: usize,
    /// Number of contacts.
    pub(crate) contacts: usize,
    /// Least and greatest μ of its contacts (–).
    pub(crate) friction: [f64; 2],
    /// State of the packing.
    pub(crate) state: State,
    /// Origin of the problem, in a sentence.
    pub(crate) origin: String,
    /// Licence of the problem's data.
    pub(crate) licence: String,
    /// Author of the best known answer: a code and its version.
    pub(crate) by: String,
    /// Method of the best known answer.
    pub(crate) how: String,
    /// Knowledge of its solutions, recomputed from the stored answers.
    pub(crate) known: Standing,
    /// Recipe by which the problem is made again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) made: Option<Made>,
    /// File of another code, which is not stored here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) foreign: Option<Foreign>,
}

/// State of a packing.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, JsonSchema, Serialize, Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum State {
    /// At rest, before any wall moves.
    Rest,
    /// Onset of motion: the fourth time step in which a wall moves.
    Onset,
    /// Sheared: the walls have moved for long, and grains flow.
    Sheared,
    /// Another state.
    Other,
}

impl State {
    /// Name in files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Onset => "onset",
            Self::Sheared => "sheared",
            Self::Other => "other",
        }
    }

    /// Returns the state that a moment of a case names.
    pub(crate) fn of_moment(name: &str) -> Self {
        Self::from_str(name, false).unwrap_or(Self::Other)
    }
}

/// Status of a problem, which the program sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Status {
    /// One certified solution is stored.
    Certified,
    /// Several certified solutions are stored, whose velocities differ.
    Several,
    /// Impulses of W alone are stored whose natural map is round-off; there is no certificate of W alone.
    Solved,
    /// No solution is known; the impulses of the least natural map are stored.
    Open,
    /// It is proved that there is no solution.
    NoSolution,
}

impl Status {
    /// All of them, in the order of tables.
    pub(crate) const ALL: [Self; 5] =
        [Self::Certified, Self::Several, Self::Solved, Self::Open, Self::NoSolution];

    /// Name in files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Certified => "certified",
            Self::Several => "several",
            Self::Solved => "solved",
            Self::Open => "open",
            Self::NoSolution => "no-solution",
        }
    }
}

/// Knowledge of the solutions of a problem.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Standing {
    /// Status.
    pub(crate) status: Status,
    /// Number of certified solutions that are stored.
    pub(crate) solutions: usize,
    /// Greatest distance of two of them in velocity, over what impulses change of it (–).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) spread: Option<f64>,
    /// Natural map of the best stored impulses (–); none where there is no solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) natural_map: Option<f64>,
}

impl Standing {
    /// Reports whether two computations of it agree: on words and counts exactly, on numbers to three digits or round-off.
    pub(crate) fn agrees(&self, other: &Self) -> bool {
        let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => agree(a, b),
            (a, b) => a == b,
        };
        (self.status, self.solutions) == (other.status, other.solutions)
            && near(self.spread, other.spread)
            && near(self.natural_map, other.natural_map)
    }
}

/// Share by which two computations of one residual may differ, and the residual below which both are round-off (–).
const THREE_DIGITS: f64 = 1e-3;
const ROUNDED: f64 = 1e-12;

/// Reads a file of TOML.
///
/// # Errors
/// Names the file, all keys that it lacks, or the first that is wrong.
pub(crate) fn of_file<T: DeserializeOwned + JsonSchema>(file: &Path) -> Result<T> {
    let text = read_text(file)?;
    let lacks = |(_, error): (String, toml::de::Error)| match text.parse::<toml::Table>() {
        Ok(content) => anyhow!(all_missing::<T>(&content, error.to_string())),
        Err(_) => error.into(),
    };
    of_toml(&text).map_err(lacks).with_context(|| file.display().to_string())
}

/// Reports whether two numbers are the same residual, computed twice.
pub(crate) fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= THREE_DIGITS * a.abs().max(b.abs()) + ROUNDED
}

/// Recipe of a problem: a time step of a case with values replaced.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Made {
    /// Name of the case.
    pub(crate) case: String,
    /// The time step, counted from 1.
    pub(crate) time_step: u64,
    /// Method of the time steps before; without one that of `gravel freeze`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) march: Option<Marcher>,
    /// Values that replace those of the case.
    #[serde(default)]
    pub(crate) scene: Settings,
}

impl Made {
    /// Returns the case at its time step.
    pub(crate) fn case(&self, root: &Root) -> Result<CaseProblem> {
        let (path, time_step) = (root.case(&self.case)?, self.time_step.to_string());
        let case = CaseProblem::read(&path, overrides(&self.scene), "`time_step`", Some(&time_step))?;
        Ok(case.after(self.march.clone()))
    }
}

/// File of another code, of which the hash is known here.
#[derive(Clone, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Foreign {
    /// Name of the file.
    pub(crate) file: String,
    /// SHA-256 of its bytes.
    pub(crate) sha256: String,
    /// Its length (B).
    pub(crate) bytes: u64,
}

impl Foreign {
    /// Returns the name, the hash and the length of a file.
    pub(crate) fn of(file: &Path) -> Result<Self> {
        let bytes = std::fs::read(file).with_context(|| file.display().to_string())?;
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let hex = |text: String, byte: &u8| text + &format!("{byte:02x}");
        let sha256 = Sha256::digest(&bytes).iter().fold(String::new(), hex);
        Ok(Self { file: name, sha256, bytes: bytes.len() as u64 })
    }
}

/// Stored answers to a problem: impulses from which its standing is recomputed (N·s).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub(crate) enum Answers {
    /// Certified solutions.
    Solutions(Vec<Vec<f64>>),
    /// The impulses of the least natural map, where none is certified.
    Best(Vec<f64>),
    /// Normal impulses that prove that there is no solution, one of each contact.
    Ray(Vec<f64>),
}

impl Answers {
    /// Recomputes what the answers say of a problem.
    ///
    /// # Errors
    /// Says which of them the problem does not confirm.
    pub(crate) fn standing(&self, posed: &Posed) -> Result<Standing> {
        let problem = match posed {
            Posed::Grains(problem) => &**problem,
            Posed::W(problem) => {
                let Self::Best(r) = self else {
                    bail!("W alone has no certificate, and its best impulses alone")
                };
                let wanted = posed.facts().of_contact * posed.facts().contacts;
                ensure!(r.len() == wanted, "stored impulses have {} values, not {wanted}", r.len());
                let natural_map = problem.natural_map(r);
                let status = if natural_map <= ROUND_OFF { Status::Solved } else { Status::Open };
                return Ok(Standing { status, solutions: 0, spread: None, natural_map: Some(natural_map) });
            }
        };
        let facts = problem.facts();
        let (all, each) = match self {
            Self::Solutions(all) => (all.as_slice(), facts.of_contact),
            Self::Best(r) => (std::slice::from_ref(r), facts.of_contact),
            Self::Ray(ray) => (std::slice::from_ref(ray), 1),
        };
        let wanted = each * facts.contacts;
        if let Some(r) = all.iter().find(|r| r.len() != wanted) {
            bail!("stored impulses have {} values, not {wanted}", r.len());
        }
        let natural_map = |r: &[f64]| problem.measures(&[], r).natural_map;
        let none = Standing { status: Status::NoSolution, solutions: 0, spread: None, natural_map: None };
        Ok(match self {
            Self::Solutions(all) => {
                let different = pool(problem, all);
                let certified = different.iter().all(|solution| solution.certificate.certified());
                ensure!(certified && !all.is_empty(), "a stored solution is not certified");
                ensure!(different.len() == all.len(), "two stored solutions have one velocity");
                let least = all.iter().map(|r| natural_map(r)).fold(f64::INFINITY, f64::min);
                let lists: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
                let is_one = all.len() == 1;
                Standing {
                    status: if is_one { Status::Certified } else { Status::Several },
                    solutions: all.len(),
                    spread: (!is_one).then(|| problem.spread(&lists)),
                    natural_map: Some(least),
                }
            }
            Self::Best(r) => {
                ensure!(
                    !problem.certify(r).certified(),
                    "the best impulses of an open problem are certified"
                );
                Standing { status: Status::Open, natural_map: Some(natural_map(r)), ..none }
            }
            Self::Ray(ray) => {
                let proves = match problem.law() {
                    Law::Frictionless(law) => law.proves_infeasible(ray),
                    Law::Frictional { problem: law, .. } => law.proves_infeasible(ray),
                };
                ensure!(proves, "the stored ray does not prove that there is no solution");
                none
            }
        })
    }
}

/// Certifies impulses (N·s), and keeps those of different velocities.
pub(crate) fn pool(problem: &dyn OneProblem, all: &[Vec<f64>]) -> Vec<RoughSolution> {
    let mut pool = Vec::new();
    for impulses in all {
        let solution = RoughSolution { certificate: problem.certify(impulses), impulses: impulses.clone() };
        take(&mut pool, solution, |a, b| problem.distance(a, b));
    }
    pool
}

/// Returns the facts of a posed problem that an entry repeats, for its check: mechanics, grains, contacts, least and greatest μ.
pub(crate) fn facts(posed: &Posed) -> (String, usize, usize, [f64; 2]) {
    let facts = posed.facts();
    let friction: Vec<f64> = match posed {
        Posed::Grains(problem) => problem.touching().iter().map(|contact| contact.friction).collect(),
        Posed::W(problem) => problem.friction().to_vec(),
    };
    let least = friction.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = friction.iter().copied().fold(0.0, f64::max);
    let ends = if friction.is_empty() { [0.0; 2] } else { [least, greatest] };
    (facts.mechanics.to_owned(), facts.grains, facts.contacts, ends)
}

impl<'r> Collection<'r> {
    /// The collection of the checkout, or the one in a `folder`.
    pub(crate) fn of(root: &'r Root, folder: Option<&Path>) -> Result<Self> {
        if let Some(folder) = folder
            && folder.exists()
            && !folder.is_dir()
        {
            bail!("--in {}: it is a file; a collection is a folder", folder.display());
        }
        let here = || root.needed().map(|root| root.join("cases/collection"));
        Ok(Self { root, folder: folder.map_or_else(here, |folder| Ok(folder.to_owned()))? })
    }

    /// A file of it, of a `kind`: `entries`, `problems`, `answers` or `submissions`.
    pub(crate) fn file(&self, kind: &str, name: &str) -> PathBuf {
        self.folder.join(kind).join(name)
    }

    /// Returns the names of the files of a `kind`, without their endings, in order.
    pub(crate) fn names(&self, kind: &str) -> Result<Vec<String>> {
        let folder = self.folder.join(kind);
        if !folder.is_dir() {
            return Ok(Vec::new());
        }
        let mut names = Vec::new();
        for entry in std::fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
            let path = entry.with_context(|| folder.display().to_string())?.path();
            let name = stem(&path);
            if !name.starts_with('.') {
                names.push(name);
            }
        }
        names.sort();
        Ok(names)
    }

    /// Reads all entries, in the order of their ids.
    pub(crate) fn entries(&self) -> Result<Vec<Entry>> {
        self.names("entries")?.iter().map(|id| self.entry(id)).collect()
    }

    /// Reads an entry.
    pub(crate) fn entry(&self, id: &str) -> Result<Entry> {
        let file = self.file("entries", &format!("{id}.toml"));
        if !is_id(id) {
            bail!("{id:?} is no id of a problem: it must be 16 digits 0-9 or a-f");
        }
        if !file.is_file() {
            bail!(
                "no problem {id} in the collection {}: `gravel collection list` shows those that there are",
                self.folder.display()
            );
        }
        let entry: Entry = of_file(&file)?;
        ensure!(
            entry.id == id,
            "{}: `id` is {:?}, and the file is named after another",
            file.display(),
            entry.id
        );
        Ok(entry)
    }

    /// Returns the place of the problem of an entry, if it is stored or was made.
    pub(crate) fn place(&self, entry: &Entry) -> Option<PathBuf> {
        self.root.collected(&self.folder, &entry.id)
    }

    /// Reads the problem of an entry, and checks that it is the one; none if it is not stored and was not made.
    pub(crate) fn problem(&self, entry: &Entry) -> Result<Option<Problem>> {
        let Some(place) = self.place(entry) else { return Ok(None) };
        let problem = match &entry.foreign {
            Some(_) => Problem::foreign(&place)?,
            None => Problem::alone(AnyFrozen::read(&place)?, false),
        };
        ensure!(
            problem.hash == entry.id,
            "{}: the content has the hash {}, not that of the entry: it was changed",
            place.display(),
            problem.hash
        );
        Ok(Some(problem))
    }

    /// Reads the stored answers to the problem of an entry.
    pub(crate) fn answers(&self, id: &str) -> Result<Answers> {
        let file = self.file("answers", &format!("{id}.json.gz"));
        let (text, sealed) = read_sealed(&file)?;
        ensure!(sealed, "{}: it has no checksum", file.display());
        serde_json::from_str(&text).with_context(|| file.display().to_string())
    }

    /// Writes an entry and the answers to its problem.
    pub(crate) fn write(&self, entry: &Entry, answers: &Answers) -> Result<()> {
        let text = toml::to_string(entry)?;
        write_sealed(
            &self.file("answers", &format!("{}.json.gz", entry.id)),
            &serde_json::to_string(answers)?,
        )?;
        write_kept(&self.file("entries", &format!("{}.toml", entry.id)), &text)
    }

    /// Writes the file of a problem: here where it is `stored`, else where it need not be made again.
    pub(crate) fn write_problem(&self, id: &str, frozen: &AnyFrozen, stored: bool) -> Result<()> {
        let name = format!("{id}.json.gz");
        let place =
            if stored { self.file("problems", &name) } else { self.root.join("results/problems").join(name) };
        write_kept(&place, &frozen.to_json()?)
    }
}
