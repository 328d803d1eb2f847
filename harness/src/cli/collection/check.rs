//! `gravel collection check`: all that is stored, recomputed.

use crate::collection::{Collection, checked, orphans, submitted};
use crate::in_one_paragraph;
use crate::terminal::{progress, say};
use anyhow::Result;
use lineup::hash_of;
use serde_json::json;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(super) struct Check {
    /// Check so many problems alone, drawn by the hash of their id and the salt; submissions are all checked
    #[arg(long, value_name = "N")]
    sample: Option<usize>,
    /// Text that draws another sample, such as a commit
    #[arg(long, value_name = "TEXT", default_value = "", requires = "sample")]
    salt: String,
}

impl Check {
    pub(super) fn run(&self, collection: &Collection) -> Result<ExitCode> {
        let mut ids = collection.names("entries")?;
        let mut faults = orphans(collection, &ids)?;
        if let Some(sample) = self.sample {
            ids.sort_by_cached_key(|id| hash_of(&json!([id, self.salt])));
            ids.truncate(sample);
        }
        let mut absent = 0;
        let bar = progress::bar(ids.len() as u64, "problems");
        for id in &ids {
            match checked(collection, id) {
                Ok(true) => {}
                Ok(false) => absent += 1,
                Err(why) => faults.push(format!("{id}: {}", in_one_paragraph(&why))),
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        let submissions = collection.names("submissions")?;
        for name in &submissions {
            faults.extend(
                submitted(collection, name).err().map(|why| format!("{name}: {}", in_one_paragraph(&why))),
            );
        }
        faults.iter().try_for_each(|fault| say(format_args!("{fault}")))?;
        let (all, of) = (ids.len(), submissions.len());
        let absent = if absent > 0 {
            format!(", of which {absent} are not stored and were not made")
        } else {
            String::new()
        };
        say(format_args!("{all} problems{absent}, {of} submissions: {} faults", faults.len()))?;
        Ok(if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}
