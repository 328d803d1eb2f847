//! `gravel-mpi solve`: one contact problem, one method, on ranks of which each has its own subdomains alone.

use crate::cli::args::{SolverArgs, read};
use crate::cli::posed::Start;
use crate::cli::solve::{say_ending, say_measures};
use crate::plan::Method;
use crate::problems::Impulses;
use crate::root::Root;
use crate::run::to_json;
use crate::team::parts::read_impulses;
use crate::team::run::on_ranks;
use crate::team::share::{Posted, Shared, Source, cut_of, is_split, share, whole_of};
use crate::terminal::{Line, exit, say};
use anyhow::{Context, Result};
use contact::Measure;
use partition::Grid;
use results::schema::Exchange;
use runner::{Measured, Outcome, Progress, Stop};
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
    let (method, stop) = args.solver.or((Method::parse("cg", &[])?, Stop::default()))?;
    if let Some(folder) = &args.impulses {
        let made = if posted.rank() == 0 { fs::create_dir_all(folder) } else { Ok(()) };
        posted.agree(made.with_context(|| folder.display().to_string()))?;
    }
    let folder = Path::new(&args.problem);
    let split = is_split(&args.problem).then(|| whole_of(posted, folder)).transpose()?;
    let (method, grid, scheme) = cut_of(posted, &method, args.subdomains, split.as_ref())?;
    let truth = args.truth || stop.on == Measure::VelocityError;
    let source = Source { root, problem: &args.problem, grid, scheme, truth };
    let shared = share(posted, &source)?;
    let first = posted.rank() == 0;
    let start = posted.agree(start(&args.start, &shared))?;
    let mut line = first.then(|| Line::alone(method.name.to_owned()));
    let mut observe = |progress: &Progress| {
        if let Some(line) = &mut line {
            line.show(progress, stop.on);
        }
        if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let measured = Measured::OneIn(args.measure_every.get());
    let (end, exchange) = on_ranks(&method, (&shared, &start), &stop, measured, &mut observe)?;
    let _whole = exit::whole();
    drop(line);
    if let Some(folder) = &args.impulses {
        posted.agree(Impulses::write_all(folder, &*shared.share, &shared.hash, &end.impulses))?;
    }
    let held = Held::of(&shared);
    let said = match first {
        true if args.json => {
            say(format_args!("{}", told(&shared, &method, &stop, (&end, &exchange), &held)?))
        }
        true => print(&shared, &method, &stop, (&end, &exchange), &held),
        false => Ok(()),
    };
    posted.agree(said)?;
    Ok(if first { exit::code(end.status.name()) } else { ExitCode::SUCCESS })
}

/// The impulses that this rank begins from (N·s).
fn start(start: &Start, Shared { hash, share, start: before, .. }: &Shared) -> Result<Vec<f64>> {
    match start {
        Start::Cold => Ok(vec![0.0; before.len()]),
        Start::Warm => Ok(before.clone()),
        Start::From(folder) => read_impulses(folder, &**share, hash),
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
    fn of(Shared { share, team, .. }: &Shared) -> Self {
        let facts = share.facts();
        Self {
            grains: team.max(facts.grains as f64),
            contacts: team.max(facts.contacts as f64),
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

fn told(
    Shared { name, hash, share, team, .. }: &Shared,
    method: &Method,
    stop: &Stop,
    (end, exchange): (&Outcome, &Exchange),
    held: &Held,
) -> Result<Value> {
    let whole = share.whole();
    let asked = json!({
        "problem": name,
        "mechanics": share.facts().mechanics,
        "problem_hash": hash,
        "grains": whole.grains,
        "contacts": whole.contacts,
        "subdomains": whole.subdomains,
        "method": method.name,
        "settings": method.settings,
        "stop_on": stop.on,
        "tolerance": stop.tolerance,
        "max_iterations": stop.max_iterations,
        "critical_path": end.critical_path,
        "ranks": team.size(),
        "messages": exchange.messages,
        "message_bytes": exchange.message_bytes,
        "waiting_s": exchange.waiting_s,
        "slowest_rank": exchange.slowest_rank,
        "most_grains_of_a_rank": held.grains,
        "most_contacts_of_a_rank": held.contacts,
        "peak_memory_of_a_rank_bytes": held.memory_bytes,
    });
    to_json(asked, end)
}

fn print(
    Shared { name, share, team, .. }: &Shared,
    method: &Method,
    stop: &Stop,
    (end, exchange): (&Outcome, &Exchange),
    held: &Held,
) -> Result<()> {
    let whole = share.whole();
    let ranks = format!("{} rank{}", team.size(), if team.size() == 1 { "" } else { "s" });
    say(format_args!(
        "{name}: {} grains, {} contacts in {} subdomains on {ranks}",
        whole.grains, whole.contacts, whole.subdomains
    ))?;
    let seconds = [end.setup, end.iterating].map(|time| time.as_secs_f64());
    say_ending(method, stop, (end.status, end.iterations), seconds)?;
    let Exchange { messages, message_bytes: bytes, waiting_s: waiting, slowest_rank: slowest, .. } = exchange;
    say(format_args!(
        "  {messages} messages of {bytes} B in all; up to {waiting:.3e} s of waiting, least at rank {slowest}"
    ))?;
    say(format_args!("  no rank holds more than {} grains and {} contacts", held.grains, held.contacts))?;
    say_measures(&end.measures)
}
