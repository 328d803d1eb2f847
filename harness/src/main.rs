//! `gravel`: solves contact problems, sweeps methods over plans, freezes problems and simulates scenes.

mod baseline;
mod bench;
mod curve;
mod execute;
mod freeze;
mod identity;
mod inputs;
mod interrupt;
mod list;
mod merge;
mod methods;
mod output;
mod plan;
mod progress;
mod regress;
mod rows;
mod simulate;
mod solve;
mod study;
mod tables;

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Benchmark of the solvers of non-smooth contact dynamics of granular media.
#[derive(Parser)]
#[command(name = "gravel", version, max_term_width = 100)]
struct Cli {
    /// Threads that methods may use [default: one per processor]; results do not depend on it
    #[arg(long, global = true, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// The checkout with cases/ and harness/plans/ [default: the current folder or one above it]
    #[arg(long, global = true, value_name = "DIR")]
    root: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make the runs of a plan that are not in results/runs yet; write its table and figures to reports/out
    Bench(bench::Args),
    /// Join the runs of other stores of a plan to its own
    Merge(merge::Args),
    /// Make the runs of a plan and compare their counts with the accepted ones, exactly
    Regress(regress::Args),
    /// Make the runs of a plan and accept their counts
    Bless(regress::Args),
    /// Solve one contact problem with one method
    Solve(solve::Args),
    /// Write the contact problem of one time step of a case as a file
    Freeze(freeze::Args),
    /// March a case through time
    Simulate(simulate::Args),
    /// List what there is: cases, methods or plans
    List(list::Args),
}

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {}", in_one_paragraph(&error));
            ExitCode::FAILURE
        }
    }
}

fn run(cli: Cli) -> Result<ExitCode> {
    if let Some(threads) = cli.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global()?;
    }
    let root = inputs::Root::find(cli.root)?;
    match cli.command {
        Command::Bench(args) => return bench::run(&root, &args),
        Command::Merge(args) => return merge::run(&root, &args),
        Command::Regress(args) => return regress::regress(&root, &args),
        Command::Bless(args) => return regress::bless(&root, &args),
        Command::Solve(args) => solve::run(&root, &args)?,
        Command::Freeze(args) => freeze::run(&root, &args)?,
        Command::Simulate(args) => simulate::run(&root, &args)?,
        Command::List(args) => list::run(&root, &args)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The error, then its causes, without those that the text before them tells already.
fn in_one_paragraph(error: &anyhow::Error) -> String {
    let mut text = error.to_string().trim_end().to_owned();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.ends_with(cause.trim_end()) {
            text = format!("{text}: {}", cause.trim_end());
        }
    }
    text
}
