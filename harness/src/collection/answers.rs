//! Stored answers to a problem, and its status, which is recomputed from them.

use crate::problems::certified;
use anyhow::{Result, bail, ensure};
use lineup::{Law, Posed};
use reference::ROUND_OFF;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// Reports whether it says more of an open problem than what is `known`: its solutions, a proof, or a lesser natural map.
    pub(crate) fn is_better(&self, known: &Self) -> bool {
        let is_nearer = self.natural_map.zip(known.natural_map).is_some_and(|(now, known)| now < known);
        known.status == Status::Open && (self.status != Status::Open || is_nearer)
    }

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

/// Reports whether two numbers are the same residual, computed twice.
pub(crate) fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= THREE_DIGITS * a.abs().max(b.abs()) + ROUNDED
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
    /// Returns the first impulses (N·s), and whether they are those of a proof, one of each contact.
    pub(crate) fn first(&self) -> (&[f64], bool) {
        match self {
            Self::Solutions(all) => (all.first().map_or(&[], Vec::as_slice), false),
            Self::Best(r) => (r, false),
            Self::Ray(ray) => (ray, true),
        }
    }

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
                let different = certified(problem, all.clone());
                let is_certified = different.iter().all(|solution| solution.certificate.certified());
                ensure!(is_certified && !all.is_empty(), "a stored solution is not certified");
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
                    Law::Frictional(law) => law.proves_infeasible(ray),
                };
                ensure!(proves, "the stored ray does not prove that there is no solution");
                none
            }
        })
    }
}
