//! `gravel which`: the method for a problem, from brief runs of those that lead on problems like it.

use crate::cli::args::StopArgs;
use crate::cli::posed::ProblemArgs;
use crate::plan::Method;
use crate::problems::Problem;
use crate::root::Root;
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

/// Keys of settings with their values.
type Set = &'static [(&'static str, &'static str)];

/// The methods that come first in fields of the maps of the plan `which-method`, or tie with the first in several, each with its
/// settings there. Neither `nsgs` with a fixed ω nor `latin-dd` is first alone in any.
const CANDIDATES: [(&str, Set); 6] = [
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
    #[command(flatten)]
    posed: ProblemArgs,
    #[command(flatten)]
    stop: StopArgs,
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
    /// Its named settings.
    set: Set,
    outcome: Outcome,
    /// True where it was stopped since others are faster, or for its time.
    is_stopped: bool,
    /// Seconds of the runs, set-up included, if they converged.
    seconds: Option<Median>,
}

/// The answers of the candidates: first those that converged, the fastest at the head, then those that came nearest.
struct Answer {
    tried: Vec<Tried>,
    /// Reasons why candidates do not take the problem.
    skipped: Vec<String>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    if !(args.seconds > 0.0) {
        bail!("--seconds {}: it must be positive", args.seconds);
    }
    let stop = args.stop.of(Stop::default())?;
    let path = args.posed.path(root)?;
    let problem = args.posed.read(&path, stop.on == Measure::VelocityError)?;
    let r0 = args.posed.impulses(&path, &problem)?;
    let once = |method: &Method, limit: f64| once(root, &problem, (method, &stop), &r0, limit);
    let mut least = args.seconds / BEHIND;
    let (mut tried, mut skipped) = (Vec::new(), Vec::new());
    for (name, set) in CANDIDATES {
        let settings = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
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
                tried.push(Tried { method, set, outcome, is_stopped, seconds });
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
    let order = |one: &Tried| {
        let seconds = one.seconds.map_or(f64::INFINITY, |seconds| seconds.median);
        (seconds, one.outcome.measures.get(stop.on))
    };
    tried.sort_by(|a, b| {
        let ((a, left), (b, right)) = (order(a), order(b));
        a.total_cmp(&b).then(left.total_cmp(&right))
    });
    let answer = Answer { tried, skipped };
    if args.json {
        answer.say_json(&problem, &stop)?;
    } else {
        answer.say(&problem, &stop)?;
    }
    Ok(exit::code(answer.status().name()))
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

impl Answer {
    /// The fastest of those that converged.
    fn first(&self) -> Option<&Tried> {
        self.tried.first().filter(|first| first.seconds.is_some())
    }

    /// Methods that are near the first, and whose interval overlaps its own: one run that was disturbed makes no tie.
    fn ties(&self) -> impl Iterator<Item = &Tried> {
        let first = self.first().and_then(|first| first.seconds);
        let is_tie = move |one: &&Tried| {
            let both = first.zip(one.seconds);
            both.is_some_and(|(first, own)| own.low <= first.high && own.median <= NEAR * first.median)
        };
        self.tried.iter().skip(1).filter(is_tie)
    }

    /// The method that proved that there is no solution: a proof is exact, and a tolerance is not.
    fn proof(&self) -> Option<&Tried> {
        self.tried.iter().find(|one| one.outcome.status == Status::Infeasible)
    }

    fn status(&self) -> Status {
        match (self.proof(), self.first()) {
            (Some(_), _) => Status::Infeasible,
            (None, Some(_)) => Status::Converged,
            (None, None) => Status::Stalled,
        }
    }

    fn say_json(&self, problem: &Problem, stop: &Stop) -> Result<()> {
        let tried = |one: &Tried| {
            let seconds = |of: fn(&Median) -> f64| one.seconds.as_ref().map(of);
            json!({
                "method": one.method.name,
                "settings": one.method.settings,
                "status": one.ending(),
                "iterations": one.outcome.iterations,
                stop.on.name(): one.outcome.measures.get(stop.on),
                "seconds": seconds(|seconds| seconds.median),
                "seconds_low": seconds(|seconds| seconds.low),
                "seconds_high": seconds(|seconds| seconds.high),
            })
        };
        let answer = json!({
            "problem": problem.name,
            "stop_on": stop.on,
            "tolerance": stop.tolerance,
            "status": self.status(),
            "take": self.first().map(|first| first.method.name),
            "ties": self.ties().map(|one| one.method.name).collect::<Vec<_>>(),
            "tried": self.tried.iter().map(tried).collect::<Vec<_>>(),
            "skipped": self.skipped,
        });
        say(format_args!("{answer}"))
    }

    /// Prints the methods in their order, and which to take.
    fn say(&self, problem: &Problem, stop: &Stop) -> Result<()> {
        let (name, size) = (&problem.name, problem.posed.facts().size());
        say(format_args!("{name}: {size}; {} ≤ {:e}", stop.on, stop.tolerance))?;
        let widest = self.tried.iter().map(|one| one.named().len()).max().unwrap_or(0);
        for one in &self.tried {
            let seconds = match one.seconds {
                Some(Median { low, median, high }) if low < high => {
                    format!("{median:.2e} s ({low:.2e} to {high:.2e})")
                }
                Some(Median { median, .. }) => format!("{median:.2e} s"),
                None => format!("{}, {} {:.1e}", one.ending(), stop.on, one.outcome.measures.get(stop.on)),
            };
            let (name, iterations) = (one.named(), one.outcome.iterations);
            say(format_args!("  {name:<widest$}{iterations:>9} iterations   {seconds}"))?;
        }
        for why in &self.skipped {
            say(format_args!("  {why}"))?;
        }
        if let Some(one) = self.proof() {
            return say(format_args!("{} proves that the problem has no solution", one.method.name));
        }
        let Some(first) = self.first() else {
            return say(format_args!(
                "none of them converges, the first comes nearest; `--seconds` or `--max-iterations` may be too few"
            ));
        };
        let ties: Vec<&str> = self.ties().map(|one| one.method.name).collect();
        let why = match &ties[..] {
            [] => "the least median time here".to_owned(),
            ties => {
                format!("tied with {}: the intervals of {REPEATS} runs each overlap", ties.join(", "))
            }
        };
        say(format_args!("take --method {}: {why}", first.named()))?;
        say(format_args!("This holds for this problem; reports/which-method.md has samples of many kinds."))
    }
}

impl Tried {
    /// The method with its named settings, as arguments.
    fn named(&self) -> String {
        let set = self.set.iter().map(|(key, value)| format!(" --set {key}={value}"));
        self.method.name.to_owned() + &set.collect::<String>()
    }

    /// Ending of its run.
    fn ending(&self) -> &'static str {
        match self.outcome.status {
            Status::Interrupted if self.is_stopped => "stopped",
            status => status.name(),
        }
    }
}
