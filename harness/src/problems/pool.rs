//! Pools of certified solutions of problems with friction: kept in `results/references`, certified again each time they are read.

use crate::identity::{code_version, content_hash};
use crate::problems::{Known, Root, Studied};
use crate::terminal::{progress, read_sealed, write_sealed};
use active_set::ActiveSet;
use anyhow::{Context, Result};
use cases::Frozen;
use contact::{Packing, Solver};
use reference::{
    InteriorPoint, Rough, RoughSolution, certify, distance, is_same, polished, solve_rough, take,
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Starts beside r = 0 from which solutions with friction are sought: where there are several, three find some of them.
const STARTS: u64 = 3;

/// Returns the known solutions of a problem with friction: its pool of certified ones.
pub(crate) fn known_rough<M: Studied + Rough>(root: &Root, frozen: &Frozen<M>) -> Result<Known<M>>
where
    ActiveSet: Solver<M>,
{
    let Some(pool) = pool(root, frozen, STARTS)? else { return Ok(Known::none(&frozen.name)) };
    let problem = &frozen.problem;
    if let [best] = &pool[..]
        && !best.certificate.certified()
    {
        eprintln!("{}: no certified solution; the best impulses are {}", frozen.name, best.certificate);
        return Ok(Known::near(problem, &best.impulses));
    }
    Ok(Known::of(problem, pool.into_iter().map(|solution| solution.impulses).collect()))
}

/// The certified solutions of a problem with friction that are known, those from so many `starts` among them, each different from
/// the others; the best impulses, where none is certified. `None` if it is proved that there is none.
pub(crate) fn pool<M: Studied + Rough>(
    root: &Root,
    frozen: &Frozen<M>,
    starts: u64,
) -> Result<Option<Vec<RoughSolution>>>
where
    ActiveSet: Solver<M>,
{
    let path = path(root, frozen);
    let code = code_version::<InteriorPoint>().unwrap_or_default();
    let mut sealed = true;
    let mut kept = Pool { starts: 0, code: code.to_owned(), solutions: Vec::new() };
    if path.exists() {
        match read(&path) {
            Ok((read, is_sealed)) => (kept, sealed) = (read, is_sealed),
            Err(error) => eprintln!("{error:#}: computed again"),
        }
    }
    let problem = &frozen.problem;
    let mut pool = certified(problem, std::mem::take(&mut kept.solutions));
    if !pool.iter().any(|solution| solution.certificate.certified()) && M::has_no_solution(problem) {
        return Ok(None);
    }
    // From r = 0 on, each start once; again, where another code sought.
    if kept.code != code {
        kept.starts = 0;
    }
    if kept.starts <= starts {
        let bar = progress::bar(starts + 1, "starts");
        for found in solve_rough(problem, kept.starts..=starts, || bar.inc(1)) {
            take(problem, &mut pool, found);
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

/// The solutions that kept impulses (N·s) are.
fn certified<M: Rough>(problem: &Packing<M>, kept: Vec<Vec<f64>>) -> Vec<RoughSolution> {
    let mut pool = Vec::new();
    for impulses in kept.into_iter().filter(|r| r.len() == problem.impulse_count()) {
        let certificate = certify(problem, &impulses);
        take(problem, &mut pool, RoughSolution { impulses, certificate });
    }
    pool
}

/// The certified solution to which the end of a run, `r` (N·s), is polished: whether it is among those `known`, and how far it is
/// from r. A new one enters the kept pool, so that studies to come know it.
pub(crate) fn polished_to<M: Studied + Rough>(
    root: &Root,
    frozen: &Frozen<M>,
    known: &Known<M>,
    r: &[f64],
) -> Result<Option<(bool, f64)>>
where
    ActiveSet: Solver<M>,
{
    let problem = &frozen.problem;
    if known.nearest().is_none() {
        return Ok(None);
    }
    let Some(found) = polished(problem, r) else { return Ok(None) };
    let by = distance(problem, &found.impulses, r);
    let is_known = known.impulses.iter().any(|known| is_same(distance(problem, known, &found.impulses)));
    if !is_known {
        keep(root, frozen, found)?;
    }
    Ok(Some((is_known, by)))
}

/// Adds a solution to the kept pool, one at a time.
fn keep<M: Studied + Rough>(root: &Root, frozen: &Frozen<M>, found: RoughSolution) -> Result<()> {
    static KEPT: Mutex<()> = Mutex::new(());
    let _alone = KEPT.lock();
    let path = path(root, frozen);
    let (mut kept, _) = read(&path)?;
    let mut pool = certified(&frozen.problem, kept.solutions);
    take(&frozen.problem, &mut pool, found);
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
fn path<M: Studied>(root: &Root, frozen: &Frozen<M>) -> PathBuf {
    root.join("results/references").join(content_hash(frozen)).with_extension("json")
}
