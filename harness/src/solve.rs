//! `gravel solve`: one contact problem, one method.

use crate::exit;
use crate::inputs::{Root, content_hash, is_toml, time_step};
use crate::interrupt;
use crate::memory::read_case;
use crate::methods::{Method, key_value};
use crate::output::{check_place, replaces, say, write_whole};
use crate::problems::marched;
use crate::progress::Line;
use crate::rows::derived;
use crate::truth::{Known, known};
use anyhow::{Context, Result, bail};
use cases::Frozen;
use clap::ValueEnum;
use contact::Measure;
use runner::{Outcome, Progress, Stop, solve_against};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    problem: ProblemArgs,
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

/// A contact problem on the command line.
#[derive(clap::Args)]
pub(crate) struct ProblemArgs {
    /// A frozen problem or a case: its name, or the path of its file
    #[arg(value_name = "PROBLEM-OR-CASE")]
    problem: String,
    #[command(flatten)]
    scene: SceneArgs,
}

/// What a case on the command line changes.
#[derive(clap::Args)]
pub(crate) struct SceneArgs {
    #[command(flatten)]
    case: CaseArgs,
    /// The time step of a case, counted from 1, or one of its moments [default: the case's `solve_at`]; those before
    /// it are solved by preconditioned cg, whatever the method
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    time_step: Option<String>,
}

/// A method on the command line.
#[derive(clap::Args)]
pub(crate) struct MethodArgs {
    /// A method; `gravel list methods` shows them with their settings
    #[arg(long, default_value = "cg", value_name = "M")]
    method: String,
    /// A setting of the method, such as relaxation=0.8 or subdomains=4x2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    settings: Vec<(String, String)>,
}

/// A stop rule on the command line.
#[derive(clap::Args)]
pub(crate) struct StopArgs {
    /// The run has converged when the measure is at most this
    #[arg(long, value_name = "T", default_value_t = Stop::default().tolerance, allow_negative_numbers = true)]
    tolerance: f64,
    /// The measure that decides: zeta, natural_map, penetration_rate, quad_dv, max_dv or
    /// velocity_error
    #[arg(long, value_name = "MEASURE", default_value_t = Stop::default().on, value_parser = measure)]
    on: Measure,
    /// The run ends after this many iterations at the latest
    #[arg(long, value_name = "N", default_value_t = Stop::default().max_iterations, allow_negative_numbers = true)]
    max_iterations: u64,
}

/// Changes to a stop rule on the command line.
#[derive(Default, clap::Args)]
pub(crate) struct StopChanges {
    /// A run has converged when the measure is at most this [default: the plan's or the stored run's, else as
    /// `gravel solve`]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// The measure that decides: zeta, natural_map, penetration_rate, quad_dv, max_dv or velocity_error [default: as
    /// above]
    #[arg(long, value_name = "MEASURE", value_parser = measure)]
    on: Option<Measure>,
    /// A run ends after this many iterations at the latest [default: as above]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_iterations: Option<u64>,
}

/// Changes to a case on the command line.
#[derive(clap::Args)]
pub(crate) struct CaseArgs {
    /// A value of the case file to replace, such as sample.grains=250 or scene.law=iqs; may be repeated
    #[arg(long = "scene", value_name = "KEY=VALUE", value_parser = key_value)]
    pub(crate) overrides: Vec<(String, String)>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Start {
    Cold,
    Warm,
}

impl SceneArgs {
    /// Refuses them where `what`, such as "x.json is a frozen problem", leaves nothing to change.
    pub(crate) fn refused(&self, what: &str) -> Result<()> {
        if let Some((key, _)) = self.case.overrides.first() {
            bail!("--scene {key}: {what}, it has no scene");
        }
        if self.time_step.is_some() {
            bail!("--time-step: {what}, it has no other time step");
        }
        Ok(())
    }

    /// The arguments that ask for the same.
    pub(crate) fn again(&self) -> Vec<String> {
        let scene = self.case.overrides.iter().map(|(key, value)| format!("--scene '{key}={value}'"));
        scene.chain(self.time_step.iter().map(|moment| format!("--time-step {moment}"))).collect()
    }

    /// The problem of the file that the user named.
    pub(crate) fn problem(&self, path: &Path) -> Result<Frozen> {
        if !is_toml(path) {
            self.refused(&format!("{} is a frozen problem", path.display()))?;
            return Ok(Frozen::read(path)?);
        }
        let case = read_case(path, &self.case.overrides)?;
        let time_step = self
            .time_step
            .as_ref()
            .map_or(Ok(case.solve_at), |moment| time_step(&case, "--time-step", moment))?;
        let (frozen, missed) = marched(&case, time_step)?;
        if let Some(missed) = missed {
            eprintln!("{missed}");
        }
        Ok(frozen)
    }
}

impl MethodArgs {
    pub(crate) fn method(&self) -> Result<Method> {
        Method::parse(&self.method, &self.settings)
    }
}

impl StopArgs {
    pub(crate) fn stop(&self) -> Stop {
        Stop { on: self.on, tolerance: self.tolerance, max_iterations: self.max_iterations }
    }
}

impl StopChanges {
    /// The keys of the stop rule that are changed, and their new values.
    pub(crate) fn changed(&self) -> impl Iterator<Item = (&'static str, String)> {
        let tolerance = self.tolerance.map(|tolerance| ("tolerance", format!("{tolerance:e}")));
        let on = self.on.map(|on| ("on", on.to_string()));
        let max_iterations = self.max_iterations.map(|n| ("max_iterations", n.to_string()));
        tolerance.into_iter().chain(on).chain(max_iterations)
    }

    /// The arguments that ask for the same.
    pub(crate) fn again(&self) -> impl Iterator<Item = String> {
        self.changed().map(|(key, value)| format!("--{} {value}", key.replace('_', "-")))
    }

    /// `stop` as it is changed.
    pub(crate) fn of(&self, stop: Stop) -> Result<Stop> {
        let stop = Stop {
            on: self.on.unwrap_or(stop.on),
            tolerance: self.tolerance.unwrap_or(stop.tolerance),
            max_iterations: self.max_iterations.unwrap_or(stop.max_iterations),
        };
        stop.check()?;
        Ok(stop)
    }
}

pub(crate) fn measure(name: &str) -> Result<Measure, String> {
    Measure::ALL.into_iter().find(|measure| measure.name() == name).ok_or_else(|| {
        let names: Vec<&str> = Measure::ALL.iter().map(|measure| measure.name()).collect();
        format!("there are {}", names.join(", "))
    })
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let method = args.method.method()?;
    let stop = args.stop.stop();
    if let Some(file) = &args.impulses {
        check_place(file)?;
    }
    stop.check()?;
    let path = root.problem_or_case(&args.problem.problem)?;
    let frozen = args.problem.scene.problem(&path)?;
    let r0 = frozen.start(args.start == Start::Warm);

    let asked = args.truth || stop.on == Measure::VelocityError;
    let known = if asked { known(root, &frozen)? } else { Known::Nothing };
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
        "derived": derived(outcome),
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
