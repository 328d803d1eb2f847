//! Reference solutions: computed once for each problem, kept in `results/references`, certified again each time they are read.

use crate::problems::pool::{STARTS, pool};
use crate::root::Root;
use crate::terminal::{at_hand, read_sealed, write_sealed};
use anyhow::{Context, Result, bail};
use lineup::{Frictionless, Law, OneProblem, Posed, content_hash, solution};
use reference::{Answer, RoughSolution};
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
        let Some(Found { mut solutions, why }) = found(root, problem, STARTS)? else {
            eprintln!("{name}: the problem has no solution");
            return Ok(Self { is_infeasible: true, ..Self::default() });
        };
        if let [RoughSolution { certificate, .. }] = &solutions[..]
            && !certificate.certified()
        {
            eprintln!("{name}: no certified solution{why}; the best impulses are {certificate}");
            return Ok(Self { nearest: solutions.pop().map(|best| best.impulses), ..sought });
        }
        Ok(Self { impulses: solutions.into_iter().map(|solution| solution.impulses).collect(), ..sought })
    }

    /// Returns stored, certified solutions (N·s), or the fact that none exists, as known.
    pub(crate) fn stored(impulses: Vec<Vec<f64>>, is_infeasible: bool) -> Self {
        Self { impulses, is_infeasible, was_sought: !is_infeasible, ..Self::default() }
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

/// Certified solutions; else the best impulses alone, and what is known of the reason.
pub(crate) struct Found {
    pub(crate) solutions: Vec<RoughSolution>,
    pub(crate) why: String,
}

/// Returns the solutions of a problem, with friction those of its pool after so many starts; none if it is proved to have none.
pub(crate) fn found(root: &Root, problem: &dyn OneProblem, starts: u64) -> Result<Option<Found>> {
    let (impulses, certificate, why) = match problem.law() {
        Law::Frictional(law) => {
            let pool = pool(root, problem, law, starts)?;
            return Ok(pool.map(|solutions| Found { solutions, why: String::new() }));
        }
        Law::Frictionless(law) => match answer(root, problem, law)? {
            Answer::Infeasible { .. } => return Ok(None),
            Answer::Solution { impulses, certificate } => (impulses, certificate, String::new()),
            Answer::Unknown { impulses, certificate, why } => (impulses, certificate, format!(": {why}")),
        },
    };
    Ok(Some(Found { solutions: vec![RoughSolution { impulses, certificate }], why }))
}

/// A kept answer: impulses that solve the problem, or a ray that proves that nothing does (N·s).
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum Kept {
    Impulses(Vec<f64>),
    Ray(Vec<f64>),
}

/// The reference of a problem, kept or computed.
fn answer(root: &Root, problem: &dyn OneProblem, law: &dyn Frictionless) -> Result<Answer> {
    let kept = root.kept("results/references", &format!("{}.json", content_hash(problem)));
    if let Some(answer) = kept.as_deref().and_then(|path| at_hand(path, || read(path, problem, law))) {
        return Ok(answer);
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
