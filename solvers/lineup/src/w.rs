//! Problems as they are posed: between grains, or as W alone.

use crate::facts::Facts;
use crate::methods::Ours;
use crate::problem::{Observe, OneProblem, Run};
use anyhow::{Result, bail, ensure};
use contact::Measure;
use local::{LocalProblem, Method};
use runner::{LocalTruth, Measured, Outcome, Stop, solve_local};
use std::ops::ControlFlow;

/// A problem as it is posed.
pub enum Posed {
    /// Between grains.
    Grains(Box<dyn OneProblem>),
    /// W alone, as files of other codes have it.
    W(Box<LocalProblem>),
}

impl Posed {
    /// Returns its kind and size.
    pub fn facts(&self) -> Facts {
        match self {
            Self::Grains(problem) => problem.facts(),
            Self::W(problem) => Facts {
                mechanics: "local",
                has_friction: problem.friction().iter().any(|mu| *mu != 0.0),
                dimensions: problem.dimension(),
                grains: 0,
                contacts: problem.contact_count(),
                of_grain: 0,
                of_contact: problem.dimension(),
            },
        }
    }

    /// Returns the problem between grains.
    ///
    /// # Errors
    /// If there is W alone.
    pub fn grains(&self) -> Result<&dyn OneProblem> {
        match self {
            Self::Grains(problem) => Ok(&**problem),
            Self::W(_) => bail!("there is W alone, without grains"),
        }
    }

    /// Runs a method; the observer sees every iterate, and may end the run.
    ///
    /// # Errors
    /// Says why the method cannot start on the problem.
    pub fn solve(&self, ours: &Ours, run: Run, observe: &mut Observe) -> Result<Outcome> {
        let problem = match self {
            Self::Grains(problem) => return problem.solve(ours, run, observe),
            Self::W(problem) => problem,
        };
        ensure!(run.r0.iter().all(|r| *r == 0.0), "where there is W alone, methods begin from r = 0");
        let truth = run.truths.first().map(|r| LocalTruth::new(problem, r.clone()));
        Ok(solve_local(truth.as_ref(), ours.on_w()?, problem, run.stop, run.measured, observe)?)
    }
}

/// A natural map that tells a solution (–), and the iterations in which it is looked for.
const SOLVED: Stop = Stop { on: Measure::NaturalMap, tolerance: 1e-12, max_iterations: 200_000 };

/// Returns the impulses of a solution of W alone (N·s), if the active set ends at one. With friction there may be others.
pub fn solution(problem: &LocalProblem) -> Option<Vec<f64>> {
    let method = Method::ActiveSet { start_accuracy: active_set::ACCURACY_OF_DEARER };
    let observe = &mut |_: &runner::Progress| ControlFlow::Continue(());
    let outcome = solve_local(None, method, problem, &SOLVED, Measured::Needed, observe).ok()?;
    (outcome.measures.natural_map <= SOLVED.tolerance).then_some(outcome.impulses)
}
