//! `gravel simulate`: a case through time, with what the scene shows of itself.

use crate::cli::args::{CaseArgs, SolverArgs};
use crate::plan::{Method, Rule};
use crate::problems::{Once, read_case, warn};
use crate::root::Root;
use crate::run::{End, Frames, Seen, missed, observed, through_time};
use crate::terminal::{check_apart, exit, merged, prepare_place, progress, say, write_sealed};
use anyhow::{Context, Result, bail};
use cases::{AnyFrozen, Case, Start};
use indicatif::ProgressBar;
use lineup::march;
use results::columns::cells;
use results::simulation::{Observed, Totals};
use serde_json::json;
use std::fs::File;
use std::io::Write;
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A case: its name, or the path of its file
    case: String,
    /// Number of time steps to march
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    time_steps: u64,
    /// Write the observables of every time step to FILE, as CSV, each row as soon as its time step has ended
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write frames for ParaView to FOLDER, the initial state first: grains, contacts and walls as a .vtu each; open its
    /// .pvd
    #[arg(long, value_name = "FOLDER")]
    vtk: Option<PathBuf>,
    /// A frame for every K-th time step
    #[arg(long, value_name = "K", default_value = "1", requires = "vtk")]
    every: NonZeroU64,
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
    if let Some(file) = &args.output {
        if file.exists() {
            bail!("{} exists: give another file", file.display());
        }
        prepare_place(file)?;
    }
    let outputs = [("--output", &args.output), ("--vtk", &args.vtk)];
    check_apart(
        &outputs.iter().filter_map(|(name, path)| Some((*name, path.as_deref()?))).collect::<Vec<_>>(),
    )?;
    let case = read_case(&root.case(&args.case)?, &args.changes.overrides)?;
    let (method, stop) = args.solver.through(&case)?;
    let mut march = march(&case)?;
    march.check(method.ours()?)?;
    warn(&case.name, march.warnings());
    let mut once = Once::default();
    let warm_start = match (args.cold, args.extrapolate) {
        (true, _) => Start::Nothing,
        (_, true) => Start::Extrapolated,
        _ => Start::Previous,
    };
    let rule = Rule { stop, warm_start };
    let mut kept = Kept::new(args, &case, &method)?;
    if let Some(frames) = &mut kept.frames {
        frames.begin(&*march)?;
    }
    if !args.json {
        say(format_args!("{HEADING}"))?;
    }
    let see = &mut |seen: &Seen| {
        once.warn(&case.name, seen.march, &kept.bar);
        kept.see(args, seen)
    };
    let ended = through_time(&mut *march, method.ours()?, &rule, args.time_steps, &exit::requested, see);
    let _whole = exit::whole();
    kept.bar.finish_and_clear();
    let (totals, end) = ended?;
    let last_state = match &end {
        End::Refused(why) => bail!("method `{}`, {why}", method.name),
        End::Exploded { last, .. } => Some(last_state(last, args)),
        End::Completed | End::Interrupted(_) => None,
    };
    let missed = missed(&totals, &stop);
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
            "status": end.status(),
            "reason": reason.unwrap_or_default(),
            "last_state": last_state,
            "last_time_step": kept.reached,
        });
        say(format_args!("{}", merged(object, serde_json::to_value(totals)?)))?;
    } else {
        kept.say(args)?;
        let missed = missed.map(|text| text + advice(&case, &method));
        say_ending(&case.name, args, &totals, missed, &end, last_state)?;
    }
    Ok(exit::code(end.worst(&totals)))
}

/// Output of a simulation under way: a program that is killed leaves the time steps that had ended.
struct Kept {
    rows: Option<File>,
    frames: Option<Frames>,
    bar: ProgressBar,
    /// Observables of the last time step.
    reached: Option<Observed>,
}

impl Kept {
    fn new(args: &Args, case: &Case, method: &Method) -> Result<Self> {
        let frames = |folder: &PathBuf| Frames::new(folder, &case.name, method.partition());
        let frames = args.vtk.as_ref().map(frames).transpose()?;
        let begin = |path: &PathBuf| -> Result<File> {
            let file = File::create_new(path);
            let names: Vec<String> =
                row(&Observed::default(), "", 0.0)?.into_iter().map(|(name, _)| name).collect();
            file.and_then(|mut file| writeln!(file, "{}", names.join(",")).map(|()| file))
                .with_context(|| path.display().to_string())
        };
        let rows = args.output.as_ref().map(begin).transpose()?;
        Ok(Self { rows, frames, bar: progress::bar(args.time_steps, "time steps"), reached: None })
    }

    fn see(&mut self, args: &Args, seen: &Seen) -> Result<()> {
        let _whole = exit::whole();
        let (k, observed) = (seen.totals.time_steps, observed(seen));
        if let (Some(file), Some(path)) = (&mut self.rows, &args.output) {
            // Its own iterations, not those so far.
            let own = Observed { iterations: seen.outcome.iterations, ..observed };
            let row = row(&own, seen.outcome.status.name(), seen.march.mean_diameter())?;
            let values: Vec<String> = row.into_iter().map(|(_, value)| value).collect();
            // At once, so that no half row is left.
            let line = values.join(",") + "\n";
            file.write_all(line.as_bytes()).with_context(|| path.display().to_string())?;
        }
        if let Some(frames) = self.frames.as_mut().filter(|_| k.is_multiple_of(args.every.get())) {
            frames.add(observed.time_s, seen.march, Some((seen.problem, &seen.outcome.impulses)))?;
        }
        // Ten lines on the terminal, whatever the length.
        let shown_every = (args.time_steps / 10).max(1);
        if !args.json && (k.is_multiple_of(shown_every) || k == args.time_steps) {
            self.bar.suspend(|| say_time_step(seen, &observed))?;
        }
        self.reached = Some(observed);
        self.bar.inc(1);
        Ok(())
    }

    fn say(&self, args: &Args) -> Result<()> {
        if let Some(file) = &args.output {
            say(format_args!("{}", file.display()))?;
        }
        self.frames.as_ref().map_or(Ok(()), Frames::say)
    }
}

/// Writes the problem of the last good state beside what else is written.
fn last_state(last: &AnyFrozen, args: &Args) -> Result<PathBuf> {
    let folder = args.output.as_deref().and_then(Path::parent).or(args.vtk.as_deref());
    let file = folder.unwrap_or(Path::new("")).join(format!("{}.json", last.name()));
    let write = || -> Result<()> {
        if file.exists() {
            bail!("{} exists", file.display());
        }
        write_sealed(&file, &last.to_json()?)
    };
    write().context("the problem of its last good state was not written")?;
    Ok(file)
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
        None => "what was reached before is kept".to_owned(),
    };
    eprintln!("error: {case}: {}; {kept}", end.reason());
    Ok(())
}

fn say_time_step(seen: &Seen, row: &Observed) -> Result<()> {
    let Observed { time_step, time_s, contacts, kinetic_energy_j, mean_height_m, .. } = row;
    let solved = format!("{time_step:>10}  {time_s:>9.4}  {contacts:>8}  {:>10}", seen.outcome.iterations);
    let shown =
        format!("{kinetic_energy_j:>14.4e}  {mean_height_m:>13.6}  {:>11.3e}", row.greatest_overlap_m);
    say(format_args!("{solved}  {shown}  {:>11.4e}", row.floor_impulse_n_s))
}

/// A row of the file, each value with its column: what is observed, the status of the solve, and the greatest overlap over the mean
/// diameter of grains (m).
fn row(observed: &Observed, status: &str, mean_diameter: f64) -> Result<Vec<(String, String)>> {
    let mut row = cells(observed)?;
    let in_diameters = (observed.greatest_overlap_m / mean_diameter).to_string();
    for (after, name, value) in [
        ("contacts", "status", status.to_owned()),
        ("greatest_overlap_m", "greatest_overlap_mean_diameters", in_diameters),
    ] {
        let place = row.iter().position(|(column, _)| column == after).map_or(row.len(), |place| place + 1);
        row.insert(place, (name.to_owned(), value));
    }
    Ok(row)
}
