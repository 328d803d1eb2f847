//! `gravel collection`: problems with ids, and what is known of their solutions.

mod check;
mod list;
mod make;
mod seek;

use crate::collection::{About, Collection, Entry, Foreign, State, Submission, distance};
use crate::exchange::is_foreign;
use crate::problems::Problem;
use crate::root::{Kind, Root};
use crate::terminal::{is_one_file, say};
use anyhow::{Context, Result};
use cases::AnyFrozen;
use check::Check;
use lineup::Posed;
use list::List;
use make::Make;
use seek::Seek;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// The folder of the collection [default: cases/collection of the checkout]
    #[arg(long = "in", global = true, value_name = "FOLDER")]
    folder: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// List the problems: id, size, state, status; or how many there are of each kind
    List(List),
    /// Show all that is known of a problem, and what codes have submitted
    Show {
        /// Id of the problem
        id: String,
    },
    /// Add problems: files of ours are stored; of files of other codes hash and size
    Add(Add),
    /// Make the problems of a recipe that are not there yet, and solve them; or the file of a problem that is not stored
    Make(Make),
    /// Seek solutions of open problems, with the present methods, and keep any better answer
    Seek(Seek),
    /// Check that every problem is the one of its id, that every status is right, and every submission what it says
    Check(Check),
}

#[derive(clap::Args)]
struct Add {
    /// Files of problems
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    /// State of the packing
    #[arg(long, value_enum, default_value = "other")]
    state: State,
    /// Licence of the data, an SPDX identifier
    #[arg(long, default_value = "CC-BY-4.0")]
    licence: String,
    /// Origin of files of other codes, in a sentence
    #[arg(long, value_name = "TEXT")]
    origin: Option<String>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let may_be_new = matches!(args.command, Command::Add(_) | Command::Make(_));
    let collection = Collection::of(root, args.folder.as_deref(), may_be_new)?;
    match &args.command {
        Command::List(list) => list.run(&collection)?,
        Command::Show { id } => show(&collection, id)?,
        Command::Add(add) => add.run(root, &collection)?,
        Command::Make(make) => make.run(root, &collection, args.folder.is_some())?,
        Command::Seek(seek) => seek.run(&collection)?,
        Command::Check(check) => return check.run(&collection),
    }
    Ok(ExitCode::SUCCESS)
}

/// Returns kind, size, friction and state in words.
fn size(entry: &Entry) -> String {
    let Entry { mechanics, grains, contacts, friction: [least, greatest], state, .. } = entry;
    let grains = if *grains > 0 { format!("{grains} grains, ") } else { "W alone, ".to_owned() };
    let mu = if least == greatest { format!("{greatest}") } else { format!("{least} to {greatest}") };
    format!("{mechanics}, {grains}{contacts} contacts, μ {mu}, {}", state.name())
}

fn show(collection: &Collection, id: &str) -> Result<()> {
    let entry = collection.entry(id)?;
    let known = entry.known;
    say(format_args!("{}: {}", entry.name, size(&entry)))?;
    say(format_args!("origin: {}", entry.origin))?;
    say(format_args!("licence: {}", entry.licence))?;
    if let Some(Foreign { file, sha256, bytes }) = &entry.foreign {
        say(format_args!("file: {file}, {bytes} bytes, sha256 {sha256}"))?;
    }
    say(format_args!("status: {}, by {}: {}", known.status.name(), entry.by, entry.how))?;
    if let Some(natural_map) = known.natural_map {
        say(format_args!("  least natural map {natural_map:.2e}, {} certified", known.solutions))?;
    }
    if let Some(spread) = known.spread {
        say(format_args!("  spread of the solutions in velocity: {spread:.2e}"))?;
    }
    let (problem, place) = (collection.problem(&entry)?, collection.place(&entry));
    match place {
        Some(place) => say(format_args!("at {}", place.display()))?,
        None => say(format_args!("its file is not here: `gravel collection make {id}` makes it"))?,
    }
    let answers = collection.answers(id)?;
    for name in collection.names("submissions")?.iter().filter(|name| name.starts_with(id)) {
        let file = collection.file("submissions", &format!("{name}.json.gz"));
        let submission = Submission::read(&file)?;
        let Some(verified) = submission.verified else { continue };
        let apart = match problem.as_ref().map(|problem| &problem.posed) {
            Some(Posed::Grains(grains)) => distance(&**grains, &answers, &submission.impulse),
            _ => None,
        };
        let apart =
            apart.map_or_else(String::new, |apart| format!(", {apart:.1e} from the nearest solution"));
        let certified = if verified.certified { ", certified" } else { "" };
        let seconds = submission.claimed.seconds.map_or_else(String::new, |s| format!("; claimed: {s} s"));
        say(format_args!(
            "{} {}, {} division: natural map {:.2e} (verified){certified}{apart}{seconds}",
            submission.code,
            submission.version,
            submission.division.name(),
            verified.natural_map
        ))?;
    }
    Ok(())
}

impl Add {
    fn run(&self, root: &Root, collection: &Collection) -> Result<()> {
        let about = About { state: self.state, licence: self.licence.clone() };
        for file in &self.files {
            let file = &root.any_problem(file)?;
            let entry = if is_foreign(file) {
                let problem = Problem::foreign(file)?;
                let origin = self.origin.clone();
                let origin = origin.context("--origin: say where the files of another code come from")?;
                let (mut entry, answers) = about.entry(collection, &problem, origin)?;
                entry.foreign = Some(Foreign::of(file)?);
                collection.write(&entry, &answers)?;
                entry
            } else {
                // One that is a frozen problem already is not stored twice.
                let frozen = root.all(Kind::Frozen)?.iter().any(|known| is_one_file(known, file));
                about.add(collection, AnyFrozen::read(file)?, None, !frozen)?
            };
            say(format_args!("{} {}: {}", entry.id, entry.name, entry.known.status.name()))?;
        }
        Ok(())
    }
}
