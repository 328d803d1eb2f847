//! `gravel which`: the method for a problem, from brief runs of those that lead on problems like it.

use crate::cli::args::{SceneArgs, Start, StopArgs};
use crate::plan::Method;
use crate::problems::{Problem, Root};
use crate::run::outcome;
use crate::terminal::{Line, exit, say};
use anyhow::{Result, bail};
use contact::Measure;
use results::Median;
use runner::{Outcome, Progress, Status, Stop};
use serde_json::json;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The methods that are first in a field of the maps of the plan `which-method`, or not told from the first in many, each with its
/// settings there.
const CANDIDATES: [(&str, &[(&str, &str)]); 6] = [
    ("nsgs", &[("acceleration", "nesterov")]),
    ("cg", &[("preconditioner", "diagonal")]),
    ("nncg", &[]),
    ("mprgp", &[("preconditioner", "diagonal")]),
    ("apgd", &[]),
    ("active-set", &[]),
];

/// Multiple of the least time so far after which a method is stopped (–).
const BEHIND: f64 = 2.0;
/// Multiple of the least time within which a method is run again for its interval, and may tie (–); and number of these runs.
const NEAR: f64 = 1.5;
const REPEATS: usize = 5;
/// Time within which no method is stopped, and all are run again (s): the first run of a program waits for its threads and caches.
const SHORT: f64 = 0.05;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem or a case: its name, or the path of its file; or a file of another code, FCLIB (.hdf5) or Siconos (.dat)
    #[arg(value_name = "PROBLEM-OR-CASE")]
    problem: String,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    stop: StopArgs,
    /// Start from r = 0 (cold), from the impulses of the time step before, if there are any (warm), or from those in a FILE as
    /// `--impulses` of `solve` writes it
    #[arg(long, value_name = "START", default_value = "cold", value_parser = Start::read)]
    start: Start,
    /// Stop a method that has not converged after this time, or after twice the time of the fastest so far (s)
    #[arg(long, value_name = "S", default_value_t = 10.0, allow_negative_numbers = true)]
    seconds: f64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// A candidate and its runs.
struct Tried {
    method: Method,
    outcome: Outcome,
    /// True where it was stopped since others are faster, or for its time.
    is_stopped: bool,
    /// Seconds of the runs, set-up included, if they converged.
    seconds: Option<Median>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    if !(args.seconds > 0.0) {
        bail!("--seconds {}: it must be positive", args.seconds);
    }
    let stop = args.stop.of(Stop::default())?;
    let path = root.any_problem_or_case(&args.problem)?;
    let problem = args.scene.given(&path, stop.on == Measure::VelocityError)?;
    let r0 = args.start.impulses(&path, &problem)?;
    let once = |method: &Method, limit: f64| once(root, &problem, (method, &stop), &r0, limit);
    let mut least = args.seconds / BEHIND;
    let (mut tried, mut skipped) = (Vec::new(), Vec::new());
    for (name, settings) in CANDIDATES {
        let settings = settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
        let method = Method::parse(name, &settings.collect::<Vec<_>>())?;
        match once(&method, f64::max(BEHIND * least, SHORT)) {
            Err(why) => skipped.push(format!("{name}: {why:#}")),
            Ok((outcome, is_stopped)) => {
                if exit::requested() {
                    return Ok(exit::code(Status::Interrupted.name()));
                }
                let seconds = (outcome.status == Status::Converged).then(|| time(&outcome));
                least = seconds.map_or(least, |seconds| seconds.min(least));
                let seconds = seconds.and_then(|seconds| Median::of(vec![seconds]));
                tried.push(Tried { method, outcome, is_stopped, seconds });
            }
        }
    }
    let is_near =
        |one: &&mut Tried| one.seconds.is_some_and(|seconds| seconds.median <= f64::max(NEAR * least, SHORT));
    for one in tried.iter_mut().filter(is_near) {
        let repeats = (0..REPEATS).map(|_| Ok(time(&once(&one.method, f64::INFINITY)?.0)));
        one.seconds = Median::of(repeats.collect::<Result<_>>()?);
        if exit::requested() {
            return Ok(exit::code(Status::Interrupted.name()));
        }
    }
    tried.sort_by(|a, b| order(a).total_cmp(&order(b)));
    answer(&problem, &stop, &tried, &skipped, args.json)
}

/// Runs a method once, for so many seconds at most; true if it was stopped for them.
fn once(
    root: &Root,
    problem: &Problem,
    (method, stop): (&Method, &Stop),
    r0: &[f64],
    limit: f64,
) -> Result<(Outcome, bool)> {
    let begin = Instant::now();
    let mut line = Line::alone(method.name.to_owned());
    let mut is_late = false;
    let mut observe = |progress: &Progress| {
        line.show(progress, stop.on);
        is_late = begin.elapsed() > Duration::try_from_secs_f64(limit).unwrap_or(Duration::MAX);
        if is_late || exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = outcome(problem, problem.known(root)?, (method, stop), r0, &mut observe)?;
    Ok((outcome, is_late))
}

/// Returns the seconds of a run, set-up included.
fn time(outcome: &Outcome) -> f64 {
    (outcome.setup + outcome.iterating).as_secs_f64()
}

/// Orders what converged by its time, before all that did not.
fn order(tried: &Tried) -> f64 {
    tried.seconds.map_or(f64::INFINITY, |seconds| seconds.median)
}

/// Prints the methods, the first first, and what to take.
fn answer(
    problem: &Problem,
    stop: &Stop,
    tried: &[Tried],
    skipped: &[String],
    json: bool,
) -> Result<ExitCode> {
    let found = tried.first().filter(|first| first.seconds.is_some());
    // Those of which no difference shows.
    let ties: Vec<&Tried> = tried.iter().skip(1).filter(|one| is_tie(found, one)).collect();
    let proved = tried.iter().find(|one| one.outcome.status == Status::Infeasible);
    let status = match (found, proved) {
        (Some(_), _) => Status::Converged,
        (None, Some(_)) => Status::Infeasible,
        (None, None) => Status::Stalled,
    };
    let code = exit::code(status.name());
    if json {
        let of = |one: &Tried| {
            let of_seconds = |of: fn(&Median) -> f64| one.seconds.as_ref().map(of);
            json!({
                "method": one.method.name,
                "settings": one.method.settings,
                "status": ending(one),
                "iterations": one.outcome.iterations,
                stop.on.name(): one.outcome.measures.get(stop.on),
                "seconds": of_seconds(|seconds| seconds.median),
                "seconds_low": of_seconds(|seconds| seconds.low),
                "seconds_high": of_seconds(|seconds| seconds.high),
            })
        };
        let answer = json!({
            "problem": problem.name,
            "stop_on": stop.on,
            "tolerance": stop.tolerance,
            "take": found.map(|first| first.method.name),
            "ties": ties.iter().map(|one| one.method.name).collect::<Vec<_>>(),
            "tried": tried.iter().map(of).collect::<Vec<_>>(),
            "skipped": skipped,
        });
        say(format_args!("{answer}"))?;
        return Ok(code);
    }
    say(format_args!(
        "{}: {}; {} ≤ {:e}",
        problem.name,
        problem.posed.facts().size(),
        stop.on,
        stop.tolerance
    ))?;
    for one in tried {
        let seconds = match one.seconds {
            Some(Median { low, median, high }) if low < high => {
                format!("{median:.2e} s ({low:.2e} to {high:.2e})")
            }
            Some(Median { median, .. }) => format!("{median:.2e} s"),
            None => format!("{}, {} {:.1e}", ending(one), stop.on, one.outcome.measures.get(stop.on)),
        };
        say(format_args!("  {:<12}{:>9} iterations   {seconds}", one.method.name, one.outcome.iterations))?;
    }
    for why in skipped {
        say(format_args!("  {why}"))?;
    }
    if let (None, Some(one)) = (found, proved) {
        say(format_args!("{} proves that the problem has no solution", one.method.name))?;
        return Ok(code);
    }
    let Some(first) = found else {
        say(format_args!(
            "none of them converges in the time that `--seconds` gives each; the nearest is above"
        ))?;
        return Ok(code);
    };
    let set = CANDIDATES
        .iter()
        .find(|(name, _)| *name == first.method.name)
        .map_or(&[][..], |(_, settings)| settings);
    let set: Vec<String> = set.iter().map(|(key, value)| format!(" --set {key}={value}")).collect();
    let why = match &ties[..] {
        [] => "the fastest of those that converge".to_owned(),
        ties => format!(
            "as fast as {}: the intervals of {REPEATS} runs each overlap",
            ties.iter().map(|one| one.method.name).collect::<Vec<_>>().join(", ")
        ),
    };
    say(format_args!("take --method {}{}: {why}", first.method.name, set.concat()))?;
    Ok(code)
}

/// Reports whether a method is near the first and the intervals of both times overlap: one run that was disturbed makes no tie.
fn is_tie(first: Option<&Tried>, one: &Tried) -> bool {
    let both = first.and_then(|first| first.seconds).zip(one.seconds);
    both.is_some_and(|(first, seconds)| seconds.low <= first.high && seconds.median <= NEAR * first.median)
}

/// Ending of a method's run.
fn ending(one: &Tried) -> &'static str {
    match one.outcome.status {
        Status::Interrupted if one.is_stopped => "stopped, too slow",
        status => status.name(),
    }
}
