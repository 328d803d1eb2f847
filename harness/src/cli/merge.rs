//! `gravel merge`: the runs of other stores of a plan, such as those of another machine, join this one.

use crate::cli::args::StudyArgs;
use crate::root::Root;
use crate::store::{finish, open, records_of};
use crate::study::{Kind, OnProblems, Selection, ThroughTime};
use crate::terminal::say;
use anyhow::{Result, bail};
use results::journal::Entry;
use results::store::{Store, is_study};
use std::collections::{BTreeMap, HashSet};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// The plan whose store grows: its name, or the path of its file
    plan: String,
    /// Folders with a journal.jsonl, such as a copy of another machine's results/runs/PLAN
    #[arg(required = true, value_name = "FROM")]
    from: Vec<PathBuf>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let selection = StudyArgs::plan(&args.plan, false).selection(root)?;
    if selection.plan.through_time() {
        merge::<ThroughTime>(root, args, selection)
    } else {
        merge::<OnProblems>(root, args, selection)
    }
}

fn merge<K: Kind>(root: &Root, args: &Args, selection: Selection) -> Result<ExitCode> {
    let store = joined(root, &selection.plan.name, &args.from)?;
    finish(root, &K::new(selection, root, true)?, store)
}

/// The store of a plan with what those in the folders `from` hold beside it.
fn joined<R: Entry>(root: &Root, plan: &str, from: &[PathBuf]) -> Result<Store<R>> {
    let mut stores = Vec::new();
    for folder in from {
        if !is_study(folder) {
            bail!("{}: this folder has no journal.jsonl", folder.display());
        }
        stores.push((folder, records_of::<R>(folder)?));
    }
    let mut store = open(root, plan)?;
    refuse_other_counts(store.records(), &stores, plan)?;
    let mut known: HashSet<String> =
        store.records().iter().map(|record: &R| record.id().to_owned()).collect();
    for (folder, records) in stores {
        let all = records.len();
        let mut added = 0;
        for record in records {
            // A run that is here keeps its seconds.
            if known.insert(record.id().to_owned()) {
                store.append(record)?;
                added += 1;
            }
        }
        say(format_args!("{}: {added} of {all} runs are new here", folder.display()))?;
    }
    Ok(store)
}

/// Greatest number of differing runs that an error names.
const NAMED: usize = 5;

/// Refuses runs of one id that counted different work: the machines that ran them disagree, and a table must not mix them.
/// Of two runs of one id in one store, the later counts.
fn refuse_other_counts<R: Entry>(ours: &[R], stores: &[(&PathBuf, Vec<R>)], plan: &str) -> Result<()> {
    let mut known: BTreeMap<&str, &R> = ours.iter().map(|record| (record.id(), record)).collect();
    let mut differ = Vec::new();
    for (folder, records) in stores {
        let theirs: BTreeMap<&str, &R> = records.iter().map(|record| (record.id(), record)).collect();
        for (id, record) in theirs {
            let before = *known.entry(id).or_insert(record);
            if let Some((count, here, there)) = before.difference(record) {
                let folder = folder.display();
                differ.push(format!(
                    "run {id} ({}) has {count} {here} here and {there} in {folder}",
                    record.name()
                ));
            }
        }
    }
    if differ.is_empty() {
        return Ok(());
    }
    let more = differ.len().saturating_sub(NAMED);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    differ.truncate(NAMED);
    bail!(
        "{}{more}. The same id must mean the same counts, so a machine or a build is wrong. Nothing was merged; `gravel \
         bench {plan} --rerun` on each shows which counts repeat",
        differ.join("; ")
    )
}
