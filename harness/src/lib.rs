//! The programs `gravel` and `gravel-mpi`: what solves contact problems, sweeps methods over plans, freezes problems and simulates scenes.

/// The command line: one file for each command.
mod cli {
    pub(crate) mod archive;
    pub(crate) mod args;
    pub(crate) mod bench;
    pub(crate) mod certify;
    pub(crate) mod collection;
    pub(crate) mod convert;
    pub(crate) mod freeze;
    pub(crate) mod init;
    pub(crate) mod keys;
    pub(crate) mod list;
    pub(crate) mod merge;
    pub(crate) mod plan;
    pub(crate) mod posed;
    pub(crate) mod regress;
    pub(crate) mod report;
    pub(crate) mod schema;
    pub(crate) mod simulate;
    pub(crate) mod site;
    pub(crate) mod solve;
    pub(crate) mod split;
    pub(crate) mod submit;
    #[cfg(test)]
    mod tests;
    pub(crate) mod view;
    pub(crate) mod which;
}

/// The commands of `gravel-mpi`: those of `gravel` where ranks share each problem.
#[cfg(any(feature = "mpi", test))]
mod team {
    pub(crate) mod bench;
    #[cfg(feature = "mpi")]
    mod main;
    mod parts;
    pub(crate) mod ping;
    mod run;
    mod share;
    pub(crate) mod solve;
    pub(crate) mod split;
    #[cfg(test)]
    mod tests;

    #[cfg(feature = "mpi")]
    pub(crate) use main::main;
}

/// The collection: problems by the hash of their content, what is known of their solutions, and submissions.
mod collection {
    mod answers;
    mod check;
    mod entry;
    mod folder;
    mod recipe;
    mod sought;
    mod submission;

    pub(crate) use answers::{Standing, Status};
    pub(crate) use check::{checked, orphans, submitted};
    pub(crate) use entry::{Entry, Foreign, State, sha256};
    pub(crate) use folder::Collection;
    pub(crate) use recipe::{About, Recipe};
    pub(crate) use sought::sought;
    pub(crate) use submission::{Claimed, Division, FORMAT, Submission, distance};
}

/// A study on disk: its journal, its tables, its report, its accepted counts.
mod store {
    mod baseline;
    mod folder;
    mod stored;

    pub(crate) use baseline::{Counts, ExpectedFailure, baseline_text, expected_failures, read_baseline};
    pub(crate) use folder::{
        about, draw, finish, has_tables, open, records_of, runs_folder, studies_in, tables_as_written,
        tables_of,
    };
    pub(crate) use stored::{is_id, problem_of_run, stored, stored_run};
}

/// A plan with its problems or scenes: the tasks that it asks for, each with its id.
mod study {
    mod problems;
    mod selection;
    mod simulations;
    mod tasks;
    #[cfg(test)]
    mod tests;

    pub(crate) use problems::{OnProblems, run_id};
    pub(crate) use selection::Selection;
    pub(crate) use simulations::ThroughTime;
    pub(crate) use tasks::{Kind, Listed, by_id, left_s, missing, run_all};
}

/// A task becomes a row.
mod run {
    mod answer;
    mod curve;
    mod execute;
    mod external;
    mod homogenised;
    pub(crate) mod problem;
    mod repeats;
    mod rows;
    mod simulation;
    #[cfg(test)]
    mod tests;
    mod until;
    mod vtk;

    pub(crate) use answer::{asked, outcome, to_json};
    pub(crate) use curve::{Recorder, decades, first_at};
    pub(crate) use execute::{Conditions, How, Task, few, from_one, in_parallel, in_the_pool};
    pub(crate) use external::{Ended, ended};
    pub(crate) use homogenised::homogenised;
    pub(crate) use problem::{Snapshots, run_on_problem};
    pub(crate) use repeats::{Kept, Made, refused, repeated};
    pub(crate) use rows::{
        contact_forces, derived, ended_row, given_row, partitions, scene_rows, skipped_row,
    };
    pub(crate) use simulation::{End, Seen, Through, missed, observed, run_simulation, through_time};
    pub(crate) use until::{Until, Watch};
    pub(crate) use vtk::Frames;
}

/// Frozen problems, cases, scenes, and what is known of their solutions.
mod problems {
    pub(crate) mod case;
    mod given;
    pub(crate) mod parts;
    mod planned;
    mod pool;
    mod reference;
    mod scene;
    #[cfg(test)]
    mod tests;

    pub(crate) use case::{CaseProblem, KeptProblem, Once, first_hash, overrides, read_case, warn};
    pub(crate) use given::Given;
    pub(crate) use parts::{Impulses, write_parts};
    pub(crate) use planned::{PlannedProblem, Problem, combined, planned};
    pub(crate) use pool::{certified, polished_to};
    pub(crate) use reference::{Found, Known, found};
    pub(crate) use scene::Scene;
}

/// The plan file: methods with their settings, axes, rules.
mod plan {
    mod axes;
    mod checks;
    mod external;
    mod file;
    mod marcher;
    mod methods;
    mod rules;
    #[cfg(test)]
    mod tests;
    mod variants;

    pub(crate) use axes::{MOST, Settings, combinations, count, values};
    pub(crate) use checks::MOST_REPEATS;
    pub(crate) use external::{External, Programme, last_line};
    pub(crate) use file::{Curves, Plan, PlannedCase, chart, yes};
    pub(crate) use marcher::Marcher;
    pub(crate) use methods::{
        Entry, Method, Runs, all_typed, key_value, method, method_names, methods, refuse_repeated,
        take_external, wrong,
    };
    pub(crate) use rules::{Rule, Simulate};
    pub(crate) use variants::{PlannedMethod, Variant, WarmStart, as_typed, last_parts, pairs};
}

/// The terminal: progress and output, Ctrl-C and exit codes, suggestions.
mod terminal {
    pub(crate) mod exit;
    mod output;
    pub(crate) mod progress;
    pub(crate) mod suggest;
    #[cfg(test)]
    mod tests;

    pub(crate) use output::{
        at_hand, check_apart, create_folder_of, is_one_file, merged, prepare_new, prepare_place, read_sealed,
        read_text, replaces, say, say_table, write_instead, write_kept, write_sealed, write_whole,
    };
    pub(crate) use progress::{Bars, Line};
}

/// Files of other codes.
mod exchange {
    mod dat;
    mod edited;
    mod fclib;
    mod files;
    mod global;
    mod symmetry;
    #[cfg(test)]
    mod tests;

    pub(crate) use fclib::Held;
    pub(crate) use files::{converted, is_foreign, read};
}

mod identity;
pub mod library;
mod root;

use anyhow::Result;
use clap::{Parser, Subcommand};
use cli::{
    archive, bench, certify, collection as collected, convert, freeze, init, list, merge, plan as show,
    regress, report, schema, simulate, site, solve, split, submit, view, which,
};
use contact::memory;
use results::provenance::available_memory;
use run::{few, in_the_pool};
use std::path::PathBuf;
use std::process::ExitCode;
use terminal::{exit, suggest};

/// Benchmark of the solvers of non-smooth contact dynamics of granular media.
#[derive(Parser)]
#[command(name = "gravel", version, max_term_width = 100, after_help = exit::HELP)]
struct Cli {
    /// Threads that methods may use [default: one per processor]; results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = few)]
    threads: Option<std::num::NonZeroUsize>,
    /// The checkout, with cases/ and harness/plans/ [default: GRAVEL_ROOT, else the current folder or one above it]; problems and
    /// cases given by path need none
    #[arg(long, global = true, value_name = "DIR")]
    root: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run whatever is still missing from a plan; write its table and figures to reports/out
    Bench(bench::Args),
    /// Show the runs of a plan: which are done, and how long the others take
    Plan(show::Args),
    /// Draw the tables and figures of the newest stored study of a plan again
    Report(report::Args),
    /// Draw one chart of the newest stored study of a plan, into reports/out/PLAN-CHART
    Figure(report::FigureArgs),
    /// Pack a study with all that makes it again into one file; or check such a file, or archived tables, by making some runs again
    #[command(after_help = exit::HELP)]
    Archive(archive::Args),
    /// Write a site of static pages, for any browser, offline: from the archive, the collection and the pages of the tree
    Site(site::Args),
    /// Print a table of the newest stored study of a plan, or some columns and rows of it, for a paper or a program
    Table(report::TableArgs),
    /// Write an HTML page that replays how methods, or a stored run, converge on a problem
    View(view::Args),
    /// Merge the runs of other stores of a plan into its own
    Merge(merge::Args),
    /// Run a plan and compare its counts with the accepted ones, exactly
    Regress(regress::Args),
    /// Run a plan and accept its counts
    Bless(regress::Args),
    /// Solve one contact problem with one method
    #[command(after_help = exit::HELP)]
    Solve(solve::Args),
    /// Find the method for a contact problem: brief runs of those that lead on problems like it
    #[command(after_help = exit::HELP)]
    Which(which::Args),
    /// Print the residuals of a contact problem at the reference solution, or at impulses you supply
    #[command(after_help = format!("{}\n\n{}", certify::HELP, exit::HELP))]
    Certify(certify::Args),
    /// List, show, add, make or check the problems of the collection: each with an id, and what is known of its solutions
    Collection(collected::Args),
    /// Write the impulses that a code found for a problem of the collection as a file to hand in
    Submit(submit::SubmitArgs),
    /// Judge submissions from their impulses alone, and file those that are what they say
    #[command(after_help = exit::HELP)]
    Accept(submit::AcceptArgs),
    /// Write the contact problem of one time step of a case as a file
    Freeze(freeze::Args),
    /// Convert a contact problem to a file that other codes read, or such a file to a problem
    Convert(convert::Args),
    /// Write a contact problem as one file per subdomain, for `gravel-mpi`, whose ranks each read their own
    Split(split::Args),
    /// Join the impulses that the ranks of `gravel-mpi` wrote to one file
    Join(split::JoinArgs),
    /// March a case through time
    #[command(after_help = exit::HELP)]
    Simulate(simulate::Args),
    /// Make a folder of one's own for cases, plans, codes and results, with one of each to begin from
    Init(init::Args),
    /// List what there is: cases, problems, methods, plans or charts
    List(list::Args),
    /// Print the JSON schema of plans, cases or problems: every key with its meaning; editors complete and check with it
    Schema(schema::Args),
}

/// The program `gravel`, built from a `commit`.
pub fn gravel(commit: &'static str) -> ExitCode {
    identity::built_from(commit);
    match run(Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {}", in_one_paragraph(&error));
            ExitCode::FAILURE
        }
    }
}

/// The program `gravel-mpi`: `gravel` where the ranks that `mpirun` starts share each problem.
#[cfg(feature = "mpi")]
pub fn gravel_mpi(commit: &'static str) -> ExitCode {
    identity::built_from(commit);
    team::main()
}

/// Share of the free memory that factorisations may take (–); the rest is for problems, impulses and curves.
const FOR_FACTORS: f64 = 0.8;

impl Command {
    /// Returns what is kept of it where it is stopped and does not end in time.
    fn kept(&self) -> &'static str {
        match self {
            Self::Bench(_) => "the runs that had ended are kept, and the same command goes on",
            Self::Simulate(_) => "the time steps that had ended are kept",
            Self::Regress(_) | Self::Bless(_) => "nothing was compared",
            Self::Solve(_) | Self::Freeze(_) | Self::Convert(_) | Self::View(_) | Self::Which(_) => {
                "nothing of it is kept"
            }
            _ => "what it had written is kept",
        }
    }
}

fn run(cli: Cli) -> Result<ExitCode> {
    exit::listen_for_interrupts(cli.command.kept())?;
    if let Some(threads) = cli.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global()?;
    }
    if let Some(free) = available_memory() {
        memory::allow((FOR_FACTORS * free as f64) as u64);
    }
    let root = root::Root::find(cli.root)?;
    plan::take_external(&root)?;
    match cli.command {
        Command::Bench(args) => return bench::run(root.needed()?, &args),
        Command::Plan(args) => show::run(root.needed()?, &args)?,
        Command::Report(args) => report::run(root.needed()?, &args)?,
        Command::Figure(args) => report::figure(root.needed()?, &args)?,
        Command::Table(args) => report::table(root.needed()?, &args)?,
        Command::Archive(args) => return in_the_pool(|| archive::run(&root, &args)),
        Command::Site(args) => in_the_pool(|| site::run(root.needed()?, &args))?,
        Command::View(args) => in_the_pool(|| view::run(&root, &args))?,
        Command::Merge(args) => return merge::run(root.needed()?, &args),
        Command::Regress(args) => return regress::regress(root.needed()?, &args),
        Command::Bless(args) => return regress::bless(root.needed()?, &args),
        Command::Solve(args) => return in_the_pool(|| solve::run(&root, &args)),
        Command::Which(args) => return in_the_pool(|| which::run(&root, &args)),
        Command::Certify(args) => return certify::run(&root, &args),
        Command::Collection(args) => return in_the_pool(|| collected::run(&root, &args)),
        Command::Submit(args) => in_the_pool(|| submit::submit(&root, &args))?,
        Command::Accept(args) => return in_the_pool(|| submit::accept(&root, &args)),
        Command::Freeze(args) => in_the_pool(|| freeze::run(&root, &args))?,
        Command::Convert(args) => in_the_pool(|| convert::run(&root, &args))?,
        Command::Split(args) => in_the_pool(|| split::run(&root, &args))?,
        Command::Join(args) => split::join(&args)?,
        Command::Simulate(args) => return in_the_pool(|| simulate::run(&root, &args)),
        Command::Init(args) => init::run(&args)?,
        Command::List(args) => list::run(&root, &args)?,
        Command::Schema(args) => schema::run(&args)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The error, then its causes, without those that the text before them says already.
fn in_one_paragraph(error: &anyhow::Error) -> String {
    let mut text = error.to_string().trim_end().to_owned();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.ends_with(cause.trim_end()) {
            text = format!("{text}: {}", cause.trim_end());
        }
    }
    suggest::without_types(&suggest::in_error(&text, cli::keys::of_cases))
}
