//! `gravel convert`: contact problems from and to the files of other codes, and grains of a state for another scene.

use crate::cli::args::SceneArgs;
use crate::exchange::{Held, converted, is_foreign, read};
use crate::root::{Root, is_toml};
use crate::terminal::{check_apart, prepare_place, read_text, write_instead};
use anyhow::{Context, Result};
use cases::grains_of_state;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem or a case: its name, or the path of its file; or a file of another code, FCLIB (.hdf5) or Siconos (.dat); or
    /// a state that `simulate --state` wrote
    #[arg(value_name = "PROBLEM-OR-CASE")]
    from: String,
    /// The file to write: .hdf5 for FCLIB, which other codes read; .json for a problem file, from an FCLIB file that this program
    /// wrote; .csv for the grains of a state, which a sample `placed` or `placed-spheres` reads
    #[arg(value_name = "FILE")]
    to: PathBuf,
    #[command(flatten)]
    scene: SceneArgs,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    prepare_place(&args.to)?;
    if args.to.extension().is_some_and(|ending| ending == "csv") {
        let state = Path::new(&args.from);
        args.scene.refused(&format!("{} is asked as a state", state.display()))?;
        check_apart(&[("the state", state), ("FILE", args.to.as_path())])?;
        let grains = grains_of_state(state)
            .context("a .csv gets the grains of a state, which `simulate --state` writes")?;
        return write_instead(&args.to, grains.into_bytes());
    }
    let (from, held) = held(root, args)?;
    check_apart(&[("the problem", from.as_path()), ("FILE", args.to.as_path())])?;
    let bytes = converted(&from, held, &args.to)?;
    write_instead(&args.to, bytes)
}

/// The problem that is asked for, and the file from which it comes.
fn held(root: &Root, args: &Args) -> Result<(PathBuf, Held)> {
    let from = Path::new(&args.from);
    if is_foreign(from) {
        args.scene.refused(&format!("{} is a contact problem", from.display()))?;
        return Ok((from.to_owned(), read(from)?));
    }
    let path = root.problem_or_case(&args.from)?;
    let problem = args.scene.problem(&path)?;
    // The file as it is, where there is one.
    let text = if is_toml(&path) { problem.to_json()? } else { read_text(&path)? };
    Ok((path, Held::Ours(text)))
}
