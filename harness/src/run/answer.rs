//! A single solve: its run, and the request and the answer under the names that the columns of tables have.

use crate::plan::Method;
use crate::problems::{Known, Problem};
use crate::run::{Ended, derived, ended};
use crate::terminal::merged;
use anyhow::{Result, bail};
use lineup::{Observe, Posed, Run};
use runner::{Measured, Outcome, Stop};
use serde_json::{Value, json};

/// Runs a method from the impulses `r0` (N·s) and returns its outcome.
pub(crate) fn outcome(
    problem: &Problem,
    known: &Known,
    (method, stop): (&Method, &Stop),
    r0: &[f64],
    observe: &mut Observe,
) -> Result<Outcome> {
    let run = Run { truths: &known.impulses, r0, stop, measured: Measured::Needed };
    let Ended { outcome, failed, .. } = ended(method, problem, run, observe)?;
    if let Some(why) = failed {
        bail!("{why}");
    }
    Ok(Outcome { status: known.ending(outcome.status), ..outcome })
}

/// The request.
pub(crate) fn asked(problem: &Problem, method: &Method, stop: &Stop, warm_start: bool) -> Value {
    let facts = problem.posed.facts();
    let mut asked = json!({
        "problem": problem.name,
        "mechanics": facts.mechanics,
        "problem_hash": problem.hash,
        "grains": facts.grains,
        "contacts": facts.contacts,
        "method": method.name,
        "settings": method.settings,
        "warm_start": warm_start,
        "stop_on": stop.on,
        "tolerance": stop.tolerance,
        "max_iterations": stop.max_iterations,
    });
    if let Posed::W(problem) = &problem.posed {
        asked["unknowns"] = problem.dimension().into();
    }
    asked
}

/// The request `asked` and the answer.
pub(crate) fn to_json(asked: Value, outcome: &Outcome) -> Result<Value> {
    let object = json!({
        "derived": derived(outcome),
        "status": outcome.status,
        "iterations": outcome.iterations,
        "setup_s": outcome.setup.as_secs_f64(),
        "iterating_s": outcome.iterating.as_secs_f64(),
        "worst_contact": outcome.measures.worst_contact,
    });
    let object = merged(merged(asked, object), serde_json::to_value(outcome.measures)?);
    Ok(merged(object, serde_json::to_value(outcome.work)?))
}
