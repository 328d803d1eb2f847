//! `gravel solve`: one contact problem, one method.

use crate::cli::args::SolverArgs;
use crate::cli::posed::{ProblemArgs, Start};
use crate::collection::Collection;
use crate::plan::Method;
use crate::root::Root;
use crate::run::{asked, homogenised, outcome, to_json};
use crate::terminal::{Line, check_apart, exit, prepare_place, say, write_instead};
use anyhow::{Context, Result, bail};
use contact::{Measure, Measures};
use lineup::Posed;
use runner::{Outcome, Progress, Status, Stop};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    posed: ProblemArgs,
    #[command(flatten)]
    solver: SolverArgs,
    /// Measure the distance to the nearest known solution as well: those of the collection, or else the reference, which is kept in
    /// results/references; so does `--on velocity_error`
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

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let (method, stop) = args.solver.read()?;
    for file in args.impulses.iter().chain(&args.homogenised) {
        prepare_place(file)?;
    }
    let path = args.posed.path(root)?;
    let outputs = [("--impulses", &args.impulses), ("--homogenised", &args.homogenised)];
    let outputs = outputs.iter().filter_map(|(name, file)| Some((*name, file.as_deref()?)));
    check_apart(&[("the problem", &*path)].into_iter().chain(outputs).collect::<Vec<_>>())?;
    let truth = args.truth || stop.on == Measure::VelocityError;
    let problem = args.posed.read(&path, truth)?;
    if args.homogenised.is_some() && matches!(problem.posed, Posed::W(_)) {
        bail!("--homogenised: {} has W alone, no grains and no contacts in space", path.display());
    }
    let (posed, facts) = (&problem.posed, problem.posed.facts());
    let r0 = args.posed.impulses(&path, &problem)?;
    if truth
        && let Ok(collection) = Collection::of(root, None, false)
        && let Some(known) = collection.known(&problem)?
    {
        problem.take(known);
    }
    let known = problem.known(root)?;
    let mut line = Line::alone(method.name.to_owned());
    // The least natural map of the iterates that were measured, and its iteration.
    let mut least = (f64::INFINITY, 0);
    let mut observe = |progress: &Progress| {
        if let Some(natural_map) =
            progress.measures.map(|measures| measures.natural_map).filter(|map| *map < least.0)
        {
            least = (natural_map, progress.iteration);
        }
        line.show(progress, stop.on);
        if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = outcome(&problem, known, (&method, &stop), &r0, &mut observe)
        .with_context(|| format!("method `{}` on {}", method.name, path.display()))?;
    let _whole = exit::whole();
    drop(line);
    if let Some(file) = &args.homogenised {
        write_instead(file, homogenised(posed.grains()?, method.partition(), &outcome.impulses)?)?;
    }
    if let Some(file) = &args.impulses {
        write_instead(file, json!({ "impulse": outcome.impulses }).to_string())?;
    }
    if let Some(why) = at_rest(&outcome, &stop) {
        eprintln!("warning: {why}");
    }
    if args.json {
        let asked = asked(&problem, &method, &stop, args.posed.start != Start::Cold);
        say(format_args!("{}", to_json(asked, &outcome)?))?;
    } else {
        say(format_args!("{}: {}", problem.name, facts.size()))?;
        print(&method, &stop, &outcome, least)?;
    }
    Ok(exit::code(outcome.status.name()))
}

/// Returns what to check where no impulse at all ended a run at once.
fn at_rest(outcome: &Outcome, stop: &Stop) -> Option<String> {
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

/// Prints how a run ended, and its seconds.
pub(crate) fn say_ending(
    method: &Method,
    stop: &Stop,
    (status, iterations): (Status, u64),
    [setup_s, iterating_s]: [f64; 2],
) -> Result<()> {
    let (on, tolerance, plural) = (stop.on, stop.tolerance, if iterations == 1 { "" } else { "s" });
    say(format_args!("{} {}", method.name, Value::Object(method.settings.clone())))?;
    // Another code is asked for one of its own tolerances after the other.
    let asked = match status {
        Status::Converged if method.ours().is_err() => "its first tolerance with",
        Status::Converged => "the first iterate with",
        _ => "asked:",
    };
    let status = status.name();
    say(format_args!("{status} after {iterations} iteration{plural} ({asked} {on} ≤ {tolerance:e})"))?;
    say(format_args!("  set-up {setup_s:.3e} s, iterating {iterating_s:.3e} s"))
}

/// Prints measures, a line each.
pub(crate) fn say_measures(measures: &Measures) -> Result<()> {
    for measure in Measure::ALL {
        let (name, value) = (measure.name(), measures.get(measure));
        let unit = if measure == Measure::PenetrationRate { " m/s" } else { "" };
        // Without the solution there is no error, without grains no norm of LMGC90's, from r = 0 or of another code no ζ.
        if !value.is_nan() {
            say(format_args!("  {name:<17}{value:.3e}{unit}"))?;
        }
    }
    Ok(())
}

fn print(method: &Method, stop: &Stop, outcome: &Outcome, (least, at): (f64, u64)) -> Result<()> {
    let Outcome { status, iterations, measures, setup, iterating, .. } = outcome;
    say_ending(method, stop, (*status, *iterations), [*setup, *iterating].map(|time| time.as_secs_f64()))?;
    say_measures(measures)?;
    if let Some(contact) = measures.worst_contact {
        say(format_args!("  {:<17}{contact}", "worst_contact"))?;
    }
    if least < measures.natural_map {
        say(format_args!("  the least natural_map was {least:.3e}, at iteration {at}"))?;
    }
    Ok(())
}
