//! The methods for a program that is not the command line, such as the Python package of `harness/python`: a problem is
//! text, an error is what `gravel` would print.

mod simulation;

use crate::cli::bench;
use crate::plan::{Curves, Method, take_external};
use crate::problems::{CaseProblem, Problem};
use crate::root::{Root, is_toml, stem};
use crate::run::{Recorder, asked, in_the_pool, outcome, to_json};
use crate::store::runs_folder;
use crate::terminal::{exit, prepare_new, write_whole};
use anyhow::{Context, Result, anyhow, bail, ensure};
use cases::{AnyFrozen, check_name};
use clap::Parser;
use contact::Measure;
use runner::{Progress, Stop};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

pub use results::columns::Values;
pub use simulation::{Advanced, Bodies, Simulation, Table};

/// Request to solve a problem: method, settings, stop rule.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// Name of the method; `None` for that of the command line.
    method: Option<String>,
    /// Settings of the method; those left out have their defaults.
    settings: Map<String, Value>,
    stop: Stop,
    /// Begin from the impulses of the time step before, if the problem holds them.
    warm_start: bool,
    /// Measure the distance to the reference solution as well.
    truth: bool,
}

/// Result of a solve.
pub struct Solved {
    /// The object that `gravel solve --json` prints, with two more keys: `residuals`, the measures by themselves, and `curve`, the
    /// samples that a study keeps.
    pub told: Value,
    /// Numbers of a grain among velocities.
    pub of_grain: usize,
    /// Numbers of a contact among impulses.
    pub of_contact: usize,
    /// r (N·s), a flat list in the problem's contact order.
    pub impulses: Vec<f64>,
    /// V (m/s, rad/s), a flat list in the problem's order of grains.
    pub velocity: Vec<f64>,
    /// v (m/s), a flat list in the problem's contact order.
    pub relative_velocity: Vec<f64>,
}

/// The text of a problem: of a file, or of a case with values of its scene replaced, at a time step; by name or path, as
/// `gravel solve` takes it. `stops` is asked after every iteration of the time steps before it whether to end.
///
/// # Errors
/// Says what `gravel` would print.
pub fn problem(
    name: &str,
    scene: Vec<(String, String)>,
    time_step: Option<&str>,
    stops: impl Fn() -> bool + Send + Sync,
) -> Result<String, String> {
    let read = || -> Result<String> {
        let path = root()?.problem_or_case(name)?;
        let frozen = if is_toml(&path) {
            marched(&path, scene, time_step, &stops)?
        } else if scene.is_empty() && time_step.is_none() {
            AnyFrozen::read(&path)?
        } else {
            bail!("{} is a frozen problem: it has no scene and no other time step", path.display())
        };
        Ok(frozen.to_json()?)
    };
    read().map_err(|error| crate::in_one_paragraph(&error))
}

/// Returns the problem of a case at a time step.
fn marched(
    path: &Path,
    scene: Vec<(String, String)>,
    time_step: Option<&str>,
    stops: &(dyn Fn() -> bool + Sync),
) -> Result<AnyFrozen> {
    let case = CaseProblem::read(path, scene, "time_step", time_step)?;
    let (method, stop) = case.before()?;
    in_the_pool(|| case.marched(&method, &stop, &CaseProblem::solved_by(&method, &stop), &|| stops()))
}

/// Writes the problem of a case with values of its scene replaced, at a time step, as a file that is not there, named after it.
///
/// # Errors
/// Says what `gravel` would print.
pub fn freeze(
    name: &str,
    scene: Vec<(String, String)>,
    time_step: Option<&str>,
    output: &Path,
    stops: impl Fn() -> bool + Send + Sync,
) -> Result<(), String> {
    let write = || -> Result<()> {
        prepare_new(output)?;
        let problem = stem(output);
        check_name(&problem).map_err(|why| anyhow!("{}: the problem's {why}", output.display()))?;
        let mut frozen = marched(&root()?.case(name)?, scene, time_step, &stops)?;
        frozen.rename(&problem);
        write_whole(output, frozen.to_json()?)
    };
    write().map_err(|error| crate::in_one_paragraph(&error))
}

/// Arguments of `gravel bench`.
#[derive(Parser)]
#[command(name = "bench", no_binary_name = true)]
struct Bench {
    #[command(flatten)]
    args: bench::Args,
}

/// Interval between two questions whether to end a study.
const LOOK: Duration = Duration::from_millis(50);

/// The study that runs: one at a time.
static STUDY: Mutex<()> = Mutex::new(());

/// A call at the end of a scope, also where it panics.
struct OnDrop<F: Fn()>(F);

impl<F: Fn()> Drop for OnDrop<F> {
    fn drop(&mut self) {
        self.0();
    }
}

/// Runs a plan, as `gravel bench` does with these arguments, and returns the folder of its tables; `stops` is asked whether to end after
/// the current iteration of each run.
///
/// # Errors
/// Says what `gravel` would print.
pub fn bench(arguments: Vec<String>, stops: impl Fn() -> bool + Send + Sync) -> Result<PathBuf, String> {
    let run = || -> Result<PathBuf> {
        let Bench { args } = Bench::try_parse_from(arguments)?;
        let root = root()?;
        let checkout = root.needed()?;
        let folder = runs_folder(checkout).join(args.study.selection(checkout)?.plan.name);
        let has_ended = AtomicBool::new(false);
        // The request to end is one of the whole program.
        let _alone = STUDY.lock().unwrap_or_else(PoisonError::into_inner);
        exit::request(false);
        thread::scope(|scope| {
            let _end = OnDrop(|| has_ended.store(true, Ordering::Relaxed));
            scope.spawn(|| {
                while !has_ended.load(Ordering::Relaxed) {
                    exit::request(stops());
                    thread::sleep(LOOK);
                }
            });
            bench::run(checkout, &args)
        })?;
        ensure!(!exit::requested(), "stopped before its end; the runs that had ended are kept");
        Ok(folder)
    };
    run().map_err(|error| crate::in_one_paragraph(&error))
}

/// Solves the problem with this text; `stops` is asked after every iteration whether to end.
///
/// # Errors
/// Says what `gravel` would print.
pub fn solve(text: &str, request: &str, stops: impl Fn() -> bool + Send + Sync) -> Result<Solved, String> {
    let run = || -> Result<Solved> {
        let root = root()?;
        let request: Value = serde_json::from_str(request)?;
        let request: Request =
            serde_path_to_error::deserialize(request).map_err(|error| wrong_key(&error))?;
        let frozen = AnyFrozen::of_text(Path::new("the problem"), text)?;
        in_the_pool(|| solved(&root, request, frozen, &stops))
    };
    run().map_err(|error| crate::in_one_paragraph(&error))
}

/// Returns the checkout of the variable `GRAVEL_ROOT`, or else that around the current folder, if there is one; other codes are those of
/// the first.
fn root() -> Result<Root> {
    let root = Root::find(None)?;
    take_external(&root)?;
    Ok(root)
}

/// Returns the error of a request by the key that its caller gave.
fn wrong_key(error: &serde_path_to_error::Error<serde_json::Error>) -> anyhow::Error {
    let path = error.path().to_string();
    anyhow!("`{}`: {}", path.strip_prefix("stop.").unwrap_or(&path), error.inner())
}

fn solved(
    root: &Root,
    Request { method, settings, stop, warm_start, truth }: Request,
    frozen: AnyFrozen,
    stops: &dyn Fn() -> bool,
) -> Result<Solved> {
    stop.check()?;
    let problem = Problem::alone(frozen, truth || stop.on == Measure::VelocityError);
    let method = &Method::unless_named()?.or_named(method.as_deref(), settings)?;
    let known = problem.known(root)?;
    let mut recorder = Recorder::new(Curves::Whole);
    let mut observe = |progress: &Progress| {
        recorder.observe(progress);
        if stops() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = outcome(&problem, known, (method, &stop), &problem.start(warm_start), &mut observe)
        .with_context(|| format!("method `{}` on {}", method.name, problem.name))?;
    let mut told = to_json(asked(&problem, method, &stop, warm_start), &outcome)?;
    told["residuals"] = serde_json::to_value(outcome.measures)?;
    told["curve"] = serde_json::to_value(recorder.finish())?;
    let (facts, of_grains) = (problem.posed.facts(), problem.posed.grains()?);
    Ok(Solved {
        told,
        of_grain: facts.of_grain,
        of_contact: facts.of_contact,
        relative_velocity: of_grains.relative_velocity(&outcome.impulses),
        velocity: of_grains.velocity(&outcome.impulses),
        impulses: outcome.impulses,
    })
}
