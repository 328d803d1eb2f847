//! `gravel plan`: the runs of a plan, which of them are done, and how long the others take, with nothing run.

use crate::cli::args::StudyArgs;
use crate::root::Root;
use crate::store::{records_of, runs_folder};
use crate::study::{Kind, Listed, OnProblems, Selection, ThroughTime, by_id, left_s, missing};
use crate::terminal::say;
use anyhow::Result;
use indicatif::HumanDuration;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Print the numbers of runs only
    #[arg(long)]
    count: bool,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let selection = args.study.selection(root)?;
    say(format_args!("plan {}: {}", selection.plan.name, selection.plan.why))?;
    for note in &selection.notes {
        say(format_args!("  {note}"))?;
    }
    let (rows, left_s) = all(root, selection)?;
    if !args.count {
        say_runs(&rows)?;
    }
    say_counts(&rows, left_s)
}

/// The number of runs of a plan, those included that others are compared with.
pub(crate) fn runs(root: &Root, selection: Selection) -> Result<usize> {
    all(root, selection).map(|(rows, _)| rows.len())
}

fn all(root: &Root, selection: Selection) -> Result<(Vec<Listed>, Option<f64>)> {
    if selection.plan.through_time() {
        listed::<ThroughTime>(root, selection)
    } else {
        listed::<OnProblems>(root, selection)
    }
}

/// The tasks, and how long the missing ones may take (s).
fn listed<K: Kind>(root: &Root, selection: Selection) -> Result<(Vec<Listed>, Option<f64>)> {
    let folder = runs_folder(root).join(&selection.plan.name);
    let records: Vec<K::Record> = records_of(&folder)?;
    let study = K::new(selection, root, false)?;
    let done = by_id(&records).into_keys().collect();
    let left = left_s(&missing(&study.tasks(), &done), &records);
    Ok((study.listed(&done), left))
}

fn say_runs(rows: &[Listed]) -> Result<()> {
    let width = rows.iter().map(|row| row.problem.chars().count()).max().unwrap_or(0);
    for Listed { problem, method, variant, done } in rows {
        let mark = if *done { "done" } else { "" };
        say(format_args!("  {mark:<4}  {}", format!("{problem:<width$}  {method} {variant}").trim_end()))?;
    }
    Ok(())
}

/// Runs on each problem, of each method, and in all; those that are done, and all.
fn say_counts(rows: &[Listed], left_s: Option<f64>) -> Result<()> {
    let mut counts: Vec<(String, usize, usize)> = Vec::new();
    let on = |row: &Listed| format!("on {}", row.problem);
    let of = |row: &Listed| format!("of {}", row.method);
    let all = |_: &Listed| "in all".to_owned();
    for kind in [&on as &dyn Fn(&Listed) -> String, &of, &all] {
        for row in rows {
            let (name, done) = (kind(row), usize::from(row.done));
            match counts.iter_mut().find(|(known, ..)| *known == name) {
                Some((_, ended, runs)) => (*ended, *runs) = (*ended + done, *runs + 1),
                None => counts.push((name, done, 1)),
            }
        }
    }
    say(format_args!("  {:>7}  {:>7}", "done", "runs"))?;
    for (what, done, runs) in counts {
        say(format_args!("  {done:>7}  {runs:>7}  {what}"))?;
    }
    if let Some(left) = left_s.filter(|s| *s > 0.0) {
        // The others are judged by runs of the same method.
        let left = HumanDuration(Duration::from_secs_f64(left));
        say(format_args!("about {left} left on the problems computed so far, one run at a time"))?;
    }
    Ok(())
}
