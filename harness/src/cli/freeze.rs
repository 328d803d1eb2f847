//! `gravel freeze`: the contact problem of one time step of a case, as a file.

use crate::cli::args::{CaseArgs, SolverArgs};
use crate::problems::CaseProblem;
use crate::root::{Root, stem};
use crate::terminal::{check_apart, prepare_place, replaces, say, write_whole};
use anyhow::{Result, anyhow, bail};
use cases::check_name;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(
    after_help = "Without --method the time steps before are solved as `gravel solve CASE` solves them: by cg with the \
                  preconditioner `diagonal`, with friction by active-set. Whatever the method, with friction each stops at 1e-4 unless \
                  --tolerance says otherwise. The problem's key `missed_before` says how many did not converge."
)]
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
    solver: SolverArgs,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let file = args.output.display();
    if replaces(&args.output) && !args.force {
        bail!("{file} exists: give another file, or --force to replace it");
    }
    prepare_place(&args.output)?;
    check_apart(&[("the case", root.case(&args.case)?.as_path()), ("--output", args.output.as_path())])?;
    let name = stem(&args.output);
    check_name(&name).map_err(|why| anyhow!("{file}: the problem's {why}"))?;
    let case = args.changes.at(&root.case(&args.case)?, Some(&args.time_step))?;
    let (method, stop) = args.solver.or(case.before()?)?;
    let how = CaseProblem::solved_by(&method, &stop);
    let mut frozen = case.marched(&method, &stop, &how, &|| false)?;
    frozen.rename(&name);
    write_whole(&args.output, &frozen.to_json()?)?;
    let (grains, contacts) = frozen.size();
    say(format_args!("{file}: {grains} grains, {contacts} contacts"))
}
