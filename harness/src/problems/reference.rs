//! Reference solutions: computed once for each problem, kept in `results/references`, certified again each time they are read.

use crate::identity::content_hash;
use crate::problems::{Root, Studied};
use crate::terminal::{read_sealed, read_text, suggest, write_sealed};
use analysis::proves_infeasible;
use anyhow::{Context, Result, anyhow, bail};
use cases::{Frozen, of_json};
use contact::{ContactProblem, Discs, Mechanics, Smooth, Truth, Vector};
use reference::{Answer, certify};
use results::schema::KnownSolutions;
use runner::Status;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// Known solutions of a problem; by default none.
pub(crate) struct Known<M: Mechanics = Discs> {
    /// Certified impulses (N·s). Without friction one is enough: all have the same velocities.
    pub(super) impulses: Vec<Vec<f64>>,
    truths: Vec<Truth<M>>,
    /// Velocity at the best impulses, where none could be certified.
    nearest: Option<Truth<M>>,
    is_infeasible: bool,
}

impl<M: Mechanics> Default for Known<M> {
    fn default() -> Self {
        Self { impulses: Vec::new(), truths: Vec::new(), nearest: None, is_infeasible: false }
    }
}

impl<M: Mechanics> Known<M> {
    /// Builds the record from certified impulses (N·s).
    pub(super) fn of(problem: &ContactProblem<M>, impulses: Vec<Vec<f64>>) -> Self {
        let truths = impulses.iter().map(|r| Truth::new(problem, r)).collect();
        Self { impulses, truths, ..Self::default() }
    }

    /// Builds the record of a problem without solution, and prints that the problem of this name has none.
    pub(super) fn none(name: &str) -> Self {
        eprintln!("{name}: the problem has no solution");
        Self { is_infeasible: true, ..Self::default() }
    }

    /// Builds the record of a problem without certified solution from the best impulses (N·s).
    pub(super) fn near(problem: &ContactProblem<M>, impulses: &[f64]) -> Self {
        Self { nearest: Some(Truth::new(problem, impulses)), ..Self::default() }
    }

    /// Every solution.
    pub(crate) fn truths(&self) -> &[Truth<M>] {
        &self.truths
    }

    /// The velocity that is nearest to a solution, as far as is known: it shows which contacts are closed.
    pub(crate) fn nearest(&self) -> Option<&Truth<M>> {
        self.truths.first().or(self.nearest.as_ref())
    }

    /// Returns the number of known solutions and the greatest distance between two of them; nothing where none was sought.
    pub(crate) fn solutions(&self, problem: &ContactProblem<M>) -> KnownSolutions {
        let Some(first) = self.truths.first() else {
            let solutions = self.nearest.as_ref().map(|_| 0);
            return KnownSolutions { solutions, ..KnownSolutions::default() };
        };
        let apart = |a: &Truth<M>, b: &Truth<M>| problem.velocity_distance(a.velocity(), b.velocity());
        let pairs =
            self.truths.iter().enumerate().flat_map(|(k, a)| self.truths[..k].iter().map(move |b| (a, b)));
        let greatest = pairs.map(|(a, b)| apart(a, b)).fold(0.0, f64::max);
        let size = problem.velocity_distance(first.velocity(), problem.free_velocity());
        KnownSolutions {
            solutions: Some(self.truths.len() as u32),
            spread: if greatest == 0.0 { 0.0 } else { greatest / size },
            ..KnownSolutions::default()
        }
    }

    /// Returns the impulses of every solution (N·s).
    pub(crate) fn all_impulses(&self) -> &[Vec<f64>] {
        &self.impulses
    }

    /// Returns the impulses of the first solution (N·s).
    pub(crate) fn impulses(&self) -> Option<&[f64]> {
        self.impulses.first().map(Vec::as_slice)
    }

    /// Returns the final status of a run: on a problem without solution, convergence is false.
    pub(crate) fn ending(&self, status: Status) -> Status {
        if self.is_infeasible && status == Status::Converged { Status::FalseConvergence } else { status }
    }
}

/// Impulses that another code, or another run, gave.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// Impulses in the problem's contact order, a flat list (N·s).
    pub(crate) impulse: Vec<f64>,
    /// Source of the impulses.
    pub(crate) from: String,
}

/// The file, with a number or a list of them for each contact.
#[derive(JsonSchema, Deserialize)]
struct Read<T> {
    impulse: Vec<T>,
    #[serde(default)]
    from: String,
}

impl Given {
    /// Reads a file with `{"impulse": […]}`; whatever else it holds is left aside. Where a contact has several numbers, they stand one
    /// after the other, or each contact has a list of its own.
    pub(crate) fn read<M: Mechanics>(file: &Path, problem: &ContactProblem<M>) -> Result<Self> {
        let name = || file.display().to_string();
        let text = read_text(file)?;
        let each = M::Impulse::LEN;
        let in_lists = || {
            let Read { impulse, from } = of_json::<Read<Vec<f64>>>(&text)?;
            let wrong = impulse.iter().enumerate().find(|(_, list)| list.len() != each);
            if let Some((index, list)) = wrong {
                let (found, contacts) = (list.len(), problem.contact_count());
                return Err(format!(
                    "`impulse[{index}]` has {found} values where each of {contacts} contacts has {each}"
                ));
            }
            Ok(Read { impulse: impulse.concat(), from })
        };
        let flat = of_json::<Read<f64>>(&text).or_else(|error| {
            let is_in_lists = each > 1 && error.contains("invalid type: sequence");
            if is_in_lists { in_lists() } else { Err(error) }
        });
        let Read { impulse, from } = flat.map_err(|error| anyhow!("{}: {}", name(), meant(&text, error)))?;
        let (found, expected) = (impulse.len(), problem.impulse_count());
        if found != expected {
            let contacts = problem.contact_count();
            let each =
                if expected == contacts { String::new() } else { format!(", {expected} values in all") };
            bail!("{}: `impulse` has {found} values where the problem has {contacts} contacts{each}", name());
        }
        Ok(Self { impulse, from })
    }
}

/// The `error` about a file of impulses with this text, with the key that stands in the place of `impulse`, or with the form of the file
/// where it is no JSON.
fn meant(text: &str, error: String) -> String {
    let Ok(content) = serde_json::from_str::<Value>(text) else {
        return format!(
            "{error}; impulses are read from a file with {{\"impulse\": […]}}, as `gravel solve --impulses` writes it"
        );
    };
    let meant = |key: &&String| *key != "impulse" && !suggest::of(key, ["impulse"]).is_empty();
    let meant = content.as_object().and_then(|content| content.keys().find(meant));
    let meant = meant.map(|key| format!(": `{key}` is no key{}", suggest::of(key, ["impulse"])));
    error + &meant.unwrap_or_default()
}

/// A kept answer: impulses that solve the problem, or a ray that proves that nothing does (N·s).
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum Kept {
    Impulses(Vec<f64>),
    Ray(Vec<f64>),
}

/// Returns the known solutions of a frictionless problem, from `results/references` if they are there, else computed and kept
/// there.
pub(crate) fn known_smooth<const D: usize>(
    root: &Root,
    frozen: &Frozen<Smooth<D>>,
) -> Result<Known<Smooth<D>>>
where
    Smooth<D>: Studied,
{
    Ok(match answer(root, frozen)? {
        Answer::Solution { impulses, .. } => Known::of(&frozen.problem, vec![impulses]),
        Answer::Infeasible { .. } => Known::none(&frozen.name),
        Answer::Unknown { impulses, certificate, why } => {
            eprintln!("{}: no reference: {why}; the best impulses are {certificate}", frozen.name);
            Known::near(&frozen.problem, &impulses)
        }
    })
}

/// The reference of a problem, kept or computed.
pub(crate) fn answer<const D: usize>(root: &Root, frozen: &Frozen<Smooth<D>>) -> Result<Answer>
where
    Smooth<D>: Studied,
{
    let kept = root.kept("results/references", &format!("{}.json", content_hash(frozen)));
    if let Some(path) = kept.as_deref().filter(|path| path.exists()) {
        match read(path, &frozen.problem) {
            Ok(answer) => return Ok(answer),
            Err(error) => eprintln!("{error:#}: computed again"),
        }
    }
    let answer = reference::solve(&frozen.problem);
    let Some(path) = kept else { return Ok(answer) };
    let kept = match &answer {
        Answer::Solution { impulses, .. } => Kept::Impulses(impulses.clone()),
        Answer::Infeasible { ray } => Kept::Ray(ray.clone()),
        Answer::Unknown { .. } => return Ok(answer),
    };
    write_sealed(&path, &serde_json::to_string(&kept)?)?;
    Ok(answer)
}

/// Reads a kept answer, and believes nothing of it that the problem does not confirm.
fn read<const D: usize>(path: &Path, problem: &ContactProblem<Smooth<D>>) -> Result<Answer> {
    let file = || path.display().to_string();
    let (text, sealed) = read_sealed(path)?;
    let kept: Kept = serde_json::from_str(&text).with_context(file)?;
    let (Kept::Impulses(values) | Kept::Ray(values)) = &kept;
    if values.len() != problem.contact_count() {
        bail!("{}: {} values for {} contacts", file(), values.len(), problem.contact_count());
    }
    let answer = match kept {
        Kept::Impulses(impulses) => {
            let certificate = certify(problem, &impulses);
            if !certificate.certified() {
                bail!("{}: {certificate}", file());
            }
            Answer::Solution { impulses, certificate }
        }
        Kept::Ray(ray) => {
            if !proves_infeasible(problem, &ray) {
                bail!("{}: no proof that the problem has no solution", file());
            }
            Answer::Infeasible { ray }
        }
    };
    if !sealed {
        eprintln!("{}: it had no checksum; it is right, and has one now", file());
        write_sealed(path, &text)?;
    }
    Ok(answer)
}
