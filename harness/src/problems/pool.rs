//! Pools of certified solutions of problems with friction: kept in `results/references`, certified again each time they are read.

use crate::identity::code_version;
use crate::problems::Known;
use crate::root::Root;
use crate::terminal::{at_hand, progress, read_sealed, write_sealed};
use anyhow::{Context, Result};
use lineup::{Frictional, Law, OneProblem, content_hash};
use reference::{RoughSolution, is_same, take};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Starts beside r = 0 from which solutions with friction are sought: where there are several, three find some of them.
pub(super) const STARTS: u64 = 3;

/// The certified solutions of a problem with friction that are known, those from so many `starts` among them, each different from
/// the others; the best impulses, where none is certified. `None` if it is proved that there is none.
pub(crate) fn pool(
    root: &Root,
    problem: &dyn OneProblem,
    law: &dyn Frictional,
    starts: u64,
) -> Result<Option<Vec<RoughSolution>>> {
    let path = path(root, problem);
    let code = code_version("reference").unwrap_or_default();
    let none = Pool { starts: 0, code: code.to_owned(), solutions: Vec::new() };
    let (mut kept, sealed) = at_hand(&path, || read(&path)).unwrap_or((none, true));
    let mut pool = certified(problem, std::mem::take(&mut kept.solutions));
    if !pool.iter().any(|solution| solution.certificate.certified()) && law.ray().is_some() {
        return Ok(None);
    }
    // From r = 0 on, each start once; again, where another code sought.
    if kept.code != code {
        kept.starts = 0;
    }
    if kept.starts <= starts {
        let bar = progress::bar(starts + 1, "starts");
        for found in law.solutions(kept.starts..=starts, &mut || bar.inc(1)) {
            take(&mut pool, found, |a, b| problem.distance(a, b));
        }
        bar.finish_and_clear();
        let solutions = pool.iter().map(|solution| solution.impulses.clone()).collect();
        write(&path, &Pool { starts: starts + 1, code: code.to_owned(), solutions })?;
    } else if !sealed {
        eprintln!(
            "{}: it had no checksum; what it holds is certified again, and has one now",
            path.display()
        );
        let solutions = pool.iter().map(|solution| solution.impulses.clone()).collect();
        write(&path, &Pool { solutions, ..kept })?;
    }
    Ok(Some(pool))
}

/// Reads a kept pool, and whether it has a checksum.
fn read(path: &Path) -> Result<(Pool, bool)> {
    let (text, sealed) = read_sealed(path)?;
    Ok((serde_json::from_str(&text).with_context(|| path.display().to_string())?, sealed))
}

fn write(path: &Path, pool: &Pool) -> Result<()> {
    write_sealed(path, &serde_json::to_string(pool)?)
}

/// Certifies kept impulses (N·s), and returns those of different velocities.
pub(crate) fn certified(problem: &dyn OneProblem, kept: Vec<Vec<f64>>) -> Vec<RoughSolution> {
    let (mut pool, facts) = (Vec::new(), problem.facts());
    for impulses in kept.into_iter().filter(|r| r.len() == facts.of_contact * facts.contacts) {
        let certificate = problem.certify(&impulses);
        take(&mut pool, RoughSolution { impulses, certificate }, |a, b| problem.distance(a, b));
    }
    pool
}

/// The certified solution to which the end of a run, `r` (N·s), is polished: whether it is among those `known`, and how far it is
/// from r. A new one enters the kept pool, so that studies to come know it; the problems of this one have read it before their first run.
pub(crate) fn polished_to(
    root: &Root,
    problem: &dyn OneProblem,
    known: &Known,
    r: &[f64],
) -> Result<Option<(bool, f64)>> {
    if known.nearest().is_none() {
        return Ok(None);
    }
    let Law::Frictional(law) = problem.law() else { return Ok(None) };
    let Some(found) = law.polished(r) else { return Ok(None) };
    let by = problem.distance(&found.impulses, r);
    let is_known = known.impulses.iter().any(|known| is_same(problem.distance(known, &found.impulses)));
    if !is_known {
        keep(root, problem, found)?;
    }
    Ok(Some((is_known, by)))
}

/// Adds a solution to the kept pool, one at a time.
fn keep(root: &Root, problem: &dyn OneProblem, found: RoughSolution) -> Result<()> {
    static KEPT: Mutex<()> = Mutex::new(());
    let _alone = KEPT.lock();
    let path = path(root, problem);
    let (mut kept, _) = read(&path)?;
    let mut pool = certified(problem, kept.solutions);
    take(&mut pool, found, |a, b| problem.distance(a, b));
    kept.solutions = pool.into_iter().map(|solution| solution.impulses).collect();
    write(&path, &kept)
}

/// A kept pool of solutions.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pool {
    /// From how many starts they were sought.
    starts: u64,
    /// Version of the code that sought them.
    code: String,
    /// Impulses of each (N·s).
    solutions: Vec<Vec<f64>>,
}

/// Returns the file that keeps the pool of a problem.
fn path(root: &Root, problem: &dyn OneProblem) -> PathBuf {
    root.join("results/references").join(content_hash(problem)).with_extension("json")
}
