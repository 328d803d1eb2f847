//! `gravel-mpi split`: a case as one file per subdomain, of which each rank makes its own.

use crate::cli::split::{Args, make_folder};
use crate::problems::{Enter, MadeOf, Root, Studied, enter, make, replaced};
use crate::run::Posted;
use crate::team::solve::peak_memory_bytes;
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use cases::Case;
use partition::{Scheme, Team};
use std::process::ExitCode;
use std::sync::Arc;

pub(crate) fn run(posted: &Posted, root: &Root, args: &Args) -> Result<ExitCode> {
    let case =
        root.problem_or_case(&args.problem).and_then(|path| Ok((args.scene.case_at_first(&path)?, path)));
    let ((case, overrides), path) = posted.agree(case)?;
    posted.agree(if posted.rank() == 0 { make_folder(&args.output) } else { Ok(()) })?;
    let source = replaced(overrides);
    let in_case = || path.display().to_string();
    enter(&case, Make { posted, args, case: &case, source: &source })?.with_context(in_case)
}

struct Make<'a> {
    posted: &'a Posted,
    args: &'a Args,
    case: &'a Case,
    source: &'a str,
}

impl Enter for Make<'_> {
    type Output = Result<ExitCode>;

    fn enter<M: Studied>(self) -> Result<ExitCode> {
        let Self { posted, args, case, source } = self;
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
        let MadeOf { name, whole, most: [grains, contacts] } =
            make::<M>(&args.output, &parts, &team, grid, source)?;
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
}
