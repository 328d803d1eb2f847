//! `gravel simulate`: a case through time, with what the scene shows of itself.

use crate::inputs::Root;
use crate::output::{check_place, say, write_whole};
use crate::progress;
use crate::solve::{CaseArgs, MethodArgs, StopArgs};
use anyhow::{Result, bail};
use cases::{Case, March, Observables};
use contact::{Outcome, Status};
use std::fmt::Write;
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
    #[command(flatten)]
    changes: CaseArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    stop: StopArgs,
}

const COLUMNS: &str =
    "time_step,time_s,contacts,status,iterations,kinetic_energy_j,mean_height_m,greatest_overlap_m";

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    if let Some(file) = &args.output {
        if file.exists() {
            bail!("{} exists: give another file", file.display());
        }
        check_place(file)?;
    }
    let path = root.case(&args.case)?;
    let case = Case::read(&path, &args.changes.overrides)?;
    let (method, stop) = (args.method.method()?, args.stop.stop());
    let mut march = March::new(&case)?;
    let mut csv = format!("{COLUMNS}\n");
    let mut missed = 0;
    // Ten lines on the terminal, whatever the length.
    let shown_every = (args.time_steps / 10).max(1);
    say(format_args!(
        "{:>10}  {:>9}  {:>8}  {:>10}  {:>14}  {:>13}  {:>11}",
        "time step", "time (s)", "contacts", "iterations", "kinetic e. (J)", "mean h. (m)", "overlap (m)"
    ))?;
    let bar = progress::bar(args.time_steps, "time steps");
    for k in 1..=args.time_steps {
        let (outcome, observables) = match march.time_step(&*method.solver, &stop) {
            Ok(made) => made,
            Err(error) => {
                // What was made before is kept.
                bar.finish_and_clear();
                write_observables(args.output.as_deref(), &csv)?;
                return Err(error.into());
            }
        };
        missed += u64::from(outcome.status != Status::Converged);
        writeln!(csv, "{}", row(k, &outcome, &observables))?;
        if k % shown_every == 0 || k == args.time_steps {
            let Observables { time, kinetic_energy, mean_height, greatest_overlap } = observables;
            let (contacts, iterations) = (outcome.impulses.len(), outcome.iterations);
            let solved = format!("{k:>10}  {time:>9.4}  {contacts:>8}  {iterations:>10}");
            let seen = format!("{kinetic_energy:>14.4e}  {mean_height:>13.6}  {greatest_overlap:>11.3e}");
            bar.suspend(|| say(format_args!("{solved}  {seen}")))?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if missed > 0 {
        say(format_args!(
            "{missed} of {} time steps did not converge to {} ≤ {:e}",
            args.time_steps, stop.on, stop.tolerance
        ))?;
    }
    write_observables(args.output.as_deref(), &csv)
}

fn write_observables(file: Option<&Path>, csv: &str) -> Result<()> {
    let Some(file) = file else { return Ok(()) };
    write_whole(file, csv)?;
    say(format_args!("{}", file.display()))?;
    Ok(())
}

fn row(time_step: u64, outcome: &Outcome, observables: &Observables) -> String {
    let Observables { time, kinetic_energy, mean_height, greatest_overlap } = observables;
    let (contacts, status, iterations) = (outcome.impulses.len(), outcome.status.name(), outcome.iterations);
    format!(
        "{time_step},{time},{contacts},{status},{iterations},{kinetic_energy},{mean_height},{greatest_overlap}"
    )
}
