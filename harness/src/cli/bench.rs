//! `gravel bench`: the runs of a plan that its store lacks, then tables and a report.

use crate::cli::args::StudyArgs;
use crate::plan::checks::MOST_REPEATS;
use crate::problems::files::Root;
use crate::run::execute::few;
use crate::store::folder::{begin_anew, finish, open, provenance, stopped};
use crate::study::selection::Selection;
use crate::study::tasks::{ForKind, How, Kind, by_id, left_s, missing, of_kind, run_all};
use crate::terminal::interrupt;
use crate::terminal::output::say;
use anyhow::{Result, bail};
use results::store::Store;
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
    of_kind(args.study.selection(root)?, Bench { root, args })
}

struct Bench<'a> {
    root: &'a Root,
    args: &'a Args,
}

impl ForKind for Bench<'_> {
    type Output = ExitCode;

    fn of<K: Kind>(self, selection: Selection) -> Result<ExitCode> {
        let Self { root, args } = self;
        let provenance = provenance()?;
        begin_anew(root, args.fresh, &selection.plan.name)?;
        // A place that cannot be written to is known before a problem is made.
        let store: Store<K::Record> = open(root, &selection.plan.name)?;
        let study = K::new(selection, root, true)?;
        let repeats = study.repeats(args.repeats.map(NonZeroU32::get))?;
        let done = if args.rerun { HashSet::new() } else { by_id(store.records()).into_keys().collect() };
        let tasks = missing(&study.tasks()?, &done);
        interrupt::listen()?;
        let left = left_s(&tasks, store.records()).filter(|s| *s >= 1.0 && !args.rerun);
        let Selection { plan, notes, again, .. } = study.selection();
        say(format_args!(
            "plan {}: {}; {} of {} to run{}",
            plan.name,
            study.asks()?,
            tasks.len(),
            study.size()?,
            left.map_or(String::new(), |s| format!(", about {s:.0} s"))
        ))?;
        for note in notes {
            say(format_args!("  {note}"))?;
        }
        let folder = store.folder().to_owned();
        let store = Mutex::new(store);
        let how = How { root, folder: Some(&folder), provenance: &provenance, repeats, jobs: args.jobs };
        let ended = run_all(&study, &tasks, &how, &|record| {
            Ok(store.lock().unwrap_or_else(PoisonError::into_inner).append(record)?)
        });
        stopped(ended, again)?;
        finish(root, &study, store.into_inner().unwrap_or_else(PoisonError::into_inner), &provenance)
    }
}
