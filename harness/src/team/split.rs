//! `gravel-mpi split`: a case as one file per subdomain, of which each rank makes its own.

use crate::cli::args::SceneArgs;
use crate::cli::split::{Args, make_folder};
use crate::problems::case::replaced;
use crate::problems::parts::write_part;
use crate::root::{Root, is_toml};
use crate::team::share::Posted;
use crate::team::solve::peak_memory_bytes;
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use cases::Case;
use lineup::{MadeOf, make};
use partition::{Scheme, Team};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

pub(crate) fn run(posted: &Posted, root: &Root, args: &Args) -> Result<ExitCode> {
    let case = root.problem_or_case(&args.problem).and_then(|path| Ok((at_first(&args.scene, &path)?, path)));
    let (case, path) = posted.agree(case)?;
    posted.agree(if posted.rank() == 0 { make_folder(&args.output) } else { Ok(()) })?;
    made(posted, args, &case).with_context(|| path.display().to_string())
}

/// The case of a file, of which time step 1 is asked.
fn at_first(args: &SceneArgs, path: &Path) -> Result<Case> {
    if !is_toml(path) {
        bail!("{}: it is a frozen problem, which `gravel split` splits", path.display());
    }
    let case = Case::read(path, &args.case.overrides)?;
    let time_step = args.time_step.clone().unwrap_or_else(|| case.solve_at.to_string());
    if time_step != "1" {
        bail!("--time-step {time_step}: it must be 1 where ranks make a problem, before anything has moved");
    }
    Ok(case)
}

fn made(posted: &Posted, args: &Args, case: &Case) -> Result<ExitCode> {
    let (parts, grid) = (case.in_parts()?, args.subdomains);
    if args.truth {
        bail!("--truth: no rank holds the whole problem, which has to be solved for that");
    }
    if args.partition != Scheme::Boxes {
        bail!("--partition: it must be boxes where ranks make a problem");
    }
    if (grid.nx, grid.nz) != (parts.count(), 1) {
        let count = parts.count();
        bail!(
            "--subdomains {grid}: it must have a column for each of the {count} of `sample.strips`, in one layer"
        );
    }
    let team = Team::new(Arc::clone(&posted.0), parts.count() as usize)?;
    let source = replaced(&args.scene.case.overrides);
    let write = &mut |part: &_, alone| write_part(&args.output, part, &alone);
    let MadeOf { name, whole, most: [grains, contacts] } =
        make(&parts, case.scene.is_rough(), &team, grid, &source, write)?;
    let memory = team.max(peak_memory_bytes().unwrap_or(0.0)) / 1e6;
    if posted.rank() == 0 {
        say(format_args!(
            "{name}: {} grains, {} contacts, as {} files in {}",
            whole.grains,
            whole.contacts,
            grid.count(),
            args.output.display()
        ))?;
        say(format_args!(
            "  no rank held more than {grains} grains, {contacts} contacts and {memory:.0} MB"
        ))?;
    }
    Ok(ExitCode::SUCCESS)
}
