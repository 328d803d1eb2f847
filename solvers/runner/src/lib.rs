//! The loop that runs every method: it advances, reads the impulses, measures, and decides when to stop. An iterate that is
//! proved not to end the run need not be measured wholly. (The reference, as the
//! judge of solutions, drives its own steps in `reference::solve`; as a method it is run by this loop like the others.)

mod convergence;
mod cycle;
mod judge;
mod local;
mod looks;
mod ranks;

use analysis::Meter;
use contact::{Iteration, Measure, Measures, Mechanics, Packing, SetupError, Solver, Truth, Vector, Work};
use convergence::is_false;
use cycle::cycle;
use judge::Judge;
use looks::{Grid, Looks};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

pub use local::{LocalTruth, solve_local};
pub use looks::Measured;
pub use ranks::{Beside, OnRanks, solve_on_ranks};

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

/// Status at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
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

/// State that an observer sees after every iteration, and once before the first.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Iterations so far.
    pub iteration: u64,
    /// Time spent in `advance` so far.
    pub iterating: Duration,
    /// Measures of the iterate; `None` if it was not measured wholly.
    pub measures: Option<&'a Measures>,
    /// Counted work so far.
    pub work: Work,
    /// r (N·s).
    pub impulses: &'a [f64],
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Status at the end.
    pub status: Status,
    /// Number of iterations.
    pub iterations: u64,
    /// Measures of the last iterate.
    pub measures: Measures,
    /// r of the last iterate (N·s).
    pub impulses: Vec<f64>,
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
    /// √(dᵗ W d / dᵗ `W_D` d) of the last iteration's change d of r, with the diagonal `W_D` of W (–): how much of it moves grains. Next to
    /// nothing where impulses drift along the kernel of W; NaN where they do not change.
    pub last_change_moves: f64,
    /// Iterations after which the impulses of a run that came to its limit are those of its last iterate again, if they are.
    pub cycle: Option<u64>,
}

/// q(r) above this many times the problem's own scale of energy is a divergence. It is far, since a method may converge
/// from far: the first iterate of LATIN has q of the order of κ² times the scale. What grows geometrically passes it
/// all the same.
const ENERGY_BOUND: f64 = 1e20;

/// Runs `solver` on `problem` from the impulses `r0` (N·s) until `stop`; `observe` sees the measures of every iterate.
///
/// The clock runs in `start` and `advance` only. Where no contact pushes (b ≥ 0), r = 0 solves the problem and
/// the run has converged before its first iteration, whatever `r0`.
///
/// # Errors
/// Names the setting, the stop rule or the start impulse that has no meaning; stopping on the velocity error is the
/// business of [`solve_against`].
pub fn solve<M: Mechanics>(
    solver: &dyn Solver<M>,
    problem: &Packing<M>,
    r0: &[f64],
    stop: &Stop,
    observe: &mut dyn FnMut(&Progress),
) -> Result<Outcome, SetupError> {
    solve_against(None, solver, problem, r0, stop, Measured::Every, &mut |progress| {
        observe(progress);
        ControlFlow::Continue(())
    })
}

/// [`solve`] beside the solutions that are `known`: the measures then hold the distance to the nearest. Whichever iterates are `measured`
/// wholly, the run is the same and ends at the same iterate. The observer sees the others too, and may end the run after any; it is then
/// [`Status::Interrupted`], unless that iterate was the last one anyway.
///
/// # Errors
/// Those of [`solve`]; names the stop rule if it is on the error of a solution that is not known.
pub fn solve_against<'t, M: Mechanics>(
    known: impl IntoIterator<Item = &'t Truth<M>>,
    solver: &dyn Solver<M>,
    problem: &Packing<M>,
    r0: &[f64],
    stop: &Stop,
    measured: Measured,
    observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Outcome, SetupError> {
    problem.unless_admissible(r0)?;
    stop.check()?;
    let mut known = known.into_iter().peekable();
    let is_known = known.peek().is_some() || stop.on != Measure::VelocityError;
    let expected = "another measure: the true velocity of this problem is not known";
    SetupError::unless(is_known, "on", stop.on, expected)?;
    let mut meter = known.fold(Meter::new(problem), Meter::against);
    let clock = Instant::now();
    let mut iteration = solver.start(problem, r0)?;
    let setup = clock.elapsed();
    let (end, before) = run(&mut meter, &mut *iteration, r0.to_vec(), stop, measured, observe);
    let last_change_moves = moving_share(&before, &end.impulses, &problem.delassus_diagonal(), |change| {
        let (mut moved, mut velocity) =
            (vec![0.0; change.len()], vec![M::Velocity::ZERO; problem.grain_count()]);
        problem.delassus_product(change, &mut moved, &mut velocity);
        moved
    });
    let cycle = (end.status == Status::IterationLimit)
        .then(|| cycle(&mut *iteration, end.iterations, &before, &end.impulses))
        .flatten();
    Ok(Outcome { setup, last_change_moves, cycle, ..end })
}

/// The loop, from the impulses r (N·s) that the method has begun with. Returns its outcome, of which the set-up is not known yet nor what
/// the last change moves, and the iterate before the last, empty if there is none.
fn run(
    judge: &mut impl Judge,
    iteration: &mut dyn Iteration,
    mut r: Vec<f64>,
    stop: &Stop,
    measured: Measured,
    observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> (Outcome, Vec<f64>) {
    let scale = judge.scale();
    if scale == 0.0 {
        r.fill(0.0);
    }
    // The last iterate that was measured; the one before r, none at first.
    let (mut measures, mut before) = (judge.measure_after(&[], &r, 0.0), Vec::new());
    let energy_bound = ENERGY_BOUND * f64::max(scale, measures.energy.abs());
    let (mut iterations, mut iterating, mut is_measured) = (0, Duration::ZERO, true);
    let (mut looks, mut grid) = (Looks::default(), Grid::new(measured));
    let status = loop {
        let goes_on = observe(&Progress {
            iteration: iterations,
            iterating,
            measures: is_measured.then_some(&measures),
            work: iteration.work(),
            impulses: &r,
        });
        if is_measured {
            // Before convergence, which a measure can feign where others overflow; and so that a NaN counts as diverged.
            if !(measures.energy <= energy_bound && measures.natural_map.is_finite()) {
                let is_finite = !judge.any(!r.iter().all(|r| r.is_finite()));
                let proved = is_finite && judge.any_proves_infeasible(std::slice::from_ref(&r));
                break if proved { Status::Infeasible } else { Status::Diverged };
            }
            if scale == 0.0 {
                break Status::Converged;
            }
            if measures.get(stop.on) <= stop.tolerance {
                let (stays, rays) = (looks.stays(&measures), || looks.rays(&r));
                let is_false = is_false(stop, judge, &measures, stays, &rays);
                break if is_false { Status::FalseConvergence } else { Status::Converged };
            }
            if looks.endless {
                break Status::Infeasible;
            }
            if iterations == stop.max_iterations {
                break Status::IterationLimit;
            }
            if iteration.stalled() {
                let proved = judge.any_proves_infeasible(&looks.rays_of_half(&r));
                break if proved { Status::Infeasible } else { Status::Stalled };
            }
        }
        if judge.any(goes_on.is_break()) {
            break Status::Interrupted;
        }
        let clock = Instant::now();
        iteration.advance();
        iterating += clock.elapsed();
        iterations += 1;
        // The first time there is none before, and r stays for the next.
        before.resize(r.len(), 0.0);
        std::mem::swap(&mut before, &mut r);
        iteration.impulses(&mut r);
        is_measured = grid.has(iterations)
            || iterations == stop.max_iterations
            || iteration.stalled()
            || !(grid.skips() || judge.goes_on(stop.on, stop.tolerance, energy_bound, (&before, &r)));
        if is_measured {
            measures = judge.measure_after(&before, &r, iteration.velocity_jump());
        }
        looks.look(iterations, judge, &measures, (&before, &r));
    };
    if !is_measured {
        measures = judge.measure_after(&before, &r, iteration.velocity_jump());
    }
    let outcome = Outcome {
        status,
        iterations,
        measures,
        impulses: r,
        setup: Duration::ZERO,
        iterating,
        work: iteration.work(),
        derived: iteration.derived(),
        critical_path: iteration.critical_path(),
        last_change_moves: f64::NAN,
        cycle: None,
    };
    (outcome, before)
}

/// √(dᵗ W d / dᵗ `W_D` d) of the change d from impulses `before`, if there are some, to `r` (–), with the `diagonal` of W and its
/// `product`.
fn moving_share(
    before: &[f64],
    r: &[f64],
    diagonal: &[f64],
    product: impl FnOnce(&[f64]) -> Vec<f64>,
) -> f64 {
    if before.len() != r.len() {
        return f64::NAN;
    }
    let change: Vec<f64> = r.iter().zip(before).map(|(r, before)| r - before).collect();
    let moved = product(&change);
    let of_change: f64 = change.iter().zip(diagonal).map(|(d, w)| w * d * d).sum();
    let of_motion: f64 = change.iter().zip(&moved).map(|(d, moved)| d * moved).sum();
    // Round-off may leave less than nothing.
    (of_motion.max(0.0) / of_change).sqrt()
}
