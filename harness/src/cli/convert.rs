//! `gravel convert`: contact problems from and to the files of other codes.

use crate::exchange::converted;
use crate::problems::{Kind, Root};
use crate::terminal::{check_place, replaces, write_whole};
use anyhow::Result;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem: its name, or the path of its file; or a file of another code: FCLIB (.hdf5), Siconos (.dat)
    #[arg(value_name = "PROBLEM")]
    from: String,
    /// The file to write: .hdf5 for FCLIB, which other codes read; .json for a problem file, from an FCLIB file that this program
    /// wrote
    #[arg(value_name = "FILE")]
    to: PathBuf,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    check_place(&args.to)?;
    let named = root.all(Kind::Frozen)?.into_iter().find(|path| crate::problems::stem(path) == args.from);
    let from = named.unwrap_or_else(|| PathBuf::from(&args.from));
    let bytes = converted(&from, &args.to)?;
    if replaces(&args.to) {
        eprintln!("replacing {}", args.to.display());
    }
    write_whole(&args.to, &bytes)
}
