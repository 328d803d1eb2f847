//! The loop that runs every method: it advances, reads the impulses, measures, and decides when to stop. (The reference, as the
//! judge of solutions, drives its own steps in `reference::solve`; as a method it is run by this loop like the others.)

mod convergence;

use analysis::any_proves_infeasible;
use contact::{Measure, Measures, Meter, Packing, SetupError, Solver, Truth, Work, law};
use convergence::is_false;
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Until when a method is advanced.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Stop {
    /// The measure that decides.
    pub on: Measure,
    /// The run has converged when the measure is at most this.
    pub tolerance: f64,
    /// The run ends after this many iterations at the latest.
    pub max_iterations: u64,
}

/// `natural_map` ≤ 1e-6, and enough iterations for non-linear Gauss-Seidel to come there on a packing of a thousand
/// discs.
impl Default for Stop {
    fn default() -> Self {
        Self { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 100_000 }
    }
}

impl Stop {
    /// Accepts a tolerance that can be met.
    ///
    /// # Errors
    /// Names it otherwise.
    pub fn check(&self) -> Result<(), SetupError> {
        SetupError::unless_not_negative("tolerance", self.tolerance)
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The measure of the stop rule is at most the tolerance.
    Converged,
    /// It is, and the iterate is far from a solution all the same.
    FalseConvergence,
    /// The greatest number of iterations is reached.
    IterationLimit,
    /// The method says that no further iteration brings it nearer to a solution.
    Stalled,
    /// The iterate is not finite, or q(r) is far above q(0) = 0.
    Diverged,
    /// The impulses grow for ever: they, or their growth, prove that the problem has no solution.
    Infeasible,
    /// The observer stopped the run: it says nothing of the method.
    Interrupted,
}

impl Status {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::FalseConvergence => "false-convergence",
            Self::IterationLimit => "iteration-limit",
            Self::Stalled => "stalled",
            Self::Diverged => "diverged",
            Self::Infeasible => "infeasible",
            Self::Interrupted => "interrupted",
        }
    }
}

/// What an observer sees after every iteration, and once before the first.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Iterations so far.
    pub iteration: u64,
    /// Time spent in `advance` so far.
    pub iterating: Duration,
    /// Measures of the iterate.
    pub measures: &'a Measures,
    /// Counted work so far.
    pub work: Work,
    /// r (N·s).
    pub impulses: &'a [f64],
}

/// What came out of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Number of iterations.
    pub iterations: u64,
    /// Measures of the last iterate.
    pub measures: Measures,
    /// r of the last iterate (N·s).
    pub impulses: Vec<f64>,
    /// V = `V_free` + M⁻¹ H r of the last iterate (m/s).
    pub velocity: Vec<Vector2<f64>>,
    /// Time in `start`.
    pub setup: Duration,
    /// Time in `advance`.
    pub iterating: Duration,
    /// Counted work.
    pub work: Work,
    /// The values that the method worked with where its settings leave one open.
    pub derived: Vec<(&'static str, f64)>,
    /// Multiply-adds of an iteration on the longest subdomain, where there are some.
    pub critical_path: Option<u64>,
}

/// q(r) above this many times the problem's own scale of energy is a divergence. It is far, since a method may converge
/// from far: the first iterate of LATIN has q of the order of κ² times the scale. What grows geometrically passes it
/// all the same.
const ENERGY_BOUND: f64 = 1e20;

/// Where the proof that there is no solution is first looked for, and then at every power of two (iterations): rarely,
/// so that it costs little, and late, so that a curve shows what the measures say meanwhile. A power of two.
const FIRST_LOOK: u64 = 1024;

/// What is left of the natural map since the last look, at most, where no proof is looked for (–): on a problem without
/// solution it stays away from 0.
const CONVERGES: f64 = 0.9;

/// Runs `solver` on `problem` from the impulses `r0` (N·s) until `stop`; `observe` sees every iterate.
///
/// The clock runs in `start` and `advance` only. Where no contact pushes (b ≥ 0), r = 0 solves the problem and
/// the run has converged before its first iteration, whatever `r0`.
///
/// # Errors
/// Names the setting, the stop rule or the start impulse that has no meaning; stopping on the velocity error is the
/// business of [`solve_against`].
pub fn solve(
    solver: &dyn Solver,
    problem: &Packing,
    r0: &[f64],
    stop: &Stop,
    observe: &mut dyn FnMut(&Progress),
) -> Result<Outcome, SetupError> {
    solve_against(None, solver, problem, r0, stop, &mut |progress| {
        observe(progress);
        ControlFlow::Continue(())
    })
}

/// [`solve`] beside a `truth` that is known, if it is: the measures then hold the error. The observer may end the run after
/// any iterate; it is then [`Status::Interrupted`], unless that iterate was the last one anyway.
///
/// # Errors
/// Those of [`solve`]; names the stop rule if it is on the error of a solution that is not known.
pub fn solve_against(
    truth: Option<&Truth>,
    solver: &dyn Solver,
    problem: &Packing,
    r0: &[f64],
    stop: &Stop,
    observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Outcome, SetupError> {
    SetupError::unless_admissible(problem, r0)?;
    stop.check()?;
    let is_known = truth.is_some() || stop.on != Measure::VelocityError;
    let expected = "another measure: the true velocity of this problem is not known";
    SetupError::unless(is_known, "on", stop.on, expected)?;
    let mut meter = Meter::new(problem);
    if let Some(truth) = truth {
        meter = meter.against(truth);
    }
    let clock = Instant::now();
    let mut iteration = solver.start(problem, r0)?;
    let setup = clock.elapsed();

    let scale = meter.scale();
    let mut r = r0.to_vec();
    if scale == 0.0 {
        r.fill(0.0);
    }
    let mut measures = meter.measure(&r, 0.0);
    let energy_bound = ENERGY_BOUND * f64::max(scale, measures.energy.abs());
    let (mut iterations, mut iterating, mut endless) = (0, Duration::ZERO, false);
    // r and natural map at the last two powers of two.
    let (mut at_last_look, mut before_last_look) = (none(), none());
    let status = loop {
        let work = iteration.work();
        let goes_on =
            observe(&Progress { iteration: iterations, iterating, measures: &measures, work, impulses: &r });
        // Before convergence, which a measure can feign where others overflow; and so that a NaN counts as diverged.
        if !(measures.energy <= energy_bound && measures.natural_map.is_finite()) {
            let proved =
                r.iter().all(|r| r.is_finite()) && any_proves_infeasible(problem, std::slice::from_ref(&r));
            break if proved { Status::Infeasible } else { Status::Diverged };
        }
        if scale == 0.0 {
            break Status::Converged;
        }
        if measures.get(stop.on) <= stop.tolerance {
            let (r_then, natural_map_then) = &before_last_look;
            let stays = !(measures.natural_map < CONVERGES * natural_map_then);
            let rays = || vec![r.clone(), growth(r_then, &r)];
            let is_false = is_false(stop, problem, &measures, stays, &rays);
            break if is_false { Status::FalseConvergence } else { Status::Converged };
        }
        if endless {
            break Status::Infeasible;
        }
        if iterations == stop.max_iterations {
            break Status::IterationLimit;
        }
        if iteration.stalled() {
            let proved = any_proves_infeasible(problem, &[r.clone(), growth(&at_last_look.0, &r)]);
            break if proved { Status::Infeasible } else { Status::Stalled };
        }
        if goes_on.is_break() {
            break Status::Interrupted;
        }
        let clock = Instant::now();
        iteration.advance();
        iterating += clock.elapsed();
        iterations += 1;
        let before = iterations.is_power_of_two().then(|| r.clone());
        iteration.impulses(&mut r);
        measures = meter.measure(&r, iteration.velocity_jump());
        if let Some(before) = before {
            before_last_look = std::mem::replace(&mut at_last_look, (r.clone(), measures.natural_map));
            let (r_then, natural_map_then) = &before_last_look;
            // The impulses, and their growth in one iteration and in half of all: what is constant in them is not in it.
            endless = iterations >= FIRST_LOOK
                && !(measures.natural_map < CONVERGES * natural_map_then)
                && any_proves_infeasible(problem, &[r.clone(), growth(&before, &r), growth(r_then, &r)]);
        }
    };
    Ok(Outcome {
        status,
        iterations,
        measures,
        impulses: r,
        velocity: meter.velocity().to_vec(),
        setup,
        iterating,
        work: iteration.work(),
        derived: iteration.derived(),
        critical_path: iteration.critical_path(),
    })
}

/// No iterate, and no natural map.
fn none() -> (Vec<f64>, f64) {
    (Vec::new(), f64::NAN)
}

fn growth(before: &[f64], r: &[f64]) -> Vec<f64> {
    r.iter().zip(before).map(|(r, before)| law::non_negative(r - before)).collect()
}
