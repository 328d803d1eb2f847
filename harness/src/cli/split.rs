//! `gravel split` and `gravel join`: a problem as one file per subdomain, and the impulses of all subdomains as one file.

use crate::cli::args::{SceneArgs, read};
use crate::problems::{Impulses, Problem, write_parts};
use crate::root::Root;
use crate::terminal::{prepare_place, say, write_whole};
use anyhow::{Context, Result, bail};
use partition::{Grid, Scheme};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem or a case: its name, or the path of its file
    #[arg(value_name = "PROBLEM-OR-CASE")]
    pub(crate) problem: String,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Subdomains: a number, or columns x rows such as 8x8
    #[arg(long, value_name = "GRID", value_parser = read::<Grid>)]
    pub(crate) subdomains: Grid,
    /// Rule that distributes the contacts: boxes or balanced
    #[arg(long, value_name = "RULE", default_value = "boxes", value_parser = read::<Scheme>)]
    pub(crate) partition: Scheme,
    /// The folder for the files, one per subdomain, which is made or empty
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Write the reference solution as well, which is kept in results/references, a file per subdomain in FOLDER/solution-0; with
    /// friction each known solution, in solution-0, solution-1, …
    #[arg(long)]
    pub(crate) truth: bool,
}

#[derive(clap::Args)]
pub(crate) struct JoinArgs {
    /// The folder to which `gravel-mpi solve --impulses` wrote
    folder: PathBuf,
    /// The file for the impulses of all, which `gravel certify --impulses` reads
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let path = root.problem_or_case(&args.problem)?;
    let folder = &args.output;
    make_folder(folder)?;
    let Args { subdomains, partition, truth, .. } = args;
    let problem = Problem::alone(args.scene.problem(&path)?, *truth);
    let write = || -> Result<()> {
        let known = problem.known(root)?;
        write_parts(folder, problem.posed.grains()?, &known.impulses, (*subdomains, *partition))
    };
    write().with_context(|| path.display().to_string())?;
    let (name, size) = (&problem.name, problem.posed.facts().size());
    say(format_args!("{name}: {size}, as {} files in {}", subdomains.count(), folder.display()))
}

/// Makes an empty folder.
pub(crate) fn make_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    if fs::read_dir(folder).with_context(|| folder.display().to_string())?.next().is_some() {
        bail!("{}: the folder is not empty", folder.display());
    }
    Ok(())
}

pub(crate) fn join(args: &JoinArgs) -> Result<()> {
    prepare_place(&args.output)?;
    let impulses = Impulses::join_all(&args.folder)?;
    write_whole(&args.output, json!({ "impulse": impulses }).to_string())
}
