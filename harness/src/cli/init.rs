//! `gravel init`: a folder of one's own, with a scene, a plan and a code to begin from, that all commands then use.

use crate::terminal::{say, write_kept};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// The folder to make: it must not be there, or be empty
    folder: PathBuf,
}

/// Files of a new folder.
const FILES: [(&str, &str); 7] = [
    ("README.md", include_str!("init/README.md")),
    (".gitignore", "/results\n/reports/out\n"),
    ("cases/my-box.toml", include_str!("init/case.toml")),
    (
        "cases/frozen/README.md",
        "Contact problems: `gravel freeze CASE --time-step K -o cases/frozen/NAME.json`.\n",
    ),
    ("harness/plans/mine.toml", include_str!("init/plan.toml")),
    ("harness/external/mine.toml", include_str!("init/external.toml")),
    ("harness/external/mine.py", include_str!("init/external.py")),
];

pub(crate) fn run(args: &Args) -> Result<()> {
    let folder = &args.folder;
    let entries = folder.exists().then(|| folder.read_dir()).transpose();
    let mut entries = entries.with_context(|| folder.display().to_string())?.into_iter().flatten();
    if let Some(entry) = entries.next() {
        let entry = entry.with_context(|| folder.display().to_string())?.file_name();
        bail!(
            "{}: it holds {}: give a folder that is not there, or is empty",
            folder.display(),
            entry.display()
        );
    }
    for (file, content) in FILES {
        write_kept(&folder.join(file), content)?;
    }
    say(format_args!("{}: a case, a plan and a code of your own", folder.display()))?;
    say(format_args!("    gravel --root {} bench mine", folder.display()))
}
