//! `gravel-mpi solve`: one contact problem, one method, on ranks of which each has its own subdomains alone.

use crate::cli::args::SolverArgs;
use crate::cli::solve::Start;
use crate::cli::split::read;
use crate::plan::Method;
use crate::problems::{Impulses, Root, Studied};
use crate::run::{OnShare, Posted, Shared, Source, cut_of, exchanged, is_split, on_ranks, share, whole_of};
use crate::terminal::{Line, exit, merged, say};
use anyhow::{Context, Result};
use contact::Measure;
use partition::{Grid, Team};
use runner::{Measured, OnRanks, Progress, Stop};
use serde_json::{Value, json};
use std::fs;
use std::num::NonZeroU64;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A folder that `gravel split` wrote, of which each rank reads its own files; or a frozen problem, its name or the path of its
    /// file, which each rank reads whole before it keeps its own part
    problem: String,
    #[command(flatten)]
    solver: SolverArgs,
    /// Subdomains, such as 8 or 4x2 [default: those of the folder or of the method's settings, else one for each rank]
    #[arg(long, value_name = "GRID", value_parser = read::<Grid>)]
    subdomains: Option<Grid>,
    /// Begin from r = 0 (cold), from the impulses of the time step before (warm), or from those in a FOLDER to which `--impulses`
    /// wrote, of which each rank reads those of its own subdomains
    #[arg(long, value_name = "START", default_value = "cold", value_parser = Start::read)]
    start: Start,
    /// Measure the distance to the reference solution as well; so does `--on velocity_error`. Of a folder it is the one that `gravel
    /// split --truth` wrote there, and each rank reads its own part
    #[arg(long)]
    truth: bool,
    /// Measure one iterate in N: all ranks wait for a measure, and it takes as long as an iteration; the run may end N - 1
    /// iterations late
    #[arg(long, value_name = "N", default_value = "1")]
    measure_every: NonZeroU64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the impulses to FOLDER, a file per subdomain, each by the rank that has it; `gravel join` joins them
    #[arg(long, value_name = "FOLDER")]
    impulses: Option<PathBuf>,
}

pub(crate) fn run(posted: &Posted, root: &Root, args: &Args) -> Result<ExitCode> {
    let (method, stop) = args.solver.read()?;
    if let Some(folder) = &args.impulses {
        let made = if posted.rank() == 0 { fs::create_dir_all(folder) } else { Ok(()) };
        posted.agree(made.with_context(|| folder.display().to_string()))?;
    }
    let folder = Path::new(&args.problem);
    let whole = is_split(&args.problem).then(|| whole_of(posted, folder)).transpose()?;
    let (method, grid, scheme) = cut_of(posted, &method, args.subdomains, whole.as_ref())?;
    let truth = args.truth || stop.on == Measure::VelocityError;
    let source = Source { root, problem: &args.problem, grid, scheme, truth };
    share(posted, &source, Solve { posted, args, method: &method, stop: &stop })?
}

struct Solve<'a> {
    posted: &'a Posted,
    args: &'a Args,
    method: &'a Method,
    stop: &'a Stop,
}

impl OnShare for Solve<'_> {
    type Output = Result<ExitCode>;

    fn on<M: Studied>(self, shared: Shared<M>) -> Result<ExitCode> {
        let Self { posted, args, method, stop } = self;
        let first = posted.rank() == 0;
        let start = posted.agree(start(&args.start, &shared))?;
        let mut line = first.then(|| Line::alone(method.name.to_owned()));
        let mut observe = |progress: &Progress| {
            if let Some(line) = &mut line {
                line.show(progress, stop.on);
            }
            if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let end = on_ranks(
            method,
            (&shared, &start),
            stop,
            Measured::OneIn(args.measure_every.get()),
            &mut observe,
        )?;
        let _whole = exit::whole();
        drop(line);
        if let Some(folder) = &args.impulses {
            posted.agree(Impulses::write_all(folder, &shared.share, &shared.hash, &end.impulses))?;
        }
        let held = Held::of(&shared);
        let told = match first {
            true if args.json => say(format_args!("{}", to_json(&shared, method, stop, &end, &held)?)),
            true => print(&shared, method, stop, &end, &held),
            false => Ok(()),
        };
        posted.agree(told)?;
        Ok(if first { exit::code(end.status.name()) } else { ExitCode::SUCCESS })
    }
}

/// The impulses that this rank begins from (N·s).
fn start<M: Studied>(
    start: &Start,
    Shared { hash, share, start: before, .. }: &Shared<M>,
) -> Result<Vec<f64>> {
    match start {
        Start::Cold => Ok(vec![0.0; share.problem.impulse_count()]),
        Start::Warm => Ok(before.clone()),
        Start::From(folder) => Impulses::read_own(folder, share, hash),
    }
}

/// The most that one rank holds.
struct Held {
    grains: f64,
    contacts: f64,
    /// Peak memory of its process (B); 0 where the system does not tell.
    memory_bytes: f64,
}

impl Held {
    fn of<M: Studied>(Shared { share, team, .. }: &Shared<M>) -> Self {
        Self {
            grains: team.max(share.problem.grain_count() as f64),
            contacts: team.max(share.problem.contact_count() as f64),
            memory_bytes: team.max(peak_memory_bytes().unwrap_or(0.0)),
        }
    }
}

/// The most memory that this process has had (B), where the system tells.
pub(crate) fn peak_memory_bytes() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.strip_suffix("kB"))?;
    kilobytes.trim().parse::<f64>().ok().map(|kilobytes| 1024.0 * kilobytes)
}

fn to_json<M: Studied>(
    Shared { name, hash, share, team, .. }: &Shared<M>,
    method: &Method,
    stop: &Stop,
    end: &OnRanks,
    held: &Held,
) -> Result<Value> {
    let (messages, bytes, waiting_s) = exchanged(&end.traffic);
    let derived: Vec<Value> = end.derived.iter().map(|(key, value)| json!([key, value])).collect();
    let object = json!({
        "problem": name,
        "mechanics": M::NAME,
        "problem_hash": hash,
        "grains": share.whole.grains,
        "contacts": share.whole.contacts,
        "subdomains": share.whole.subdomains,
        "method": method.name,
        "settings": method.settings,
        "derived": derived,
        "stop_on": stop.on,
        "tolerance": stop.tolerance,
        "max_iterations": stop.max_iterations,
        "status": end.status,
        "iterations": end.iterations,
        "setup_s": end.setup.as_secs_f64(),
        "iterating_s": end.iterating.as_secs_f64(),
        "worst_contact": end.measures.worst_contact,
        "critical_path": end.critical_path,
        "ranks": team.size(),
        "messages": messages,
        "message_bytes": bytes,
        "waiting_s": waiting_s,
        "slowest_rank": end.slowest,
        "most_grains_of_a_rank": held.grains,
        "most_contacts_of_a_rank": held.contacts,
        "peak_memory_of_a_rank_bytes": held.memory_bytes,
    });
    let object = merged(object, serde_json::to_value(end.measures)?);
    Ok(merged(object, serde_json::to_value(end.work)?))
}

fn print<M: Studied>(
    Shared { name, share, team, .. }: &Shared<M>,
    method: &Method,
    stop: &Stop,
    end: &OnRanks,
    held: &Held,
) -> Result<()> {
    let whole = &share.whole;
    let ranks = of_ranks(team);
    say(format_args!(
        "{name}: {} grains, {} contacts in {} subdomains on {ranks}",
        whole.grains, whole.contacts, whole.subdomains
    ))?;
    say(format_args!("{} {}", method.name, Value::Object(method.settings.clone())))?;
    let (status, iterations) = (end.status.name(), end.iterations);
    let (on, tolerance, plural) = (stop.on, stop.tolerance, if iterations == 1 { "" } else { "s" });
    say(format_args!("{status} after {iterations} iteration{plural} ({on} ≤ {tolerance:e} asked)"))?;
    let (setup, iterating) = (end.setup.as_secs_f64(), end.iterating.as_secs_f64());
    say(format_args!("  set-up {setup:.3e} s, iterating {iterating:.3e} s"))?;
    let (messages, bytes, waiting) = exchanged(&end.traffic);
    let slowest = end.slowest;
    say(format_args!(
        "  {messages} messages of {bytes} B in all; up to {waiting:.3e} s of waiting, least at rank {slowest}"
    ))?;
    say(format_args!("  no rank holds more than {} grains and {} contacts", held.grains, held.contacts))?;
    for measure in Measure::ALL {
        let (name, value) = (measure.name(), end.measures.get(measure));
        let unit = if measure == Measure::PenetrationRate { " m/s" } else { "" };
        if measure == Measure::Zeta || !value.is_nan() {
            say(format_args!("  {name:<17}{value:.3e}{unit}"))?;
        }
    }
    Ok(())
}

fn of_ranks(team: &Team) -> String {
    format!("{} rank{}", team.size(), if team.size() == 1 { "" } else { "s" })
}
