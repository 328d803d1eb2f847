//! Answers to a problem that gravel finds, within a counted limit: the same on every machine.

use super::answers::Answers;
use crate::plan::Method;
use crate::problems::{Known, Problem};
use crate::run::outcome;
use crate::terminal::{Line, progress};
use anyhow::{Result, bail};
use contact::Measure;
use lineup::{Frictional, Law, OneProblem, Posed};
use reference::{Answer, RoughSolution, SEARCHES, take};
use runner::{Progress, Stop};
use std::ops::ControlFlow;

/// Iterations of each run of the active set; and of accelerated sweeps on more contacts than [`MANY`], where an iteration of the active
/// set may be factors of minutes.
const MOST: u64 = 20_000;
const SWEEPS: u64 = 2_000;
const MANY: usize = 5_000;

/// Contacts up to which solutions are sought from three random starts as well, each of many more iterations.
const FEW: usize = 200;
const STARTS: u64 = 3;

/// Contacts up to which a continuation is tried, which may be 300 searches of 10,000 iterations.
const CONTINUED: usize = 1_000;

/// Returns the answers to a problem, and the way in which they were found.
pub(crate) fn sought(problem: &Problem) -> Result<(Answers, String)> {
    let grains = match &problem.posed {
        Posed::Grains(grains) => &**grains,
        Posed::W(_) => {
            let (r, how) = run(problem, false)?;
            return Ok((Answers::Best(r), how));
        }
    };
    match grains.law() {
        Law::Frictionless(law) => {
            let how = "the reference: active set, interior point, dual active set";
            let answers = match law.reference() {
                Answer::Solution { impulses, .. } => Answers::Solutions(vec![impulses]),
                Answer::Infeasible { ray } => Answers::Ray(ray),
                Answer::Unknown { impulses, .. } => Answers::Best(impulses),
            };
            Ok((answers, how.to_owned()))
        }
        Law::Frictional(law) => match law.ray() {
            Some(ray) => Ok((Answers::Ray(ray), "exact arithmetic on the normal parts".to_owned())),
            None => with_friction(problem, grains, law),
        },
    }
}

/// Seeks solutions from r = 0, from the impulses of the time step before, and from random ones where contacts are few; where none is
/// found, by a continuation.
fn with_friction(
    problem: &Problem,
    grains: &dyn OneProblem,
    law: &dyn Frictional,
) -> Result<(Answers, String)> {
    let mut pool: Vec<RoughSolution> = Vec::new();
    let mut ends = Vec::new();
    for warm in [false, true] {
        if warm && grains.start().is_empty() {
            continue;
        }
        let (impulses, how) = run(problem, warm)?;
        let certificate = grains.certify(&impulses);
        let end = RoughSolution { impulses, certificate };
        let end = if end.certificate.certified() { end } else { law.polished(&end.impulses).unwrap_or(end) };
        ends.push((grains.measures(&[], &end.impulses).natural_map, end.impulses.clone(), how));
        take(&mut pool, end, |a, b| grains.distance(a, b));
    }
    if grains.facts().contacts <= FEW {
        for found in law.solutions(1..=STARTS, &mut || ()) {
            take(&mut pool, found, |a, b| grains.distance(a, b));
        }
    }
    let is_small = grains.facts().contacts <= CONTINUED;
    if is_small && !pool.iter().any(|solution| solution.certificate.certified()) {
        let bar = progress::bar(SEARCHES, "searches");
        if let Some(found) = law.continued(&mut || bar.inc(1)) {
            return Ok((Answers::Solutions(vec![found.impulses]), "continuation in the offsets".to_owned()));
        }
    }
    // The natural map orders what is not certified; of equal ends the first.
    let best = ends.into_iter().reduce(|best, end| if end.0 < best.0 { end } else { best });
    let Some((_, impulses, how)) = best else { bail!("no run") };
    if pool.iter().any(|solution| solution.certificate.certified()) {
        let is_of_a_run = pool.iter().any(|solution| solution.impulses == impulses);
        let how = if is_of_a_run { how } else { "active-set from random impulses".to_owned() };
        let all = pool.into_iter().map(|solution| solution.impulses).collect();
        return Ok((Answers::Solutions(all), how));
    }
    Ok((Answers::Best(impulses), how))
}

/// Runs the active set, or accelerated sweeps where contacts are many, and returns its last impulses (N·s) and the run in words.
fn run(problem: &Problem, warm: bool) -> Result<(Vec<f64>, String)> {
    let accelerated = [("acceleration".to_owned(), "nesterov".to_owned())];
    let (name, settings, most) = if problem.posed.facts().contacts > MANY {
        ("nsgs", &accelerated[..], SWEEPS)
    } else {
        ("active-set", &[][..], MOST)
    };
    let method = Method::parse(name, settings)?;
    // No residual is asked for: the run ends where its method makes no progress.
    let stop = Stop { on: Measure::NaturalMap, tolerance: 0.0, max_iterations: most };
    let mut line = Line::alone(format!("{} on {}", method.name, problem.name));
    // A signal ends the program, which has written nothing of this problem yet.
    let mut observe = |progress: &Progress| {
        line.show(progress, stop.on);
        ControlFlow::Continue(())
    };
    let ended = outcome(problem, &Known::default(), (&method, &stop), &problem.start(warm), &mut observe)?;
    let from = if warm { "the impulses of the time step before" } else { "r = 0" };
    Ok((ended.impulses, format!("{name} from {from}, at most {most} iterations")))
}
