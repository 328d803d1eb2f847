//! `gravel freeze`: the contact problem of one time step of a case, as a file.

use crate::cli::args::{CaseArgs, MethodArgs, StopArgs};
use crate::problems::files::{Root, march_to, stem, time_step};
use crate::problems::memory::read_case;
use crate::terminal::output::{check_place, replaces, say, write_whole};
use anyhow::{Result, anyhow, bail};
use cases::{March, check_name};
use std::fmt::Write;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A case: its name, or the path of its file
    case: String,
    /// The time step, counted from 1, or one of the case's moments
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    time_step: String,
    /// The file to write; the problem is named after it
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Replace FILE if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    changes: CaseArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    stop: StopArgs,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    if replaces(&args.output) && !args.force {
        bail!("{} exists: give another file, or --force to replace it", args.output.display());
    }
    check_place(&args.output)?;
    check_name(&stem(&args.output))
        .map_err(|why| anyhow!("{}: the problem's {why}", args.output.display()))?;
    let path = root.case(&args.case)?;
    let case = read_case(&path, &args.changes.overrides)?;
    let (method, stop) = (args.method.method()?, args.stop.stop());
    let time_step = time_step(&case, "--time-step", &args.time_step)?;
    let (mut frozen, missed) = march_to(&mut March::new(&case)?, time_step, &method, &stop)?;
    frozen.name = stem(&args.output);
    for (key, value) in &args.changes.overrides {
        write!(frozen.source, " {key} = {value}.")?;
    }
    write!(
        frozen.source,
        " Time steps before it solved by {} to {} ≤ {:e}, from the impulses of the one before.",
        method.name, stop.on, stop.tolerance
    )?;
    if let Some(missed) = missed {
        eprintln!("{missed}");
        write!(frozen.source, " {missed}")?;
    }
    write_whole(&args.output, &frozen.to_json()?)?;
    say(format_args!(
        "{}: {} grains, {} contacts",
        args.output.display(),
        frozen.problem.grain_count(),
        frozen.problem.contact_count()
    ))?;
    Ok(())
}
