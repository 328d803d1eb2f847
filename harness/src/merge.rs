//! `gravel merge`: the runs of other stores of a plan, such as those of another machine, join this one.

use crate::asked::StudyArgs;
use crate::bench::{finish, open};
use crate::inputs::Root;
use crate::output::say;
use anyhow::{Result, bail};
use results::store::{is_study, records_of};
use std::collections::HashSet;
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
    let study = StudyArgs::plan(&args.plan, false).study(root)?;
    let mut stores = Vec::new();
    for folder in &args.from {
        if !is_study(folder) {
            bail!("{}: this folder has no journal.jsonl", folder.display());
        }
        stores.push((folder, records_of(folder)?));
    }
    let mut store = open(root, &study.plan.name)?;
    let mut known: HashSet<String> = store.records().iter().map(|record| record.run.id.clone()).collect();
    for (folder, records) in stores {
        let all = records.len();
        let mut added = 0;
        for record in records {
            // A run that is here keeps its seconds.
            if known.insert(record.run.id.clone()) {
                store.append(record)?;
                added += 1;
            }
        }
        say(format_args!("{}: {added} of {all} runs are new here", folder.display()))?;
    }
    finish(root, &study, store)
}
