//! `gravel solve`: one contact problem, one method.

mod local;

use crate::cli::args::{SceneArgs, SolverArgs};
use crate::exchange::{self, Held, is_foreign};
use crate::identity::content_hash;
use crate::plan::Method;
use crate::problems::{Given, Known, Root, Studied, Visit, size, visit};
use crate::run::{Ended, Observe, derived, ended, homogenised};
use crate::terminal::{Line, check_apart, check_place, exit, merged, say, write_instead};
use anyhow::{Context, Result, bail};
use cases::{AnyFrozen, Frozen};
use contact::{Measure, Mechanics};
use runner::{Measured, Outcome, Progress, Status, Stop};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem or a case: its name, or the path of its file; or a file of another code, FCLIB (.hdf5) or Siconos (.dat)
    #[arg(value_name = "PROBLEM-OR-CASE")]
    problem: String,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    solver: SolverArgs,
    /// Start from r = 0 (cold), from the impulses of the time step before, if there are any (warm), or from those in a FILE as
    /// `--impulses` writes it
    #[arg(long, value_name = "START", default_value = "cold", value_parser = Start::read)]
    start: Start,
    /// Measure the distance to the reference solution as well, which is kept in results/references; so does
    /// `--on velocity_error`
    #[arg(long)]
    truth: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the impulses to FILE, as {"impulse": [N·s, in the problem's contact order; with
    /// friction the normal and the tangential one of each]}
    #[arg(long, value_name = "FILE")]
    impulses: Option<PathBuf>,
    /// Write the homogenised stress, fabric and coordination of each subdomain to FILE, as CSV; of the whole sample, if the
    /// method has no subdomains
    #[arg(long, value_name = "FILE")]
    homogenised: Option<PathBuf>,
}

/// The impulses to begin from.
#[derive(Clone, PartialEq, Eq)]
pub(crate) enum Start {
    Cold,
    Warm,
    From(PathBuf),
}

impl Start {
    /// Any word but the two is a place.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        Ok(match text {
            "" => return Err("cold, warm, or where impulses are".to_owned()),
            "cold" => Self::Cold,
            "warm" => Self::Warm,
            place => Self::From(place.into()),
        })
    }
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let (method, stop) = args.solver.read()?;
    for file in args.impulses.iter().chain(&args.homogenised) {
        check_place(file)?;
    }
    let path = root.any_problem_or_case(&args.problem)?;
    let outputs = [("--impulses", &args.impulses), ("--homogenised", &args.homogenised)];
    let outputs = outputs.iter().filter_map(|(name, file)| Some((*name, file.as_deref()?)));
    check_apart(&[("the problem", &*path)].into_iter().chain(outputs).collect::<Vec<_>>())?;
    let problem = if is_foreign(&path) {
        match exchange::read(&path)? {
            Held::Local(problem) => return local::solve(problem, args, (&method, &stop), &path),
            Held::Ours(text) => {
                args.scene.refused(&format!("{} is a frozen problem", path.display()))?;
                AnyFrozen::of_text(&path, &text)?
            }
        }
    } else {
        args.scene.problem(&path)?
    };
    visit(problem, Solve { root, args, method: &method, stop: &stop, path: &path })
}

/// A problem is to be solved.
struct Solve<'a> {
    root: &'a Root,
    args: &'a Args,
    method: &'a Method,
    stop: &'a Stop,
    path: &'a Path,
}

impl Visit for Solve<'_> {
    type Output = Result<ExitCode>;

    fn visit<M: Studied>(self, frozen: Frozen<M>) -> Result<ExitCode> {
        solve(self.root, self.args, (self.method, self.stop), self.path, &frozen)
    }
}

fn solve<M: Studied>(
    root: &Root,
    args: &Args,
    (method, stop): (&Method, &Stop),
    path: &Path,
    frozen: &Frozen<M>,
) -> Result<ExitCode> {
    let r0 = match &args.start {
        Start::From(file) => Given::read(file, &frozen.problem)?.impulse,
        start => frozen.start(*start == Start::Warm),
    };

    let truth = args.truth || stop.on == Measure::VelocityError;
    let known = if truth { M::known(root, frozen)? } else { Known::default() };
    exit::listen_for_interrupts("nothing of it is kept")?;
    let mut line = Line::alone(method.name.to_owned());
    let mut observe = |progress: &Progress| {
        line.show(progress, stop.on);
        if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = outcome(&known, frozen, (method, stop), &r0, &mut observe)
        .with_context(|| format!("method `{}` on {}", method.name, path.display()))?;
    let _whole = exit::whole();
    drop(line);
    if let Some(file) = &args.homogenised {
        write_instead(file, homogenised(frozen, method.partition(), &outcome.impulses)?)?;
    }

    let asked = || asked(frozen, method, stop, args.start != Start::Cold);
    tell(args, (asked, &format!("{}: {}", frozen.name, size(&frozen.problem))), (method, stop), &outcome)
}

/// Writes and prints what came out, and makes an exit code of it: `asked` is the request in JSON, `title` the problem in words.
fn tell<M: Mechanics>(
    args: &Args,
    (asked, title): (impl FnOnce() -> Value, &str),
    (method, stop): (&Method, &Stop),
    outcome: &Outcome<M>,
) -> Result<ExitCode> {
    if let Some(file) = &args.impulses {
        write_instead(file, json!({ "impulse": outcome.impulses }).to_string())?;
    }
    if let Some(why) = at_rest(outcome, stop) {
        eprintln!("warning: {why}");
    }
    if args.json {
        say(format_args!("{}", to_json(asked(), outcome)?))?;
    } else {
        print(title, (method, stop), outcome)?;
    }
    Ok(exit::code(outcome.status.name()))
}

/// Returns what to check where no impulse at all ended a run at once.
fn at_rest<M: Mechanics>(outcome: &Outcome<M>, stop: &Stop) -> Option<String> {
    let Outcome { status, iterations, impulses, measures, .. } = outcome;
    if *status != Status::Converged || *iterations > 0 || impulses.iter().any(|r| *r != 0.0) {
        return None;
    }
    if impulses.is_empty() {
        return Some("there is no contact".to_owned());
    }
    let (on, tolerance, left) = (stop.on, stop.tolerance, measures.get(stop.on));
    Some(if left > 0.0 {
        format!(
            "no contact pushes: {on} is {left:.3e} without any impulse, which `--tolerance {tolerance}` allows; ask for less"
        )
    } else {
        "no contact pushes, since none closes. If some should: `contacts.normal` points from the antagonist (or the wall) to the \
         candidate, `grains.free_velocity` is that at the end of the time step, gravity in it, and `contacts.offset` is negative \
         where a wall comes closer"
            .to_owned()
    })
}

/// Runs a method from the impulses `r0` (N·s) and returns its outcome.
pub(crate) fn outcome<M: Studied>(
    known: &Known<M>,
    frozen: &Frozen<M>,
    (method, stop): (&Method, &Stop),
    r0: &[f64],
    observe: &mut Observe,
) -> Result<Outcome<M>> {
    let Ended { outcome, failed, .. } =
        ended(method, known.truths(), frozen, r0, stop, Measured::Needed, observe)?;
    if let Some(why) = failed {
        bail!("{why}");
    }
    Ok(Outcome { status: known.ending(outcome.status), ..outcome })
}

/// The request, under the names that the columns of tables have.
pub(crate) fn asked<M: Studied>(frozen: &Frozen<M>, method: &Method, stop: &Stop, warm_start: bool) -> Value {
    json!({
        "problem": frozen.name,
        "mechanics": M::NAME,
        "problem_hash": content_hash(frozen),
        "grains": frozen.problem.grain_count(),
        "contacts": frozen.problem.contact_count(),
        "method": method.name,
        "settings": method.settings,
        "warm_start": warm_start,
        "stop_on": stop.on,
        "tolerance": stop.tolerance,
        "max_iterations": stop.max_iterations,
    })
}

/// The request `asked` and the answer, under the names that the columns of tables have.
pub(crate) fn to_json<M: Mechanics>(asked: Value, outcome: &Outcome<M>) -> Result<Value> {
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

/// Prints one line on how a run ended.
fn say_ending(status: &str, iterations: u64, stop: &Stop) -> Result<()> {
    let (on, tolerance, plural) = (stop.on, stop.tolerance, if iterations == 1 { "" } else { "s" });
    say(format_args!("{status} after {iterations} iteration{plural} ({on} ≤ {tolerance:e} asked)"))
}

fn print<M: Mechanics>(title: &str, (method, stop): (&Method, &Stop), outcome: &Outcome<M>) -> Result<()> {
    let Outcome { status, iterations, measures, .. } = outcome;
    say(format_args!("{title}"))?;
    say(format_args!("{} {}", method.name, Value::Object(method.settings.clone())))?;
    say_ending(status.name(), *iterations, stop)?;
    let (setup, iterating) = (outcome.setup.as_secs_f64(), outcome.iterating.as_secs_f64());
    say(format_args!("  set-up {setup:.3e} s, iterating {iterating:.3e} s"))?;
    for measure in Measure::ALL {
        let (name, value) = (measure.name(), measures.get(measure));
        let unit = if measure == Measure::PenetrationRate { " m/s" } else { "" };
        // Without the solution there is no error, and without grains no norm of LMGC90's; ζ has none from r = 0.
        if measure == Measure::Zeta || !value.is_nan() {
            say(format_args!("  {name:<17}{value:.3e}{unit}"))?;
        }
    }
    if let Some(contact) = measures.worst_contact {
        say(format_args!("  {:<17}{contact}", "worst_contact"))?;
    }
    Ok(())
}
