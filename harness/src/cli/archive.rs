//! `gravel archive`: a study in one file with all that makes it again; the check of such a file, or of archived rows; and the renewal of
//! some of these.

mod check;
mod pack;
mod renew;

use crate::cli::args::PlanArgs;
use crate::root::{Root, stem};
use crate::store::{studies_in, tables_of};
use crate::terminal::say_table;
use anyhow::{Context, Result, bail};
use check::Check;
use pack::pack;
use renew::renew;
use results::journal::Record;
use results::schema::Provenance;
use results::simulation::Simulated;
use results::study::{Runs, Study as Rows};
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    study: PlanArgs,
    /// The tables, such as those in results/archive/PLAN [default: those of the newest study in results/runs]
    #[arg(long, value_name = "FOLDER")]
    rows: Option<PathBuf>,
    /// The file to write, a tar archive
    #[arg(short, long, value_name = "FILE.tar", required = true)]
    output: Option<PathBuf>,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Check the checksums of a packed study, or of archived tables, and make a share of the runs again, to the same counts
    Check(Check),
    /// Replace archived rows by those of a study: of the same method, variant, problem and tolerance; new ones are added
    Renew {
        /// The folder of archived tables, such as results/archive/PLAN
        #[arg(value_name = "ARCHIVED")]
        archived: PathBuf,
        /// The folder of the study, such as results/runs/PLAN
        #[arg(value_name = "STUDY")]
        study: PathBuf,
    },
    /// Print a Markdown table of the archived studies: rows, size, commit, machine
    List {
        /// The folder of the archive [default: results/archive of the checkout]
        folder: Option<PathBuf>,
    },
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    match (&args.command, &args.output) {
        (Some(Command::Check(check)), _) => check.run(root),
        (Some(Command::Renew { archived, study }), _) => renew(archived, study).map(|()| ExitCode::SUCCESS),
        (Some(Command::List { folder }), _) => {
            let folder = folder.clone().unwrap_or_else(|| root.join("results/archive"));
            list(&folder).map(|()| ExitCode::SUCCESS)
        }
        (None, Some(output)) => pack(root.needed()?, args, output).map(|()| ExitCode::SUCCESS),
        (None, None) => bail!("--output: name the file to write"),
    }
}

fn list(folder: &Path) -> Result<()> {
    let mut rows = Vec::new();
    for study in studies_in(folder)? {
        let tables = tables_of(&study)?;
        let mut bytes = 0;
        for file in fs::read_dir(&study).with_context(|| study.display().to_string())? {
            bytes += file?.metadata()?.len();
        }
        let all = Row::all(&tables);
        let words = |of: fn(&Provenance) -> String| each(&all, of).into_iter().collect::<Vec<_>>().join(", ");
        let commits =
            words(|o| o.commit.split_at_checked(7).map_or(&*o.commit, |(short, _)| short).to_owned());
        let machine = words(|o| format!("{}, {} of {} threads", o.processor, o.threads, o.processors));
        let seconds: f64 = all.iter().map(|row| row.wall_s).filter(|wall| wall.is_finite()).sum();
        let size = format!("{:.1}", bytes as f64 / 1e6);
        let name = stem(&study);
        let minutes = format!("{:.1}", seconds / 60.0);
        let renewed = format!("`just archive {name}`");
        rows.push(vec![format!("`{name}`"), counted(&tables), size, minutes, commits, machine, renewed]);
    }
    say_table(&["study", "rows", "MB", "minutes", "commit", "machine", "renewed by"], &rows)
}

/// Facts about a row, be it a run or a simulation.
struct Row<'r> {
    /// Name of its plan.
    plan: &'r str,
    /// Name of its problem or scene.
    name: &'r str,
    /// Settings of that.
    settings: &'r Map<String, Value>,
    /// Hash of that.
    hash: &'r str,
    /// Time that it took, with its repeats and measures (s).
    wall_s: f64,
    provenance: &'r Provenance,
}

impl<'r> Row<'r> {
    /// Returns the rows of a study.
    fn all(rows: &'r Rows) -> Vec<Self> {
        let of_run = |record: &'r Record| {
            let run = &record.run;
            Self {
                plan: &run.plan,
                name: &run.problem,
                settings: &run.problem_settings,
                hash: &run.problem_hash,
                wall_s: run.timing.wall_s,
                provenance: &run.provenance,
            }
        };
        let of_simulation = |simulated: &'r Simulated| {
            let one = &simulated.simulation;
            Self {
                plan: &one.plan,
                name: &one.scene,
                settings: &one.scene_settings,
                hash: &one.scene_hash,
                wall_s: one.timing.wall_s,
                provenance: &one.provenance,
            }
        };
        match rows {
            Rows::Runs(Runs { records, .. }) => records.iter().map(of_run).collect(),
            Rows::Simulations(all) => all.iter().map(of_simulation).collect(),
        }
    }
}

/// Returns the number of rows, in words.
fn counted(rows: &Rows) -> String {
    match rows {
        Rows::Runs(Runs { records, .. }) => format!("{} runs", records.len()),
        Rows::Simulations(all) => format!("{} simulations", all.len()),
    }
}

/// Returns what rows say of their provenance, each once.
fn each(rows: &[Row], of: impl Fn(&Provenance) -> String) -> BTreeSet<String> {
    rows.iter().map(|row| of(row.provenance)).collect()
}
