//! Reference solutions: computed once for each problem, kept in `results/references`, certified again each time they are read.

use crate::problems::Root;
use crate::problems::pool::{STARTS, pool};
use crate::terminal::{read_sealed, write_sealed};
use anyhow::{Context, Result, bail};
use lineup::{Frictionless, Law, OneProblem, Posed, content_hash, solution};
use reference::Answer;
use results::schema::KnownSolutions;
use runner::Status;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Known solutions of a problem; by default none was sought.
#[derive(Default)]
pub(crate) struct Known {
    /// Certified impulses (N·s). Without friction one is enough: all have the same velocities.
    pub(crate) impulses: Vec<Vec<f64>>,
    /// The best impulses, where none could be certified (N·s).
    nearest: Option<Vec<f64>>,
    was_sought: bool,
    is_infeasible: bool,
}

impl Known {
    /// Returns the known solutions of the problem of this name, read, or computed and kept.
    pub(crate) fn of(root: &Root, name: &str, problem: &Posed) -> Result<Self> {
        let sought = Self { was_sought: true, ..Self::default() };
        let problem = match problem {
            Posed::Grains(problem) => &**problem,
            Posed::W(problem) => {
                return Ok(Self { impulses: solution(problem).into_iter().collect(), ..sought });
            }
        };
        let none = || {
            eprintln!("{name}: the problem has no solution");
            Self { is_infeasible: true, ..Self::default() }
        };
        match problem.law() {
            Law::Frictionless(law) => Ok(match answer(root, problem, law)? {
                Answer::Solution { impulses, .. } => Self { impulses: vec![impulses], ..sought },
                Answer::Infeasible { .. } => none(),
                Answer::Unknown { impulses, certificate, why } => {
                    eprintln!("{name}: no reference: {why}; the best impulses are {certificate}");
                    Self { nearest: Some(impulses), ..sought }
                }
            }),
            Law::Frictional { problem: law, .. } => {
                let Some(pool) = pool(root, problem, law, STARTS)? else { return Ok(none()) };
                if let [best] = &pool[..]
                    && !best.certificate.certified()
                {
                    eprintln!("{name}: no certified solution; the best impulses are {}", best.certificate);
                    return Ok(Self { nearest: Some(best.impulses.clone()), ..sought });
                }
                Ok(Self { impulses: pool.into_iter().map(|solution| solution.impulses).collect(), ..sought })
            }
        }
    }

    /// Returns the impulses that are nearest to a solution, as far as is known (N·s): they show which contacts are closed.
    pub(crate) fn nearest(&self) -> Option<&[f64]> {
        self.impulses.first().or(self.nearest.as_ref()).map(Vec::as_slice)
    }

    /// Returns the number of known solutions and the greatest distance between two of them; nothing where none was sought.
    pub(crate) fn solutions(&self, problem: &Posed) -> KnownSolutions {
        let all: Vec<&[f64]> = self.impulses.iter().map(Vec::as_slice).collect();
        let spread = match problem {
            Posed::Grains(problem) if !all.is_empty() => problem.spread(&all),
            _ => f64::NAN,
        };
        let solutions = self.was_sought.then_some(all.len() as u32);
        KnownSolutions { solutions, spread, ..KnownSolutions::default() }
    }

    /// Returns the final status of a run: on a problem without solution, convergence is false.
    pub(crate) fn ending(&self, status: Status) -> Status {
        if self.is_infeasible && status == Status::Converged { Status::FalseConvergence } else { status }
    }
}

/// A kept answer: impulses that solve the problem, or a ray that proves that nothing does (N·s).
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum Kept {
    Impulses(Vec<f64>),
    Ray(Vec<f64>),
}

/// The reference of a problem, kept or computed.
pub(crate) fn answer(root: &Root, problem: &dyn OneProblem, law: &dyn Frictionless) -> Result<Answer> {
    let kept = root.kept("results/references", &format!("{}.json", content_hash(problem)));
    if let Some(path) = kept.as_deref().filter(|path| path.exists()) {
        match read(path, problem, law) {
            Ok(answer) => return Ok(answer),
            Err(error) => eprintln!("{error:#}: computed again"),
        }
    }
    let answer = law.reference();
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
fn read(path: &Path, problem: &dyn OneProblem, law: &dyn Frictionless) -> Result<Answer> {
    let file = || path.display().to_string();
    let (text, sealed) = read_sealed(path)?;
    let kept: Kept = serde_json::from_str(&text).with_context(file)?;
    let (Kept::Impulses(values) | Kept::Ray(values)) = &kept;
    let contacts = problem.facts().contacts;
    if values.len() != contacts {
        bail!("{}: {} values for {contacts} contacts", file(), values.len());
    }
    let answer = match kept {
        Kept::Impulses(impulses) => {
            let certificate = problem.certify(&impulses);
            if !certificate.certified() {
                bail!("{}: {certificate}", file());
            }
            Answer::Solution { impulses, certificate }
        }
        Kept::Ray(ray) => {
            if !law.proves_infeasible(&ray) {
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
