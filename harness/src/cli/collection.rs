//! `gravel collection`: problems with ids, and what is known of their solutions.

use crate::collection::{
    About, Collection, Entry, Foreign, Recipe, Standing, State, Status, Submission, checked, distance,
    orphans, submitted,
};
use crate::exchange::is_foreign;
use crate::in_one_paragraph;
use crate::plan::key_value;
use crate::problems::{CaseProblem, Problem};
use crate::root::{Kind, Root};
use crate::terminal::{is_one_file, progress, read_text, say, say_table};
use anyhow::{Context, Result, bail, ensure};
use cases::AnyFrozen;
use lineup::{Posed, content_hash, hash_of};
use results::median;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use wildmatch::WildMatch;

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
    /// Check that every problem is the one of its id, that every status is right, and every submission what it says
    Check(Check),
}

#[derive(clap::Args)]
struct List {
    /// Only problems with this name, mechanics, state, status, grains or friction (the greatest μ), such as mechanics=rough*; may be
    /// repeated: a problem must match all
    #[arg(long, value_name = "KEY=PATTERN", value_parser = key_value)]
    only: Vec<(String, String)>,
    /// Print ids alone: of a hidden collection they may be published, and promise what it holds
    #[arg(long, conflicts_with_all = ["summary", "spread"])]
    ids: bool,
    /// Print a Markdown table of the numbers of problems of each mechanics, size and state, by status
    #[arg(long, conflicts_with = "spread")]
    summary: bool,
    /// Print a Markdown table of how far apart in velocity the known solutions with friction are, by mechanics, state and μ
    #[arg(long)]
    spread: bool,
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

#[derive(clap::Args)]
struct Make {
    /// A recipe file; or the id of a problem that is not stored, whose file is made in results/problems
    #[arg(value_name = "RECIPE|ID")]
    what: String,
    /// Seeds of the samples in place of the recipe's, one a line, for a hidden collection; needs --in
    #[arg(long, value_name = "FILE")]
    seeds_from: Option<PathBuf>,
}

#[derive(clap::Args)]
struct Check {
    /// Check so many problems alone, drawn by the hash of their id and the salt; submissions are all checked
    #[arg(long, value_name = "N")]
    sample: Option<usize>,
    /// Text that draws another sample, such as a commit
    #[arg(long, value_name = "TEXT", default_value = "", requires = "sample")]
    salt: String,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let may_be_new = matches!(args.command, Command::Add(_) | Command::Make(_));
    let collection = Collection::of(root, args.folder.as_deref(), may_be_new)?;
    match &args.command {
        Command::List(list) => list.run(&collection)?,
        Command::Show { id } => show(&collection, id)?,
        Command::Add(add) => add.run(root, &collection)?,
        Command::Make(make) => make.run(root, &collection, args.folder.is_some())?,
        Command::Check(check) => return check.run(&collection),
    }
    Ok(ExitCode::SUCCESS)
}

impl List {
    fn run(&self, collection: &Collection) -> Result<()> {
        let mut entries = collection.entries()?;
        for (key, pattern) in &self.only {
            let pattern = WildMatch::new(pattern);
            ensure!(KEYS.contains(&key.as_str()), "--only {key}: there is {}", KEYS.join(", "));
            entries.retain(|entry| pattern.matches(&value(entry, key)));
        }
        if self.ids {
            return entries.iter().try_for_each(|entry| say(format_args!("{}", entry.id)));
        }
        if self.summary {
            return summary(&entries);
        }
        if self.spread {
            return spread(&entries);
        }
        for entry in &entries {
            say(format_args!(
                "{}  {:<11} {}; {}",
                entry.id,
                entry.known.status.name(),
                size(entry),
                entry.name
            ))?;
        }
        let of = |status| entries.iter().filter(|entry| entry.known.status == status).count();
        let counts = Status::ALL.map(|status| format!("{} {}", of(status), status.name()));
        say(format_args!("{} problems: {}", entries.len(), counts.join(", ")))
    }
}

/// Keys by which problems are listed.
const KEYS: [&str; 6] = ["name", "mechanics", "state", "status", "grains", "friction"];

fn value(entry: &Entry, key: &str) -> String {
    match key {
        "name" => entry.name.clone(),
        "mechanics" => entry.mechanics.clone(),
        "state" => entry.state.name().to_owned(),
        "status" => entry.known.status.name().to_owned(),
        "grains" => entry.grains.to_string(),
        _ => entry.friction[1].to_string(),
    }
}

/// Returns kind, size, friction and state in words.
fn size(entry: &Entry) -> String {
    let Entry { mechanics, grains, contacts, friction: [least, greatest], state, .. } = entry;
    let grains = if *grains > 0 { format!("{grains} grains, ") } else { "W alone, ".to_owned() };
    let mu = if least == greatest { format!("{greatest}") } else { format!("{least} to {greatest}") };
    format!("{mechanics}, {grains}{contacts} contacts, μ {mu}, {}", state.name())
}

/// Prints the numbers of problems of each mechanics, size and state, by status.
fn summary(entries: &[Entry]) -> Result<()> {
    let mut groups: BTreeMap<(&str, usize, State), [usize; Status::ALL.len()]> = BTreeMap::new();
    for entry in entries {
        let group = groups.entry((&entry.mechanics, entry.grains, entry.state)).or_default();
        let status = Status::ALL.iter().position(|status| *status == entry.known.status);
        group[status.unwrap_or(0)] += 1;
    }
    let row = |head: [String; 3], counts: &[usize; Status::ALL.len()]| {
        let all: usize = counts.iter().sum();
        head.into_iter().chain([all.to_string()]).chain(counts.iter().map(usize::to_string)).collect()
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut total = [0; Status::ALL.len()];
    for ((mechanics, grains, state), counts) in &groups {
        rows.push(row([(*mechanics).to_owned(), grains.to_string(), state.name().to_owned()], counts));
        total.iter_mut().zip(counts).for_each(|(total, count)| *total += count);
    }
    rows.push(row(["all".to_owned(), String::new(), String::new()], &total));
    let headings =
        [&["mechanics", "grains", "state", "problems"][..], &Status::ALL.map(Status::name)].concat();
    say_table(&headings, &rows)
}

/// Prints the spread of the solutions of problems with one μ, by mechanics, state and μ: the least, the median and the greatest of those with
/// several.
fn spread(entries: &[Entry]) -> Result<()> {
    let mut groups: BTreeMap<(&str, State, String), Vec<&Standing>> = BTreeMap::new();
    for Entry { mechanics, grains, state, friction: [least, greatest], known, .. } in entries {
        if *grains > 0 && least == greatest && *greatest > 0.0 {
            groups.entry((mechanics, *state, greatest.to_string())).or_default().push(known);
        }
    }
    let row = |((mechanics, state, friction), known): (&(&str, State, String), &Vec<&Standing>)| {
        let of = |least: usize| known.iter().filter(|known| known.solutions >= least).count().to_string();
        let spreads: Vec<f64> = known.iter().filter_map(|known| known.spread).collect();
        let text = |spread: Option<f64>| spread.map_or_else(String::new, |spread| format!("{spread:.1e}"));
        let [least, greatest] = [f64::min, f64::max].map(|of| text(spreads.iter().copied().reduce(of)));
        let [mechanics, state] = [*mechanics, state.name()].map(str::to_owned);
        let counts = [known.len().to_string(), of(1), of(2)];
        [[mechanics, state, friction.clone()], counts, [least, text(median(spreads)), greatest]].concat()
    };
    let rows: Vec<Vec<String>> = groups.iter().map(row).collect();
    say_table(
        &[
            "mechanics",
            "state",
            "μ",
            "problems",
            "with a solution",
            "several",
            "least spread",
            "median",
            "greatest",
        ],
        &rows,
    )
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

impl Make {
    fn run(&self, root: &Root, collection: &Collection, elsewhere: bool) -> Result<()> {
        let path = PathBuf::from(&self.what);
        if self.seeds_from.is_none() && !path.is_file() {
            return again(root, collection, &self.what);
        }
        let mut recipe = Recipe::read(&path)?;
        if let Some(file) = &self.seeds_from {
            ensure!(
                elsewhere,
                "--seeds-from: secret seeds make a hidden collection: name its folder by --in"
            );
            recipe = recipe.seeded(&seeds(file)?);
        }
        let [made, there] = recipe.make(root, collection)?;
        say(format_args!("{made} problems made, {there} were there"))
    }
}

/// Reads seeds, one a line.
fn seeds(file: &Path) -> Result<Vec<u64>> {
    let text = read_text(file)?;
    let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let seed = |(k, line): (usize, &str)| {
        let name =
            || format!("{}: line {k} is {line:?}: it must be a whole number, not negative", file.display());
        line.trim().parse().with_context(name)
    };
    let seeds = lines.map(seed).collect::<Result<Vec<u64>>>()?;
    ensure!(!seeds.is_empty(), "{}: it holds no seed, one a line", file.display());
    Ok(seeds)
}

/// Makes the file of a problem that is not stored.
fn again(root: &Root, collection: &Collection, id: &str) -> Result<()> {
    let entry = collection.entry(id).with_context(|| format!("{id} is no file of a recipe, and no id"))?;
    if let Some(place) = collection.place(&entry) {
        return say(format_args!("{} is there", place.display()));
    }
    let Some(made) = &entry.made else {
        let file =
            entry.foreign.map(|foreign| format!(": it is {}, sha256 {}", foreign.file, foreign.sha256));
        bail!("{id} has no recipe{}", file.unwrap_or_default());
    };
    let case = made.case(root)?;
    let (method, stop) = case.before()?;
    let how = CaseProblem::solved_by(&method, &stop);
    let mut frozen = case.marched(&method, &stop, &how, &|| false)?;
    frozen.rename(&entry.name);
    let found = content_hash(&*lineup::problem(frozen.clone()));
    ensure!(
        found == id,
        "{id}: its recipe makes a problem with the hash {found}: the code that marches has changed since"
    );
    collection.write_problem(id, &frozen, false)?;
    say(format_args!("{id} {}: made", entry.name))
}

impl Check {
    fn run(&self, collection: &Collection) -> Result<ExitCode> {
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
