//! `gravel bench`: the runs of a plan that its store lacks, then tables and a report.

use crate::cli::args::StudyArgs;
use crate::identity::provenance;
use crate::plan::MOST_REPEATS;
use crate::root::Root;
use crate::run::{How, few, from_one};
use crate::store::{finish, open, runs_folder};
use crate::study::{Kind, OnProblems, Selection, ThroughTime, by_id, left_s, missing, run_all};
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use results::store::Store;
use runner::Measured;
use std::collections::HashSet;
use std::num::{NonZeroU32, NonZeroUsize};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) study: StudyArgs,
    /// Do N different runs at a time: the counts are the same, but seconds are then not taken alone
    #[arg(long, value_name = "N", default_value = "1", value_parser = few)]
    pub(crate) jobs: NonZeroUsize,
    /// Run everything N times, after one warm-up that does not count; seconds are medians [default: the plan's
    /// `repeats`, or 1]
    #[arg(long, value_name = "N", value_parser = from_one::<NonZeroU32>)]
    pub(crate) repeats: Option<NonZeroU32>,
    /// Run everything again, finished runs too; the new rows replace the old ones in the tables
    #[arg(long)]
    pub(crate) rerun: bool,
    /// Start afresh; the old rows are kept in a folder named after the time
    #[arg(long, conflicts_with = "rerun")]
    pub(crate) fresh: bool,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    if let Some(repeats) = args.repeats.filter(|repeats| *repeats > MOST_REPEATS) {
        bail!("--repeats {repeats}: it must be at most {MOST_REPEATS}");
    }
    let selection = args.study.selection(root)?;
    if let Some(threads) = selection.plan.threads {
        // Refused where `--threads` has said it before.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.get() as usize).build_global();
    }
    if !selection.plan.through_time() {
        return bench::<OnProblems>(root, args, selection);
    }
    if args.repeats.is_some_and(|repeats| repeats.get() > 1) {
        bail!("--repeats: a simulation is run once; its seconds are those of many time steps");
    }
    bench::<ThroughTime>(root, args, selection)
}

fn bench<K: Kind>(root: &Root, args: &Args, selection: Selection) -> Result<ExitCode> {
    let provenance = provenance()?;
    let name = &selection.plan.name;
    if args.fresh
        && let Some(kept) = Store::set_aside(&runs_folder(root), name)?
    {
        say(format_args!("what was there is now in {}", kept.display()))?;
    }
    // A place that cannot be written to is known before a problem is computed.
    let mut store: Store<K::Record> = open(root, name)?;
    let study = K::new(selection, root, true)?;
    let Selection { plan, notes, again, .. } = study.selection();
    let done = if args.rerun { HashSet::new() } else { by_id(store.records()).into_keys().collect() };
    let tasks = missing(&study.tasks(), &done);
    let left = left_s(&tasks, store.records()).filter(|s| *s >= 1.0 && !args.rerun);
    let left = left.map_or(String::new(), |s| format!(", about {s:.0} s"));
    let (asks, size) = (study.asks(), study.size());
    say(format_args!("plan {}: {asks}; {} of {size} to run{left}", plan.name, tasks.len()))?;
    for note in notes {
        say(format_args!("  {note}"))?;
    }
    let folder = store.folder().to_owned();
    let repeats = args.repeats.unwrap_or(plan.repeats).get();
    let (folder, measured) = (Some(&*folder), Measured::Grid);
    let how = How { root, folder, provenance: &provenance, repeats, jobs: args.jobs, measured };
    run_all(&study, &tasks, &how, |record| Ok(store.append(record)?)).with_context(|| {
        // An error does not lose what ended before it.
        format!("stopped; what ended before is kept, `gravel bench {again}` goes on")
    })?;
    finish(root, &study, store)
}
