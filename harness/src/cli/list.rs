//! `gravel list`: what there is.

use crate::cli::args::StudyArgs;
use crate::cli::keys::takes;
use crate::cli::plan::runs;
use crate::exchange::{Held, read};
use crate::plan::{Entry, External, Plan, methods, wrong};
use crate::root::{Kind, Root, stem};
use crate::terminal::{say, say_table};
use anyhow::{Result, bail};
use cases::{AnyFrozen, Case};
use clap::ValueEnum;
use lineup::Posed;
use rayon::prelude::*;
use reports::Chart;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Kind of item to list
    what: What,
    /// Print a Markdown table, as the READMEs have it; plans with their numbers of runs
    #[arg(long)]
    markdown: bool,
    /// Start each other code, to say which are installed, and in which version (methods alone)
    #[arg(long)]
    installed: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum What {
    /// Cases: scenes that `solve` takes a time step of, and `simulate` all
    Cases,
    /// Problems: the contact problem of one time step, as a file of ours or of another code
    Problems,
    /// Methods, with their settings and defaults
    Methods,
    /// Plans: studies for `bench`
    Plans,
    /// Charts: what a plan may ask for under `charts`, and `gravel figure` draws
    Charts,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    if args.installed && (args.markdown || !matches!(args.what, What::Methods)) {
        bail!("--installed is for `gravel list methods` without --markdown");
    }
    let (headings, rows) = match args.what {
        What::Methods if !args.markdown => return say_methods(args.installed),
        What::Methods => (vec!["method", "is"], methods_in_brief()),
        What::Charts => (vec!["chart", "figures and tables", "shows"], charts()),
        What::Cases => (vec!["case", "is"], cases(root.needed()?)?),
        What::Problems => (vec!["problem", "has", "comes from"], problems(root.needed()?)?),
        What::Plans => (vec!["plan", "asks", "runs"], plans(root.needed()?, args.markdown)?),
    };
    if args.markdown {
        return say_table(&headings, &rows);
    }
    let names = || rows.iter().map(|row| row[0].trim_matches('`'));
    let width = names().map(|name| name.chars().count() + 1).fold(24, usize::max);
    for (name, row) in names().zip(&rows) {
        // The files of a chart matter to who looks for one.
        let words = if matches!(args.what, What::Charts) { &row[2..] } else { &row[1..] };
        say(format_args!("{name:<width$}{}", words.join("; ")))?;
    }
    Ok(())
}

fn code(name: &str) -> String {
    format!("`{name}`")
}

fn methods_in_brief() -> Vec<Vec<String>> {
    methods().map(|entry| vec![code(entry.name()), entry.what().to_owned()]).collect()
}

fn charts() -> Vec<Vec<String>> {
    let row = |chart: &Chart| vec![code(chart.name), chart.makes.to_owned(), chart.shows.to_owned()];
    Chart::all().iter().map(row).collect()
}

fn cases(root: &Root) -> Result<Vec<Vec<String>>> {
    let row = |path| Ok(vec![code(&stem(path)), Case::read(path, &[])?.why]);
    root.all(Kind::Case)?.iter().map(|path| row(path)).collect()
}

fn problems(root: &Root) -> Result<Vec<Vec<String>>> {
    let row = |path: &PathBuf| {
        let frozen = AnyFrozen::read(path)?;
        let source = frozen.source().to_owned();
        Ok(vec![code(&stem(path)), lineup::problem(frozen).facts().size(), source])
    };
    let mut rows = root.all(Kind::Frozen)?.par_iter().map(row).collect::<Result<Vec<_>>>()?;
    for path in root.all(Kind::Foreign)? {
        let Held::Local(problem) = read(&path)? else { continue };
        let size = Posed::W(Box::new(problem)).facts().size();
        rows.push(vec![code(&stem(&path)), size, "another code".to_owned()]);
    }
    Ok(rows)
}

/// Lists the plans, with their numbers of runs if `counted`.
fn plans(root: &Root, counted: bool) -> Result<Vec<Vec<String>>> {
    let mut rows = Vec::new();
    for path in root.all(Kind::Plan)? {
        let name = stem(&path);
        let mut row = vec![code(&name), Plan::why_of(&path)?];
        if counted {
            row.push(runs(root, StudyArgs::plan(&name, false).selection(root)?)?.to_string());
        }
        rows.push(row);
    }
    Ok(rows)
}

fn say_methods(installed: bool) -> Result<()> {
    if installed {
        // Other codes are slow to say their versions: all at once.
        std::thread::scope(|scope| {
            for entry in methods() {
                if let Entry::File(external) = entry {
                    scope.spawn(move || external.version().is_ok());
                }
            }
        });
    }
    for entry in methods() {
        say(format_args!("{:<16}{}", entry.name(), entry.what()))?;
        if let Entry::File(external) = entry {
            say_installed(external, installed)?;
        }
        let settings = entry.settings();
        for (key, default) in entry.defaults()? {
            let default = if default.is_null() { "none".to_owned() } else { default.to_string() };
            let setting = &settings[&key];
            say(format_args!("  {key} = {default}: {}", takes(setting)))?;
            say(format_args!("      {}", setting["description"].as_str().unwrap_or_default()))?;
        }
    }
    wrong().try_for_each(|(name, error)| say(format_args!("{name:<16}not read: {error}")))
}

/// Prints whether another code is installed, if that is `asked`, and the command that installs it.
fn say_installed(external: &External, asked: bool) -> Result<()> {
    let is_there = match asked.then(|| external.version()) {
        Some(Ok(version)) => return say(format_args!("      another code, installed: {version}")),
        Some(Err(why)) => format!("not installed ({why})"),
        None => "`--installed` tells if it is there".to_owned(),
    };
    say(format_args!("      another code, {is_there}; this installs it:"))?;
    say(format_args!("          {}", external.install()))
}
