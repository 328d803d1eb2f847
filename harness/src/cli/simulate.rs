//! `gravel simulate`: a case through time, with what the scene shows of itself.

mod kept;

use crate::cli::args::{CaseArgs, SolverArgs};
use crate::cli::simulate::kept::Kept;
use crate::plan::{Method, Rule};
use crate::problems::{Once, read_case, warn};
use crate::root::Root;
use crate::run::{End, Seen, Until, Watch, from_one, missed, through_time};
use crate::terminal::{check_apart, exit, merged, prepare_new, say, write_sealed};
use anyhow::{Context, Result, bail};
use cases::{AnyFrozen, Case, Start};
use lineup::march;
use results::simulation::Totals;
use serde_json::json;
use std::num::NonZeroU64;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A case: its name, or the path of its file
    case: String,
    /// Number of time steps to march; with `--restart` that of further ones
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    time_steps: u64,
    /// Resume from the state in FILE, which `--state` wrote: with the same case, method and tolerance bitwise as if the simulation had not stopped
    #[arg(long, value_name = "FILE")]
    restart: Option<PathBuf>,
    /// Write the last state to FILE, also if the simulation is stopped; with `--every` that of every K-th time step before as well
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// End before the last time step, once the packing is at rest or its flow is steady
    #[arg(long, value_name = "CONDITION")]
    until: Option<Until>,
    /// The time over which the condition looks (s) [default: √(d/g) at rest, 10 √(d/g) for each mean of a steady flow]
    #[arg(long, value_name = "SECONDS", requires = "until", allow_negative_numbers = true)]
    over: Option<f64>,
    /// Write the observables of every time step to FILE, as CSV, each row as soon as its time step has ended
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write frames for ParaView to FOLDER, the initial state first: grains, contacts and walls as a .vtu each; open its
    /// .pvd
    #[arg(long, value_name = "FOLDER")]
    vtk: Option<PathBuf>,
    /// Write the contacts with their impulses to FILE, a table whose name ends in .parquet or .csv
    #[arg(long, value_name = "FILE")]
    contacts: Option<PathBuf>,
    /// A frame, contacts and a state for every K-th time step [default: 1 of frames and contacts]
    #[arg(long, value_name = "K", value_parser = from_one::<NonZeroU64>)]
    every: Option<NonZeroU64>,
    /// Start each time step from r = 0, not from the impulses of the one before
    #[arg(long)]
    cold: bool,
    /// Start each time step from the impulses of the two before, extrapolated linearly
    #[arg(long, conflicts_with = "cold")]
    extrapolate: bool,
    /// Print one JSON object: how it ended, what it took and its last time step
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    changes: CaseArgs,
    #[command(flatten)]
    solver: SolverArgs,
}

/// Heading above the rows on the terminal.
const HEADING: &str =
    " time step   time (s)  contacts  iterations  kinetic e. (J)    mean h. (m)  overlap (m)  floor (N·s)";

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let files = [("--output", &args.output), ("--state", &args.state), ("--contacts", &args.contacts)];
    for file in files.iter().filter_map(|(_, file)| file.as_ref()) {
        prepare_new(file)?;
    }
    if let (Some(every), None, None, None) = (args.every, &args.vtk, &args.contacts, &args.state) {
        bail!("--every {every}: it asks for --vtk, --contacts or --state");
    }
    let outputs = files.into_iter().chain([("--vtk", &args.vtk)]);
    check_apart(&outputs.filter_map(|(name, path)| Some((name, path.as_deref()?))).collect::<Vec<_>>())?;
    let case = read_case(&root.case(&args.case)?, &args.changes.overrides)?;
    let (method, stop) = args.solver.read()?;
    let mut march = march(&case)?;
    march.check(method.ours()?)?;
    warn(&case.name, march.warnings());
    if let Some(file) = &args.restart {
        march.resume(&case, file)?;
    }
    let scale = (case.scene.gravity_m_per_s2, march.mean_diameter(), case.scene.time_step_s);
    let watch = args.until.map(|until| Watch::new(until, args.over, scale)).transpose()?;
    let mut once = Once::default();
    let warm_start = match (args.cold, args.extrapolate) {
        (true, _) => Start::Nothing,
        (_, true) => Start::Extrapolated,
        _ => Start::Previous,
    };
    let rule = Rule { stop, warm_start };
    let mut kept = Kept::new(args, &case, &method, watch)?;
    kept.begin(&*march)?;
    if !args.json {
        say(format_args!("{HEADING}"))?;
    }
    let see = &mut |seen: &Seen| {
        once.warn(&case.name, seen.march, &kept.bar);
        kept.see(seen)
    };
    let ended = through_time(&mut *march, method.ours()?, &rule, args.time_steps, &exit::requested, see);
    let _whole = exit::whole();
    kept.bar.finish_and_clear();
    let (totals, end) = match ended {
        Ok(ended) => ended,
        Err(error) => {
            // What was reached is kept, whatever ended it.
            if let Err(also) = kept.end(&*march, false) {
                eprintln!("error: {also:#}");
            }
            return Err(error);
        }
    };
    kept.end(&*march, matches!(end, End::Exploded { .. }))?;
    let last_state = match &end {
        End::Refused(why) => bail!("method `{}`, {why}", method.name),
        End::Exploded { last, .. } => last_state(last, args),
        End::Completed | End::Interrupted(_) => None,
    };
    let missed = missed(&totals, &stop);
    let is_met = kept.is_met();
    if args.json {
        let reason = if matches!(end, End::Completed) { missed.as_deref() } else { Some(end.reason()) };
        let last_state = last_state.and_then(|state| state.inspect_err(|error| eprintln!("{error:#}")).ok());
        let object = json!({
            "case": case.name,
            "method": method.name,
            "settings": method.settings,
            "warm_start": rule.warm_start,
            "stop_on": stop.on,
            "tolerance": stop.tolerance,
            "max_iterations": stop.max_iterations,
            "time_step_s": case.scene.time_step_s,
            "time_steps_asked": args.time_steps,
            "until": args.until,
            "is_met": is_met,
            "status": end.status(),
            "reason": reason.unwrap_or_default(),
            "last_state": last_state,
            "last_time_step": kept.reached(),
        });
        say(format_args!("{}", merged(object, serde_json::to_value(totals)?)))?;
    } else {
        kept.say()?;
        let missed = missed.map(|text| text + advice(&case, &method));
        say_ending(&case.name, args, &totals, missed, &end, last_state)?;
    }
    let worst = end.worst(&totals);
    let is_unmet = is_met == Some(false) && worst == End::Completed.status();
    Ok(exit::code(if is_unmet { exit::UNMET } else { worst }))
}

/// Writes the problem of the last good state beside what else is written, if anything is.
fn last_state(last: &AnyFrozen, args: &Args) -> Option<Result<PathBuf>> {
    let mut files = [&args.output, &args.state, &args.contacts].into_iter().flatten();
    let folder = args.vtk.as_deref().or_else(|| files.find_map(|file| file.parent()))?;
    let file = folder.join(format!("{}.json", last.name()));
    let write = || -> Result<()> {
        if file.exists() {
            bail!("{} exists", file.display());
        }
        write_sealed(&file, &last.to_json()?)
    };
    let written = write().context("the problem of its last good state was not written");
    Some(written.map(|()| file))
}

/// Returns advice on a method or a setting for time steps that did not converge; empty if there is none.
fn advice(case: &Case, method: &Method) -> &'static str {
    match method.name {
        _ if !case.scene.is_rough() => "",
        "cg" | "nsgs" => "; `--method active-set` may reach them, or a looser `--tolerance`",
        _ => "",
    }
}

fn say_ending(
    case: &str,
    args: &Args,
    totals: &Totals,
    missed: Option<String>,
    end: &End,
    last_state: Option<Result<PathBuf>>,
) -> Result<()> {
    if !matches!(end, End::Completed) {
        say(format_args!("{} after {} of {} time steps", end.status(), totals.time_steps, args.time_steps))?;
    }
    if let Some(missed) = missed {
        say(format_args!("{missed}"))?;
    }
    if matches!(end, End::Completed) {
        return Ok(());
    }
    let kept = match last_state {
        Some(Ok(file)) => format!("the problem of its last good state is {}", file.display()),
        Some(Err(error)) => format!("{error:#}"),
        None if matches!(end, End::Exploded { .. }) => {
            "with `--output`, `--state` or `--vtk` the problem of its last good state is kept".to_owned()
        }
        None => "what was reached before is kept".to_owned(),
    };
    eprintln!("error: {case}: {}; {kept}", end.reason());
    Ok(())
}
