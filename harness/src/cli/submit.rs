//! `gravel submit` and `gravel accept`: impulses of another code for a problem of the collection, handed in and judged.

use crate::collection::{Claimed, Collection, Division, FORMAT, Standing, Submission};
use crate::in_one_paragraph;
use crate::problems::Given;
use crate::root::{Root, is_json};
use crate::terminal::{check_apart, exit, prepare_place, replaces, say, write_sealed};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct SubmitArgs {
    /// Impulses that a code found: a file with {"impulse": [N·s, in the problem's contact order]}, as `gravel solve --impulses`
    /// writes it
    impulses: PathBuf,
    /// Id of the problem
    #[arg(long, value_name = "ID")]
    problem: String,
    /// Name of the code
    #[arg(long, value_name = "NAME")]
    code: String,
    /// Version of the code
    #[arg(long, value_name = "VERSION")]
    version: String,
    /// Division: closed is the code with its defaults, open one that was tuned
    #[arg(long, value_enum, default_value = "closed")]
    division: Division,
    /// Method and settings; in the open division also what they were tuned on
    #[arg(long, value_name = "TEXT", default_value = "")]
    how: String,
    /// Time to solve the problem (s), by the code's own clock: it is filed as a claim
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Machine that took this time: processor and threads
    #[arg(long, value_name = "TEXT", default_value = "")]
    machine: String,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Replace FILE if it exists
    #[arg(long)]
    force: bool,
    /// The folder of the collection [default: cases/collection of the checkout]
    #[arg(long = "in", value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

pub(crate) fn submit(root: &Root, args: &SubmitArgs) -> Result<()> {
    let file = args.output.display();
    if replaces(&args.output) && !args.force {
        bail!("{file} exists: give another file, or --force to replace it");
    }
    prepare_place(&args.output)?;
    check_apart(&[("the impulses", args.impulses.as_path()), ("--output", args.output.as_path())])?;
    let collection = Collection::of(root, args.folder.as_deref(), false)?;
    let entry = collection.entry(&args.problem).context("--problem")?;
    let problem = collection.needed(&entry)?;
    let submission = Submission {
        format: FORMAT.to_owned(),
        problem: entry.id,
        code: args.code.clone(),
        version: args.version.clone(),
        division: args.division,
        how: args.how.clone(),
        claimed: Claimed { natural_map: None, seconds: args.seconds, machine: args.machine.clone() },
        verified: None,
        impulse: Given::read(&args.impulses, &problem.posed.facts())?.impulse,
    };
    submission.check()?;
    let found = submission.verify(&problem.posed).with_context(|| args.impulses.display().to_string())?;
    let claimed = Claimed { natural_map: Some(found.natural_map), ..submission.claimed };
    write_sealed(&args.output, &serde_json::to_string(&Submission { claimed, ..submission })?)?;
    let word = if found.certified { "certified" } else { "not certified" };
    say(format_args!("{file}: natural map {:.3e}, {word}", found.natural_map))
}

#[derive(clap::Args)]
pub(crate) struct AcceptArgs {
    /// Submissions, or folders of them
    #[arg(required = true, value_name = "FILE|FOLDER")]
    what: Vec<PathBuf>,
    /// Judge them and file nothing
    #[arg(long)]
    dry_run: bool,
    /// The folder of the collection [default: cases/collection of the checkout]
    #[arg(long = "in", value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

pub(crate) fn accept(root: &Root, args: &AcceptArgs) -> Result<ExitCode> {
    let collection = Collection::of(root, args.folder.as_deref(), false)?;
    let (mut accepted, mut refused) = (0, 0);
    for file in files(&args.what)? {
        if exit::requested() {
            eprintln!("stopped: {accepted} accepted, {refused} refused so far");
            return Ok(exit::code("interrupted"));
        }
        // Another process that accepts would write the entry that this one has read.
        let _alone = collection.alone();
        match one(&collection, &file, args.dry_run) {
            Ok(words) => {
                accepted += 1;
                say(format_args!("accepted {}: {words}", file.display()))?;
            }
            Err(why) => {
                refused += 1;
                say(format_args!("refused {}", in_one_paragraph(&why)))?;
            }
        }
    }
    let filed = if args.dry_run { "; nothing was filed" } else { "" };
    say(format_args!("{accepted} accepted, {refused} refused{filed}"))?;
    Ok(if refused == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Returns the files, those of folders by name.
fn files(what: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in what {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let name = || path.display().to_string();
        let mut inside = Vec::new();
        for entry in std::fs::read_dir(path).with_context(name)? {
            let file = entry.with_context(name)?.path();
            inside.extend((is_json(&file) && file.is_file()).then_some(file));
        }
        if inside.is_empty() {
            bail!("{}: the folder holds no submission, a file that ends in .json or .json.gz", name());
        }
        inside.sort();
        files.extend(inside);
    }
    Ok(files)
}

/// Judges a submission and files it; says what it brought.
fn one(collection: &Collection, file: &Path, dry_run: bool) -> Result<String> {
    let name = || file.display().to_string();
    let submission = Submission::read(file)?;
    let entry = collection.entry(&submission.problem).with_context(|| format!("{}: `problem`", name()))?;
    let problem = collection.needed(&entry).with_context(name)?;
    let answers = collection.answers(&entry.id)?;
    let judged = submission.judged(&entry, &problem, &answers).with_context(name)?;
    let (verified, id) = (judged.verified, &entry.id);
    let mut words = vec![
        id.clone(),
        format!("natural map {:.3e} (verified)", verified.natural_map),
        if verified.certified { "certified".to_owned() } else { "not certified".to_owned() },
    ];
    words.extend(judged.distance.map(|distance| format!("{distance:.1e} from the nearest known solution")));
    words.extend(submission.claimed.seconds.map(|seconds| format!("{seconds} s (claimed)")));
    if collection.file("submissions", &format!("{}.json.gz", submission.name())).is_file() {
        return Ok(words.join(", ") + "; it was filed before");
    }
    let brought =
        judged.better.as_ref().map_or_else(String::new, |(better, _)| brought(entry.known, better.known));
    if !dry_run {
        let _whole = exit::whole();
        if let Some((entry, answers)) = &judged.better {
            collection.write(entry, answers)?;
        }
        submission.file(collection, verified)?;
    }
    Ok(words.join(", ") + &brought)
}

/// Returns what a submission changed of the knowledge of a problem, in words.
fn brought(before: Standing, now: Standing) -> String {
    if before.status != now.status {
        return format!("; the problem was {}, and is {} now", before.status.name(), now.status.name());
    }
    if now.solutions > before.solutions {
        return format!("; a new solution, {} are known", now.solutions);
    }
    "; the least natural map that is known".to_owned()
}
