//! Reference solutions: computed once for each problem, kept in `results/references`, certified again each time they are read.

use crate::identity::content_hash;
use crate::problems::Root;
use crate::terminal::{read_text, write_kept};
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

/// What is known of the solution of a problem; by default nothing.
#[derive(Default)]
pub(crate) struct Known {
    answer: Option<Answer>,
    /// At the impulses of the answer, also where these could not be certified.
    nearest: Option<Truth>,
}

impl Known {
    pub(crate) fn truth(&self) -> Option<&Truth> {
        self.impulses().and(self.nearest())
    }

    /// The velocity that is nearest to a solution, as far as is known: it shows which contacts are closed.
    pub(crate) fn nearest(&self) -> Option<&Truth> {
        self.nearest.as_ref()
    }

    /// Of the solution (N·s).
    pub(crate) fn impulses(&self) -> Option<&[f64]> {
        match &self.answer {
            Some(Answer::Solution { impulses, .. }) => Some(impulses),
            _ => None,
        }
    }

    /// How a run ended: nothing converges on a problem without solution.
    pub(crate) fn ending(&self, status: Status) -> Status {
        let infeasible = matches!(self.answer, Some(Answer::Infeasible { .. }));
        if infeasible && status == Status::Converged { Status::FalseConvergence } else { status }
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
    /// Reads a file with `{"impulse": […]}`; whatever else it holds is left aside.
    pub(crate) fn read(file: &Path, problem: &ContactProblem) -> Result<Self> {
        let name = || file.display().to_string();
        let text = read_text(file)?;
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
    let answer = answer(root, frozen)?;
    let impulses = match &answer {
        Answer::Solution { impulses, .. } => Some(impulses),
        Answer::Infeasible { .. } => {
            eprintln!("{}: the problem has no solution", frozen.name);
            None
        }
        Answer::Unknown { impulses, certificate, why } => {
            eprintln!("{}: no reference: {why}; the best impulses are {certificate}", frozen.name);
            Some(impulses)
        }
    };
    let nearest = impulses.map(|impulses| Truth::new(&frozen.problem, impulses));
    Ok(Known { answer: Some(answer), nearest })
}

/// The reference of a problem, kept or computed.
pub(crate) fn answer(root: &Root, frozen: &Frozen) -> Result<Answer> {
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
    write_kept(&path, &serde_json::to_string(&kept)?)?;
    Ok(answer)
}

/// Reads a kept answer, and believes nothing of it that the problem does not confirm.
fn read(path: &Path, problem: &ContactProblem) -> Result<Answer> {
    let file = || path.display().to_string();
    let kept: Kept = serde_json::from_str(&read_text(path)?).with_context(file)?;
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
