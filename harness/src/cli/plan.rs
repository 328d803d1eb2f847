//! `gravel plan`: the runs of a plan, which of them are made, and how long the others take, with nothing run.

use crate::cli::args::StudyArgs;
use crate::cli::simulations;
use crate::plan::methods::names;
use crate::plan::variants::Variant;
use crate::problems::files::Root;
use crate::problems::planned::PlannedProblem;
use crate::store::folder::runs_folder;
use crate::study::runs::{Progress, Study};
use crate::study::selection::Selection;
use crate::terminal::output::say;
use anyhow::Result;
use indicatif::HumanDuration;
use results::store::records_of;
use std::collections::HashSet;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// The numbers of runs alone
    #[arg(long)]
    count: bool,
}

/// A run of the plan, as it is shown.
pub(crate) struct Row {
    pub(crate) problem: String,
    pub(crate) method: String,
    pub(crate) variant: String,
    pub(crate) done: bool,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let selection = args.study.selection(root)?;
    say(format_args!("plan {}: {}", selection.plan.name, selection.plan.why))?;
    for note in &selection.notes {
        say(format_args!("  {note}"))?;
    }
    let (rows, left_s) = if selection.plan.simulate.is_some() {
        simulations::rows(root, selection)?
    } else {
        rows(root, selection)?
    };
    if !args.count {
        say_runs(&rows)?;
    }
    say_counts(&rows, left_s)
}

/// The runs to be made, and how long the missing ones may take (s).
fn rows(root: &Root, selection: Selection) -> Result<(Vec<Row>, Option<f64>)> {
    let records = records_of(&runs_folder(root).join(&selection.plan.name), &names())?;
    let study = Study::at_hand(selection, root);
    let Progress { missing, left_s } = study.progress(&records);
    let missing: HashSet<(&str, &str, &str)> = missing
        .iter()
        .map(|task| (task.problem.frozen.name.as_str(), task.variant.method.name, task.variant.name.as_str()))
        .collect();
    // A problem that is not made has no run.
    let at_hand: HashSet<&str> = study.problems.iter().map(|problem| problem.frozen.name.as_str()).collect();
    let row = |(problem, variant): (&PlannedProblem, &Variant)| {
        let run = (problem.name.as_str(), variant.method.name, variant.name.as_str());
        let done = at_hand.contains(run.0) && !missing.contains(&run);
        Row { problem: run.0.to_owned(), method: run.1.to_owned(), variant: run.2.to_owned(), done }
    };
    Ok((study.selection.selected().map(row).collect(), left_s))
}

fn say_runs(rows: &[Row]) -> Result<()> {
    let width = rows.iter().map(|row| row.problem.chars().count()).max().unwrap_or(0);
    for Row { problem, method, variant, done } in rows {
        let made = if *done { "done" } else { "" };
        say(format_args!("  {made:<4}  {}", format!("{problem:<width$}  {method} {variant}").trim_end()))?;
    }
    Ok(())
}

/// Runs on each problem, of each method, and in all; those that are made, and all.
fn say_counts(rows: &[Row], left_s: Option<f64>) -> Result<()> {
    let mut counts: Vec<(String, usize, usize)> = Vec::new();
    let on = |row: &Row| format!("on {}", row.problem);
    let of = |row: &Row| format!("of {}", row.method);
    let all = |_: &Row| "in all".to_owned();
    for kind in [&on as &dyn Fn(&Row) -> String, &of, &all] {
        for row in rows {
            let (name, done) = (kind(row), usize::from(row.done));
            match counts.iter_mut().find(|(known, ..)| *known == name) {
                Some((_, made, runs)) => (*made, *runs) = (*made + done, *runs + 1),
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
        say(format_args!("about {left} left on problems that are made, one run at a time"))?;
    }
    Ok(())
}
