//! `gravel bench`: the runs of a plan that its store lacks, then tables and a report.

use crate::cli::args::StudyArgs;
use crate::cli::simulations;
use crate::plan::checks::MOST_REPEATS;
use crate::problems::files::Root;
use crate::run::execute::{How, execute, few};
use crate::store::folder::{begin_anew, finish, open, provenance, stopped};
use crate::study::runs::{Progress, Study};
use crate::terminal::interrupt;
use crate::terminal::output::say;
use anyhow::{Result, bail};
use std::collections::HashSet;
use std::num::{NonZeroU32, NonZeroUsize};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Make N different runs at a time: the counts are the same, but seconds are then not taken alone
    #[arg(long, value_name = "N", default_value = "1", value_parser = few)]
    pub(crate) jobs: NonZeroUsize,
    /// Make every run N times, and one before that is not counted; its seconds are medians [default: the plan's
    /// `repeats`, or 1]
    #[arg(long, value_name = "N")]
    pub(crate) repeats: Option<NonZeroU32>,
    /// Make all runs again, those that are there as well; the new rows replace them in the tables
    #[arg(long)]
    pub(crate) rerun: bool,
    /// Begin anew; what was there is kept in a folder named after the time
    #[arg(long, conflicts_with = "rerun")]
    pub(crate) fresh: bool,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    if let Some(repeats) = args.repeats.filter(|repeats| *repeats > MOST_REPEATS) {
        bail!("--repeats {repeats}: it must be at most {MOST_REPEATS}");
    }
    let selection = args.study.selection(root)?;
    if selection.plan.simulate.is_some() {
        return simulations::bench(root, args, selection);
    }
    let provenance = provenance()?;
    begin_anew(root, args.fresh, &selection.plan.name)?;
    // A place that cannot be written to is known before a problem is made.
    let store = open(root, &selection.plan.name)?;
    let study = Study::made(selection, root)?;
    let plan = &study.selection.plan;
    let Progress { missing, left_s } = study.progress(store.records());
    let tasks = if args.rerun { study.missing(&HashSet::new()) } else { missing };
    interrupt::listen()?;
    let (all, of_each, missing) = (study.selection.runs(), study.selection.variants.len(), tasks.len());
    let left =
        left_s.filter(|s| *s >= 1.0 && !args.rerun).map_or(String::new(), |s| format!(", about {s:.0} s"));
    say(format_args!(
        "plan {}: {all} runs, {of_each} on each problem; {missing} of {all} runs to make{left}",
        plan.name
    ))?;
    for note in &study.selection.notes {
        say(format_args!("  {note}"))?;
    }
    let how = How { jobs: args.jobs, repeats: args.repeats.unwrap_or(plan.repeats).get() };
    let store = Mutex::new(store);
    let ended = execute(root, &study, &tasks, how, &provenance, &|record| {
        Ok(store.lock().unwrap_or_else(PoisonError::into_inner).append(record)?)
    });
    let store = store.into_inner().unwrap_or_else(PoisonError::into_inner);
    stopped(ended, &study.selection.again)?;
    finish(root, &study, store, &provenance)
}
