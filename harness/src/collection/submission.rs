//! Submissions: impulses that a code found for a problem of the collection, judged from these alone.

use super::answers::{Answers, Status, agree};
use super::entry::Entry;
use super::folder::Collection;
use crate::problems::Problem;
use crate::terminal::{read_sealed, write_sealed};
use anyhow::{Context, Result, anyhow, bail, ensure};
use cases::of_json;
use clap::ValueEnum;
use contact::obeys_friction;
use lineup::{Law, OneProblem, Posed, hash_of};
use reference::is_same;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;

/// Word that the files begin with.
pub(crate) const FORMAT: &str = "gravel/submission/1";

/// A submission, as its file has it.
#[derive(Clone, Debug, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Submission {
    /// `"gravel/submission/1"`.
    pub(crate) format: String,
    /// Id of the problem.
    pub(crate) problem: String,
    /// Name of the code.
    pub(crate) code: String,
    /// Version of the code.
    pub(crate) version: String,
    /// Division.
    #[serde(default)]
    pub(crate) division: Division,
    /// Method and settings; of the open division also what they were tuned on.
    #[serde(default)]
    pub(crate) how: String,
    /// Claims of the submitter, none of which is verified but the natural map.
    #[serde(default)]
    pub(crate) claimed: Claimed,
    /// Residual and certificate that gravel computed from the impulses as it accepted them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) verified: Option<Verified>,
    /// Impulses in the problem's contact order, a flat list (N·s).
    pub(crate) impulse: Vec<f64>,
}

/// Longest name of a code, or of its version (B).
const LONGEST: usize = 100;

/// Division of a submission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Division {
    /// The code with its defaults.
    #[default]
    Closed,
    /// The code as it was tuned for such problems; `how` says how.
    Open,
}

impl Division {
    /// Name in files.
    pub(crate) fn name(self) -> &'static str {
        if self == Self::Closed { "closed" } else { "open" }
    }
}

/// Claims of a submitter.
#[derive(Clone, Debug, Default, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Claimed {
    /// Natural map of the impulses (–).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) natural_map: Option<f64>,
    /// Time to solve the problem (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) seconds: Option<f64>,
    /// Machine: processor and threads.
    pub(crate) machine: String,
}

/// Residual and certificate of impulses.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Verified {
    /// Natural map (–).
    pub(crate) natural_map: f64,
    /// True where the impulses have a certificate.
    pub(crate) certified: bool,
}

/// Judgement of a submission, and what it changes.
pub(crate) struct Accepted {
    pub(crate) verified: Verified,
    /// Distance in velocity to the nearest stored solution (–).
    pub(crate) distance: Option<f64>,
    /// The entry and the answers, where they are new.
    pub(crate) better: Option<(Entry, Answers)>,
}

impl Submission {
    /// Reads a submission; its checksum is checked where it has one.
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let (text, _) = read_sealed(file)?;
        let read = || -> Result<Self> {
            let is_json = serde_json::from_str::<serde_json::Value>(&text).is_ok();
            let hint = if is_json { "" } else { "; a submission is JSON, as `gravel submit` writes it" };
            let submission: Self = of_json(&text).map_err(|error| anyhow!("{error}{hint}"))?;
            submission.check()?;
            Ok(submission)
        };
        read().with_context(|| file.display().to_string())
    }

    /// Refuses what has no meaning whatever the problem is.
    pub(crate) fn check(&self) -> Result<()> {
        let Self { format, code, version, division, how, claimed, .. } = self;
        ensure!(format == FORMAT, "`format` is {format:?}: it must be {FORMAT:?}");
        for (key, text) in [("code", code), ("version", version)] {
            ensure!(!text.trim().is_empty(), "`{key}` is empty: it must name the {key}");
            let is_short = text.len() <= LONGEST && !text.contains(char::is_control);
            ensure!(is_short, "`{key}` is {text:?}: it must be a line of at most {LONGEST} bytes");
        }
        let is_silent = *division == Division::Open && how.trim().is_empty();
        ensure!(!is_silent, "`how` is empty: in the open division it must say what was tuned, and on what");
        let seconds = claimed.seconds.unwrap_or(0.0);
        ensure!(
            seconds >= 0.0 && seconds.is_finite(),
            "`claimed.seconds` is {seconds}: it must be finite and not negative"
        );
        Ok(())
    }

    /// Computes what the impulses are worth.
    ///
    /// # Errors
    /// Says what is false: the number of the impulses, one that the law does not admit, a natural map that is not theirs.
    pub(crate) fn verify(&self, posed: &Posed) -> Result<Verified> {
        let (facts, r) = (posed.facts(), &self.impulse);
        let (each, wanted) = (facts.of_contact, facts.of_contact * facts.contacts);
        ensure!(
            r.len() == wanted,
            "`impulse` has {} values: problem {} has {} contacts with {each} each, {wanted} in all",
            r.len(),
            self.problem,
            facts.contacts
        );
        let verified = match posed {
            Posed::Grains(problem) => {
                for (k, own) in r.chunks(each).enumerate() {
                    problem
                        .unless_admissible(k, own)
                        .map_err(|why| anyhow!("`impulse` of contact {k} {why}"))?;
                }
                let certified = problem.certify(r).certified();
                Verified { natural_map: problem.measures(&[], r).natural_map, certified }
            }
            Posed::W(problem) => {
                let mut contacts = r.chunks(each).zip(problem.friction()).enumerate();
                if let Some((k, (own, mu))) = contacts.find(|(_, (own, mu))| !obeys_friction(own, **mu)) {
                    bail!(
                        "`impulse` of contact {k} is {own:?}: it must be finite, with a normal part that is not negative and a tangential part of at most {mu} times it"
                    );
                }
                Verified { natural_map: problem.natural_map(r), certified: false }
            }
        };
        let natural_map = verified.natural_map;
        ensure!(
            natural_map.is_finite(),
            "`impulse`: its natural map is {natural_map}: the impulses are beyond all measure"
        );
        let nothing = vec![0.0; wanted];
        let of_nothing = match posed {
            Posed::Grains(problem) => problem.measures(&[], &nothing).natural_map,
            Posed::W(problem) => problem.natural_map(&nothing),
        };
        ensure!(
            natural_map < of_nothing || natural_map == 0.0,
            "`impulse`: its natural map is {natural_map:e}, and that of no impulses {of_nothing:e}: it is no answer"
        );
        if let Some(claimed) = self.claimed.natural_map
            && !agree(claimed, natural_map)
        {
            bail!("`claimed.natural_map` is {claimed:e}: the impulses have {natural_map:e}");
        }
        if let Some(was) = self.verified
            && (was.certified != verified.certified || !agree(was.natural_map, natural_map))
        {
            bail!(
                "`verified` has natural_map {:e}, certified {}: the impulses have {natural_map:e}, {}",
                was.natural_map,
                was.certified,
                verified.certified
            );
        }
        Ok(verified)
    }

    /// Judges the submission on its problem, and what it brings to the answers that are known.
    pub(crate) fn judged(&self, entry: &Entry, problem: &Problem, answers: &Answers) -> Result<Accepted> {
        let verified = self.verify(&problem.posed)?;
        let by = format!("{} {}", self.code, self.version);
        let how = format!(
            "{}, {} division",
            if self.how.is_empty() { "not said" } else { &self.how },
            self.division.name()
        );
        let is_least = entry.known.natural_map.is_none_or(|least| verified.natural_map < least);
        let new = match &problem.posed {
            Posed::Grains(grains) => self.on_grains(&**grains, verified, answers)?,
            Posed::W(_) => is_least.then(|| (Answers::Best(self.impulse.clone()), "")),
        };
        let distance = match &problem.posed {
            Posed::Grains(grains) => distance(&**grains, answers, &self.impulse),
            Posed::W(_) => None,
        };
        let better = match new {
            None => None,
            Some((answers, polished)) => {
                let known = answers.standing(&problem.posed)?;
                let was_open = matches!(entry.known.status, Status::Open | Status::Solved);
                let (by, how) =
                    if was_open { (by, how + polished) } else { (entry.by.clone(), entry.how.clone()) };
                Some((Entry { by, how, known, ..entry.clone() }, answers))
            }
        };
        Ok(Accepted { verified, distance, better })
    }

    /// Returns the answers with these impulses among them, where they bring something, and what was done to them.
    fn on_grains(
        &self,
        problem: &dyn OneProblem,
        verified: Verified,
        answers: &Answers,
    ) -> Result<Option<(Answers, &'static str)>> {
        let frictional = match problem.law() {
            Law::Frictional(problem) => Some(problem),
            Law::Frictionless(_) => None,
        };
        let polished = || frictional.and_then(|law| law.polished(&self.impulse)).map(|found| found.impulses);
        let (solution, how) = if verified.certified {
            (Some(self.impulse.clone()), "")
        } else {
            (polished(), ", polished by gravel")
        };
        Ok(match (answers, solution) {
            (Answers::Ray(_), Some(_)) => {
                bail!(
                    "the impulses are certified, and it is proved that there is no solution: the keeper must look into both"
                )
            }
            (Answers::Solutions(pool), Some(new)) => {
                let is_known = pool.iter().any(|known| is_same(problem.distance(known, &new)));
                let is_full = pool.len() >= MOST;
                (!is_known && !is_full && frictional.is_some())
                    .then(|| (Answers::Solutions([pool.clone(), vec![new]].concat()), how))
            }
            (Answers::Best(_), Some(new)) => Some((Answers::Solutions(vec![new]), how)),
            (Answers::Best(best), None) => {
                let least = problem.measures(&[], best).natural_map;
                (verified.natural_map < least).then(|| (Answers::Best(self.impulse.clone()), ""))
            }
            (_, None) => None,
        })
    }

    /// Returns the name of its file in the collection: the problem, and the hash of all that was submitted.
    pub(crate) fn name(&self) -> String {
        let Self { problem, code, version, division, how, claimed, impulse, .. } = self;
        let hash = hash_of(&json!([code, version, division, how, claimed, impulse]));
        format!("{problem}-{hash}")
    }

    /// Files the submission with what was verified.
    pub(crate) fn file(mut self, collection: &Collection, verified: Verified) -> Result<()> {
        let file = collection.file("submissions", &format!("{}.json.gz", self.name()));
        self.verified = Some(verified);
        write_sealed(&file, &serde_json::to_string(&self)?)
    }
}

/// Solutions that are stored of one problem at most: where there is a continuum, more say nothing new.
const MOST: usize = 8;

/// Returns the distance in velocity of impulses (N·s) to the nearest stored solution (–).
pub(crate) fn distance(problem: &dyn OneProblem, answers: &Answers, r: &[f64]) -> Option<f64> {
    let Answers::Solutions(pool) = answers else { return None };
    pool.iter().map(|known| problem.distance(known, r)).min_by(f64::total_cmp)
}
