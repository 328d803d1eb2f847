//! `gravel collection seek`: solutions of open problems, with the present methods.

use crate::collection::{Collection, Entry, Status, sought};
use crate::terminal::say;
use anyhow::{Context, Result, ensure};

#[derive(clap::Args)]
pub(super) struct Seek {
    /// Ids of open problems [default: all that are stored]
    ids: Vec<String>,
}

impl Seek {
    /// Seeks solutions of one problem after the other, and writes each as it is found.
    pub(super) fn run(&self, collection: &Collection) -> Result<()> {
        let mut entries = collection.entries()?;
        if self.ids.is_empty() {
            entries.retain(|entry| entry.known.status == Status::Open && collection.place(entry).is_some());
        } else {
            entries = self.ids.iter().map(|id| collection.entry(id)).collect::<Result<_>>()?;
        }
        for entry in &entries {
            let Entry { id, name, known, .. } = entry;
            let status = known.status.name();
            ensure!(
                known.status == Status::Open,
                "{id} {name}: it is {status}; only open problems are sought"
            );
        }
        let mut better = 0;
        for entry in &entries {
            better += usize::from(seek(collection, entry)?);
        }
        say(format_args!("better answers to {better} of {} open problems", entries.len()))
    }
}

/// Seeks solutions of an open problem, and keeps a better answer. Returns whether there is one.
fn seek(collection: &Collection, entry: &Entry) -> Result<bool> {
    let problem = collection.needed(entry)?;
    let (answers, how) = sought(&problem)?;
    let found = answers.standing(&problem.posed).with_context(|| entry.name.clone())?;
    // Others may have found more since.
    let _alone = collection.alone();
    let entry = collection.entry(&entry.id)?;
    let is_better = found.is_better(&entry.known);
    let left = found.natural_map.map_or_else(String::new, |left| format!(", natural map {left:.2e}"));
    let than = if is_better { "" } else { ", no better than what is known" };
    say(format_args!("{} {}: {}{left}{than}", entry.id, entry.name, found.status.name()))?;
    if is_better {
        collection.write(&Entry { known: found, how, by: Entry::by_this(), ..entry }, &answers)?;
    }
    Ok(is_better)
}
