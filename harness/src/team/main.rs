//! The command line of `gravel-mpi`, at each rank.

use crate::cli::split::Args as SplitArgs;
use crate::plan::take_external;
use crate::root::Root;
use crate::run::{few, in_the_pool};
use crate::team::share::Posted;
use crate::team::{bench, ping, solve, split};
use crate::terminal::exit;
use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use ranks::World;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// `gravel` where ranks share each problem: `mpirun -n 8 gravel-mpi …`.
#[derive(Parser)]
#[command(name = "gravel-mpi", version, max_term_width = 100, after_help = exit::HELP)]
struct Cli {
    /// Threads of each rank; results do not depend on it
    #[arg(long, global = true, value_name = "N", default_value = "1", value_parser = few)]
    threads: NonZeroUsize,
    /// The checkout, with cases/ and harness/plans/ [default: GRAVEL_ROOT, else the current folder or one above it]
    #[arg(long, global = true, value_name = "DIR")]
    root: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make a case in parts and write it as one file per subdomain, each rank its own: for scenes that no machine holds
    Split(SplitArgs),
    /// Solve one contact problem with one method
    Solve(solve::Args),
    /// Run whatever is still missing from a plan, each run on all ranks; rank 0 stores its row
    Bench(bench::Args),
    /// Measure what a message costs between rank 0 and rank 1: its latency and its seconds per byte
    Ping(ping::Args),
}

/// All ranks; those that end with an error end alike, and rank 0 says why.
pub(crate) fn main() -> ExitCode {
    let Some(world) = World::begin() else {
        eprintln!("error: MPI cannot be used by a thread other than the first");
        return ExitCode::FAILURE;
    };
    let posted = Posted(Arc::new(world.post()));
    let first = posted.rank() == 0;
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            if first {
                // Nobody is left to be told if this fails.
                drop(error.print());
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(1));
        }
    };
    match catch_unwind(AssertUnwindSafe(|| run(&posted, &cli))) {
        Ok(Ok(code)) => code,
        Ok(Err(error)) => {
            if first {
                eprintln!("error: {}", crate::in_one_paragraph(&error));
            }
            ExitCode::FAILURE
        }
        // The others cannot be told in any other way.
        Err(_) => {
            eprintln!("error: rank {} ends the others", posted.rank());
            World::abort(1)
        }
    }
}

fn run(posted: &Posted, cli: &Cli) -> Result<ExitCode> {
    rayon::ThreadPoolBuilder::new().num_threads(cli.threads.get()).build_global()?;
    let root = posted.agree(Root::find(cli.root.clone()))?;
    posted.agree(take_external(&root))?;
    exit::listen_for_interrupts("the runs that had ended are kept").context("at this rank")?;
    match &cli.command {
        Command::Split(args) => split::run(posted, &root, args),
        Command::Solve(args) => in_the_pool(|| solve::run(posted, &root, args)),
        Command::Ping(args) => ping::run(posted, args),
        Command::Bench(args) => in_the_pool(|| bench::run(posted, root.needed()?, args)),
    }
}
