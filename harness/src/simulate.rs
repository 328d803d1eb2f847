//! `gravel simulate`: a case through time, with what the scene shows of itself.

use crate::inputs::Root;
use crate::interrupt;
use crate::memory::read_case;
use crate::output::{check_place, say, write_whole};
use crate::plan::Rule;
use crate::progress;
use crate::simulations::{End, Frames, Seen, through_time};
use crate::solve::{CaseArgs, MethodArgs, StopArgs};
use anyhow::{Result, bail};
use cases::{Frozen, March, Observables};
use std::fmt::Write;
use std::num::NonZeroU64;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A case: its name, or the path of its file
    case: String,
    /// How many time steps to make
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    time_steps: u64,
    /// Write the observables of every time step to FILE, as CSV
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write frames for ParaView to FOLDER: grains with radius and velocity, contacts with impulse; open its .pvd
    #[arg(long, value_name = "FOLDER")]
    vtk: Option<PathBuf>,
    /// A frame for every K-th time step
    #[arg(long, value_name = "K", default_value = "1", requires = "vtk")]
    every: NonZeroU64,
    /// Begin each time step from r = 0, not from the impulses of the one before
    #[arg(long)]
    cold: bool,
    #[command(flatten)]
    changes: CaseArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    stop: StopArgs,
}

const COLUMNS: &str = "time_step,time_s,contacts,status,iterations,kinetic_energy_j,mean_height_m,greatest_overlap_m,\
                       greatest_overlap_mean_diameters,mean_overlap_m,greatest_speed_m_per_s,floor_impulse_n_s,\
                       left_impulse_n_s,right_impulse_n_s";

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    if let Some(file) = &args.output {
        if file.exists() {
            bail!("{} exists: give another file", file.display());
        }
        check_place(file)?;
    }
    let path = root.case(&args.case)?;
    let case = read_case(&path, &args.changes.overrides)?;
    let (method, stop) = (args.method.method()?, args.stop.stop());
    stop.check()?;
    let mut march = March::new(&case)?;
    let mut frames = args.vtk.as_ref().map(|folder| Frames::new(folder, &case.name)).transpose()?;
    let rule = Rule { stop, warm_start: !args.cold };
    let mut csv = format!("{COLUMNS}\n");
    // Ten lines on the terminal, whatever the length.
    let shown_every = (args.time_steps / 10).max(1);
    interrupt::listen()?;
    say_heading()?;
    let bar = progress::bar(args.time_steps, "time steps");
    let made = through_time(&mut march, &*method.solver, &rule, args.time_steps, &mut |seen| {
        let k = seen.totals.time_steps;
        writeln!(csv, "{}", row(seen))?;
        if let Some(frames) = frames.as_mut().filter(|_| k.is_multiple_of(args.every.get())) {
            frames.add(seen.observables.time, seen.march, seen.time_step, &seen.outcome.impulses)?;
        }
        if k.is_multiple_of(shown_every) || k == args.time_steps {
            bar.suspend(|| say_time_step(seen))?;
        }
        bar.inc(1);
        Ok(if interrupt::asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    });
    bar.finish_and_clear();
    // What was made is kept, however it ended.
    if let Some(file) = &args.output {
        write_whole(file, &csv)?;
        say(format_args!("{}", file.display()))?;
    }
    frames.as_ref().map_or(Ok(()), Frames::finish)?;
    let (totals, end) = made?;
    if totals.missed > 0 {
        say(format_args!(
            "{} of {} time steps did not converge to {} ≤ {:e}",
            totals.missed, totals.time_steps, stop.on, stop.tolerance
        ))?;
    }
    match end {
        End::Completed => Ok(()),
        End::Interrupted => bail!("stopped after {} of {} time steps", totals.time_steps, args.time_steps),
        End::Refused(why) => bail!("method `{}`, {why}", method.name),
        End::Exploded { why, last } => {
            bail!("{}: {why}; {}", case.name, kept(&last, args.output.as_deref(), args.vtk.as_deref()))
        }
    }
}

/// Writes the problem of the last good state beside what else was asked for, and says where it is.
fn kept(last: &Frozen, output: Option<&Path>, vtk: Option<&Path>) -> String {
    let folder = output.and_then(Path::parent).or(vtk).unwrap_or(Path::new(""));
    let file = folder.join(format!("{}.json", last.name));
    let write = || -> Result<()> {
        if file.exists() {
            bail!("{} exists", file.display());
        }
        write_whole(&file, &last.to_json()?)
    };
    match write() {
        Ok(()) => format!("the problem of its last good state is {}", file.display()),
        Err(error) => format!("the problem of its last good state was not written: {error:#}"),
    }
}

fn say_heading() -> Result<()> {
    say(format_args!(
        "{:>10}  {:>9}  {:>8}  {:>10}  {:>14}  {:>13}  {:>11}  {:>11}",
        "time step",
        "time (s)",
        "contacts",
        "iterations",
        "kinetic e. (J)",
        "mean h. (m)",
        "overlap (m)",
        "floor (N·s)"
    ))?;
    Ok(())
}

fn say_time_step(seen: &Seen) -> Result<()> {
    let Observables { time, kinetic_energy, mean_height, greatest_overlap, wall_impulses, contacts, .. } =
        seen.observables;
    let (k, iterations) = (seen.totals.time_steps, seen.outcome.iterations);
    let solved = format!("{k:>10}  {time:>9.4}  {contacts:>8}  {iterations:>10}");
    let shown = format!("{kinetic_energy:>14.4e}  {mean_height:>13.6}  {greatest_overlap:>11.3e}");
    say(format_args!("{solved}  {shown}  {:>11.4e}", wall_impulses[0]))?;
    Ok(())
}

fn row(seen: &Seen) -> String {
    let Observables { time, kinetic_energy, mean_height, greatest_overlap, mean_overlap, .. } =
        seen.observables;
    let Observables { wall_impulses: [floor, left, right], contacts, greatest_speed, .. } = seen.observables;
    let (k, status, iterations) =
        (seen.totals.time_steps, seen.outcome.status.name(), seen.outcome.iterations);
    let in_diameters = greatest_overlap / seen.march.mean_diameter();
    format!(
        "{k},{time},{contacts},{status},{iterations},{kinetic_energy},{mean_height},{greatest_overlap},{in_diameters},\
         {mean_overlap},{greatest_speed},{floor},{left},{right}"
    )
}
