//! Reference solutions: computed once for each problem, kept in `results/references`, certified anew each time they are read.

use crate::problems::files::{Root, content_hash};
use crate::terminal::output::write_whole;
use analysis::proves_infeasible;
use anyhow::{Context, Result, anyhow, bail};
use cases::{Frozen, all_missing};
use contact::{ContactProblem, Truth};
use reference::{Answer, certify};
use runner::Status;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// What is known of the solution of a problem.
pub(crate) enum Known {
    /// The solution, and impulses that reach it (N·s).
    Solution { truth: Truth, impulses: Vec<f64> },
    /// That there is none.
    Infeasible,
    /// A solution that could not be certified: no truth.
    Uncertified(Truth),
    /// Nothing.
    Nothing,
}

impl Known {
    pub(crate) fn truth(&self) -> Option<&Truth> {
        match self {
            Self::Solution { truth, .. } => Some(truth),
            Self::Infeasible | Self::Uncertified(_) | Self::Nothing => None,
        }
    }

    /// The velocity that is nearest to a solution, as far as is known: it tells which contacts are closed.
    pub(crate) fn nearest(&self) -> Option<&Truth> {
        match self {
            Self::Solution { truth, .. } | Self::Uncertified(truth) => Some(truth),
            Self::Infeasible | Self::Nothing => None,
        }
    }

    pub(crate) fn impulses(&self) -> Option<&[f64]> {
        match self {
            Self::Solution { impulses, .. } => Some(impulses),
            Self::Infeasible | Self::Uncertified(_) | Self::Nothing => None,
        }
    }

    /// How a run ended: nothing converges on a problem without solution.
    pub(crate) fn ending(&self, status: Status) -> Status {
        match (self, status) {
            (Self::Infeasible, Status::Converged) => Status::FalseConvergence,
            _ => status,
        }
    }
}

/// Impulses that another code, or another run, gave.
#[derive(Clone, Debug, JsonSchema, Deserialize)]
pub(crate) struct Given {
    /// In the problem's contact order (N·s).
    pub(crate) impulse: Vec<f64>,
    /// Who gave them.
    #[serde(default)]
    pub(crate) from: String,
}

impl Given {
    /// Reads a file with `{"impulse": […]}`; whatever else it tells is left aside.
    pub(crate) fn read(file: &Path, problem: &ContactProblem) -> Result<Self> {
        let name = || file.display().to_string();
        let text = std::fs::read_to_string(file).with_context(name)?;
        let given: Self = serde_json::from_str(&text).map_err(|error| {
            let error = error.to_string();
            // A text that is no JSON lacks more than keys.
            let content = serde_json::from_str::<Value>(&text);
            anyhow!("{}: {}", name(), content.map_or(error.clone(), |all| all_missing::<Self>(&all, error)))
        })?;
        let (found, expected) = (given.impulse.len(), problem.contact_count());
        if found != expected {
            bail!("{}: `impulse` has {found} values where the problem has {expected} contacts", name());
        }
        Ok(given)
    }
}

/// A kept answer: impulses that solve the problem, or a ray that proves that nothing does (N·s).
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum Kept {
    Impulses(Vec<f64>),
    Ray(Vec<f64>),
}

/// What is known of a problem, from `results/references` if it is there, else computed and kept there.
pub(crate) fn known(root: &Root, frozen: &Frozen) -> Result<Known> {
    Ok(match answer(root, frozen)? {
        Answer::Solution { impulses, .. } => {
            Known::Solution { truth: Truth::new(&frozen.problem, &impulses), impulses }
        }
        Answer::Infeasible { .. } => {
            eprintln!("{}: the problem has no solution", frozen.name);
            Known::Infeasible
        }
        Answer::Unknown { impulses, certificate, why } => {
            eprintln!("{}: no reference: {why}; the best impulses are {certificate}", frozen.name);
            Known::Uncertified(Truth::new(&frozen.problem, &impulses))
        }
    })
}

/// The reference of a problem, kept or computed.
pub(crate) fn answer(root: &Root, frozen: &Frozen) -> Result<Answer> {
    let folder = root.join("results/references");
    let path = folder.join(content_hash(frozen)).with_extension("json");
    if path.exists() {
        match read(&path, &frozen.problem) {
            Ok(answer) => return Ok(answer),
            Err(error) => eprintln!("{error:#}: computed anew"),
        }
    }
    let answer = reference::solve(&frozen.problem);
    let kept = match &answer {
        Answer::Solution { impulses, .. } => Kept::Impulses(impulses.clone()),
        Answer::Infeasible { ray } => Kept::Ray(ray.clone()),
        Answer::Unknown { .. } => return Ok(answer),
    };
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    write_whole(&path, &serde_json::to_string(&kept)?)?;
    Ok(answer)
}

/// Reads a kept answer, and believes nothing of it that the problem does not confirm.
fn read(path: &Path, problem: &ContactProblem) -> Result<Answer> {
    let file = || path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(file)?;
    let kept: Kept = serde_json::from_str(&text).with_context(file)?;
    let (Kept::Impulses(values) | Kept::Ray(values)) = &kept;
    if values.len() != problem.contact_count() {
        bail!("{}: {} values for {} contacts", file(), values.len(), problem.contact_count());
    }
    match kept {
        Kept::Impulses(impulses) => {
            let certificate = certify(problem, &impulses);
            if !certificate.certified() {
                bail!("{}: {certificate}", file());
            }
            Ok(Answer::Solution { impulses, certificate })
        }
        Kept::Ray(ray) => {
            if !proves_infeasible(problem, &ray) {
                bail!("{}: no proof that the problem has no solution", file());
            }
            Ok(Answer::Infeasible { ray })
        }
    }
}
