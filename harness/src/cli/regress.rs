//! `gravel regress` and `gravel bless`: the counts of a plan against those that were accepted.

use crate::cli::args::StudyArgs;
use crate::identity::provenance;
use crate::root::Root;
use crate::run::{How, from_one};
use crate::store::{Counts, ExpectedFailure, baseline_text, expected_failures, read_baseline};
use crate::study::{Kind, OnProblems, Selection, missing, run_all};
use crate::terminal::{exit, say, write_kept};
use anyhow::{Result, bail};
use runner::Measured;
use std::collections::{BTreeMap, HashSet};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "regress")]
    plan: String,
    /// The quick form of the plan
    #[arg(long)]
    quick: bool,
    /// Do N runs at a time [default: one per processor]; counts do not depend on it
    #[arg(long, value_name = "N", value_parser = from_one::<NonZeroUsize>)]
    jobs: Option<NonZeroUsize>,
}

/// Compares the counts with the baseline.
pub(crate) fn regress(root: &Root, args: &Args) -> Result<ExitCode> {
    let selection = args.selection(root)?;
    let (plan, again) = (selection.plan.name.clone(), selection.again.clone());
    let path = baseline(root, &plan);
    let file = path.display();
    if !path.is_file() {
        bail!("{file}: there is no baseline yet; `gravel bless {again}` writes it");
    }
    let before = read_baseline(&path)?;
    let (now, unexpected) = count(root, args, selection)?;
    let _whole = exit::whole();
    let wrong = [changes(&before, &now), unexpected].concat();
    if wrong.is_empty() {
        say(format_args!("{plan}: {} runs, all as in {file}", now.len()))?;
        return Ok(ExitCode::SUCCESS);
    }
    say_all(&wrong)?;
    say(format_args!("{plan}: not as in {file}; if that is meant, `gravel bless {again}` accepts it"))?;
    Ok(ExitCode::FAILURE)
}

/// Accepts the counts as the baseline.
pub(crate) fn bless(root: &Root, args: &Args) -> Result<ExitCode> {
    let selection = args.selection(root)?;
    let plan = selection.plan.name.clone();
    let (now, unexpected) = count(root, args, selection)?;
    let _whole = exit::whole();
    let path = baseline(root, &plan);
    let before = if path.is_file() { read_baseline(&path)? } else { Vec::new() };
    say_all(&changes(&before, &now))?;
    write_kept(&path, &baseline_text(&now)?)?;
    say(format_args!("{plan}: {} runs, now in {}", now.len(), path.display()))?;
    say_all(&unexpected)?;
    Ok(if unexpected.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

impl Args {
    fn selection(&self, root: &Root) -> Result<Selection> {
        let selection = StudyArgs::plan(&self.plan, self.quick).selection(root)?;
        if selection.plan.through_time() {
            bail!("plan `{}` is a study through time: only runs on problems have a baseline", self.plan);
        }
        Ok(selection)
    }
}

/// Runs the whole plan, of which nothing is stored: its counts, and what is unexpected of its failures.
fn count(root: &Root, args: &Args, selection: Selection) -> Result<(Vec<Counts>, Vec<String>)> {
    let study = OnProblems::new(selection, root, true)?;
    let plan = &study.selection().plan.name;
    let expected = expected_failures(&root.join("results/baseline/expected-failures.toml"), plan)?;
    let jobs = args.jobs.or_else(|| std::thread::available_parallelism().ok());
    let jobs = jobs.unwrap_or(NonZeroUsize::MIN);
    let (tasks, provenance, mut records) = (study.tasks(), provenance()?, Vec::new());
    // So that it is exact where measures pass the powers of ten.
    let how =
        How { root, folder: None, provenance: &provenance, repeats: 1, jobs, measured: Measured::Every };
    run_all(&study, &missing(&tasks, &HashSet::new()), &how, |record| {
        records.push(record);
        Ok(())
    })?;
    if exit::requested() {
        bail!("stopped before all runs had ended: nothing was compared");
    }
    let counts = Counts::of(&tasks, &records)?;
    let unexpected = unexpected(&counts, &expected);
    Ok((counts, unexpected))
}

/// Failures that nobody expects, and expected ones that do not come.
fn unexpected(counts: &[Counts], expected: &[ExpectedFailure]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut expected: BTreeMap<&str, &ExpectedFailure> =
        expected.iter().map(|failure| (failure.run.as_str(), failure)).collect();
    for counts in counts {
        let (run, status) = (counts.run(), counts.status());
        match expected.remove(run.as_str()) {
            None if status != "converged" => lines.push(format!("unexpected failure: {run}: {status}")),
            Some(ExpectedFailure { status: failure, why, .. }) if failure != status => {
                lines.push(format!("unexpected: {run}: {status}, where {failure} is expected: {why}"));
            }
            _ => {}
        }
    }
    lines.extend(expected.keys().map(|run| format!("expected to fail, and not in the plan: {run}")));
    lines
}

fn baseline(root: &Root, plan: &str) -> PathBuf {
    root.join("results/baseline").join(format!("{plan}.csv"))
}

fn say_all(lines: &[String]) -> Result<()> {
    lines.iter().try_for_each(|line| say(format_args!("{line}")))
}

/// A table of what differs: which run, which count, before, now, their ratio; then runs that came and went.
fn changes(before: &[Counts], now: &[Counts]) -> Vec<String> {
    let by_run = |counts: &[Counts]| -> BTreeMap<String, Counts> {
        counts.iter().map(|counts| (counts.run(), counts.clone())).collect()
    };
    let (before, now) = (by_run(before), by_run(now));
    let mut rows = vec![["run", "count", "before", "now", "ratio"].map(str::to_owned)];
    for (run, now) in &now {
        for [count, before, now] in before.get(run).map_or(Vec::new(), |before| now.differences(before)) {
            let ratio = ratio(&before, &now).map_or(String::new(), |ratio| format!("{ratio:.4}"));
            rows.push([run.clone(), count, before, now, ratio]);
        }
    }
    let mut lines = if rows.len() > 1 { table(&rows) } else { Vec::new() };
    let new = now.keys().filter(|run| !before.contains_key(*run));
    lines.extend(new.map(|run| format!("not in the baseline: {run}")));
    let gone = before.keys().filter(|run| !now.contains_key(*run));
    lines.extend(gone.map(|run| format!("not in the plan: {run}")));
    lines
}

fn ratio(before: &str, now: &str) -> Option<f64> {
    let (before, now): (u64, u64) = (before.parse().ok()?, now.parse().ok()?);
    (before > 0).then(|| now as f64 / before as f64)
}

fn table(rows: &[[String; 5]]) -> Vec<String> {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(width);
    let line = |[run, count, before, now, ratio]: &[String; 5]| {
        format!("{run:<a$}  {count:<b$}  {before:>c$}  {now:>d$}  {ratio:>e$}").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}
