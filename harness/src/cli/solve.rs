//! `gravel solve`: one contact problem, one method.

use crate::cli::args::{MethodArgs, SceneArgs, StopArgs};
use crate::identity::content_hash;
use crate::plan::methods::Method;
use crate::problems::files::Root;
use crate::problems::reference::{Known, known};
use crate::terminal::exit;
use crate::terminal::interrupt;
use crate::terminal::output::{check_place, replaces, say, write_whole};
use crate::terminal::progress::Line;
use anyhow::{Context, Result};
use cases::Frozen;
use clap::ValueEnum;
use contact::{Measure, Outcome, Progress, Stop, solve_against};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem or a case: its name, or the path of its file
    #[arg(value_name = "PROBLEM-OR-CASE")]
    problem: String,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    stop: StopArgs,
    /// Begin from r = 0, or from the impulses of the time step before
    #[arg(long, value_enum, default_value = "cold")]
    start: Start,
    /// Measure the distance to the reference solution as well, which is kept in results/references; so does
    /// `--on velocity_error`
    #[arg(long)]
    truth: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the impulses to FILE, as {"impulse": [N·s, in the problem's contact order]}
    #[arg(long, value_name = "FILE")]
    impulses: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Start {
    Cold,
    Warm,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let method = args.method.method()?;
    let stop = args.stop.of(Stop::default())?;
    if let Some(file) = &args.impulses {
        check_place(file)?;
    }
    let path = root.problem_or_case(&args.problem)?;
    let frozen = args.scene.problem(&path)?;
    let r0 = frozen.start(args.start == Start::Warm);

    let truth = args.truth || stop.on == Measure::VelocityError;
    let known = if truth { known(root, &frozen)? } else { Known::default() };
    interrupt::listen()?;
    let mut line = Line::alone(method.name.to_owned());
    let mut observe = |progress: &Progress| {
        line.show(progress, stop.on);
        if interrupt::asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = solve_against(known.truth(), &*method.solver, &frozen.problem, &r0, &stop, &mut observe)
        .with_context(|| format!("method `{}` on {}", method.name, path.display()))?;
    let outcome = Outcome { status: known.ending(outcome.status), ..outcome };
    drop(line);

    if let Some(file) = &args.impulses {
        if replaces(file) {
            eprintln!("replacing {}", file.display());
        }
        write_whole(file, &json!({ "impulse": outcome.impulses }).to_string())?;
    }
    if args.json {
        say(format_args!("{}", to_json(&frozen, &method, &stop, args.start, &outcome)?))?;
    } else {
        print(&frozen, &method, &stop, &outcome)?;
    }
    Ok(exit::code(outcome.status.name()))
}

fn to_json(frozen: &Frozen, method: &Method, stop: &Stop, start: Start, outcome: &Outcome) -> Result<Value> {
    let mut object = json!({
        "problem": frozen.name,
        "problem_hash": content_hash(frozen),
        "grains": frozen.problem.grain_count(),
        "contacts": frozen.problem.contact_count(),
        "method": method.name,
        "settings": method.settings,
        "derived": outcome.derived.iter().copied().collect::<BTreeMap<_, _>>(),
        "start": if start == Start::Warm { "warm" } else { "cold" },
        "stop": stop,
        "status": outcome.status,
        "iterations": outcome.iterations,
    });
    let measures = serde_json::to_value(outcome.measures)?;
    if let (Value::Object(object), Value::Object(measures)) = (&mut object, measures) {
        object.extend(measures);
        object.insert("setup_s".to_owned(), outcome.setup.as_secs_f64().into());
        object.insert("iterating_s".to_owned(), outcome.iterating.as_secs_f64().into());
        object.insert("work".to_owned(), serde_json::to_value(outcome.work)?);
    }
    Ok(object)
}

fn print(frozen: &Frozen, method: &Method, stop: &Stop, outcome: &Outcome) -> Result<()> {
    let problem = &frozen.problem;
    say(format_args!(
        "{}: {} grains, {} contacts",
        frozen.name,
        problem.grain_count(),
        problem.contact_count()
    ))?;
    say(format_args!("{} {}", method.name, Value::Object(method.settings.clone())))?;
    let limit = format!("{} ≤ {:e}", stop.on, stop.tolerance);
    let iterations = match outcome.iterations {
        1 => "1 iteration".to_owned(),
        n => format!("{n} iterations"),
    };
    say(format_args!("{} after {iterations} ({limit} asked)", outcome.status.name()))?;
    say(format_args!(
        "  set-up {:.3e} s, iterating {:.3e} s",
        outcome.setup.as_secs_f64(),
        outcome.iterating.as_secs_f64()
    ))?;
    let unknown =
        |measure: &Measure| *measure == Measure::VelocityError && outcome.measures.velocity_error.is_nan();
    for measure in Measure::ALL.into_iter().filter(|measure| !unknown(measure)) {
        let unit = if measure == Measure::PenetrationRate { " m/s" } else { "" };
        say(format_args!("  {:<17}{:.3e}{unit}", measure.name(), outcome.measures.get(measure)))?;
    }
    if let Some(contact) = outcome.measures.worst_contact {
        say(format_args!("  {:<17}{contact}", "worst_contact"))?;
    }
    Ok(())
}
