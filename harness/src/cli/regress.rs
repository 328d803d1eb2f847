//! `gravel regress` and `gravel bless`: the counts of a plan against those that were accepted.

use crate::cli::args::StudyArgs;
use crate::problems::files::Root;
use crate::store::baseline::{Counts, ExpectedFailure, expected_failures, read, to_csv};
use crate::store::folder::provenance;
use crate::study::problems::OnProblems;
use crate::study::selection::Selection;
use crate::study::tasks::{How, Kind, missing, run_all};
use crate::terminal::interrupt;
use crate::terminal::output::{say, write_kept};
use anyhow::{Result, bail};
use std::collections::{BTreeMap, HashSet};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "regress")]
    plan: String,
    /// The quick form of the plan
    #[arg(long)]
    quick: bool,
    /// Do N runs at a time [default: one per processor]; counts do not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

impl Args {
    fn selection(&self, root: &Root) -> Result<Selection> {
        StudyArgs::plan(&self.plan, self.quick).selection(root)
    }
}

/// The counts of a plan now, and where those that were accepted are.
struct Now {
    plan: String,
    counts: Vec<Counts>,
    baseline: PathBuf,
    expected: Vec<ExpectedFailure>,
}

/// Compares the counts with the baseline.
pub(crate) fn regress(root: &Root, args: &Args) -> Result<ExitCode> {
    let selection = args.selection(root)?;
    let (baseline, again) = (baseline(root, &selection.plan.name), selection.again.clone());
    let file = baseline.display();
    if !baseline.is_file() {
        bail!("{file}: there is no baseline yet; `gravel bless {again}` writes it");
    }
    let before = read(&baseline)?;
    let now = Now::count(root, args, selection)?;
    let wrong = [changes(&before, &now.counts)?, now.unexpected()].concat();
    let (plan, runs) = (&now.plan, now.counts.len());
    if wrong.is_empty() {
        say(format_args!("{plan}: {runs} runs, all as in {file}"))?;
        return Ok(ExitCode::SUCCESS);
    }
    say_all(&wrong)?;
    say(format_args!("{plan}: not as in {file}; if that is meant, `gravel bless {again}` accepts it"))?;
    Ok(ExitCode::FAILURE)
}

/// Makes the counts the baseline.
pub(crate) fn bless(root: &Root, args: &Args) -> Result<ExitCode> {
    let now = Now::count(root, args, args.selection(root)?)?;
    let before = if now.baseline.is_file() { read(&now.baseline)? } else { Vec::new() };
    say_all(&changes(&before, &now.counts)?)?;
    write_kept(&now.baseline, &to_csv(&now.counts)?)?;
    say(format_args!("{}: {} runs, now in {}", now.plan, now.counts.len(), now.baseline.display()))?;
    let unexpected = now.unexpected();
    say_all(&unexpected)?;
    Ok(if unexpected.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

impl Now {
    /// Runs the whole plan; nothing is stored.
    fn count(root: &Root, args: &Args, selection: Selection) -> Result<Self> {
        let study = OnProblems::new(selection, root, true)?;
        let plan = study.selection().plan.name.clone();
        let baseline = baseline(root, &plan);
        let expected = expected_failures(&baseline.with_file_name("expected-failures.toml"), &plan)?;
        let jobs = args.jobs.or_else(|| std::thread::available_parallelism().ok());
        let jobs = jobs.unwrap_or(NonZeroUsize::MIN);
        interrupt::listen()?;
        let records = Mutex::new(Vec::new());
        let (tasks, provenance) = (study.tasks()?, provenance()?);
        let how = How { root, folder: None, provenance: &provenance, repeats: 1, jobs };
        run_all(&study, &missing(&tasks, &HashSet::new()), &how, &|record| {
            records.lock().unwrap_or_else(PoisonError::into_inner).push(record);
            Ok(())
        })?;
        if interrupt::asked() {
            bail!("stopped before all runs had ended: nothing was compared");
        }
        let counts = Counts::of(&tasks, &records.into_inner().unwrap_or_else(PoisonError::into_inner))?;
        Ok(Self { plan, counts, baseline, expected })
    }

    /// Failures that nobody expects, and expected ones that do not come.
    fn unexpected(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let mut expected: BTreeMap<&str, &ExpectedFailure> =
            self.expected.iter().map(|failure| (failure.run.as_str(), failure)).collect();
        for counts in &self.counts {
            let (run, status) = (counts.run(), &counts.status);
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
}

fn baseline(root: &Root, plan: &str) -> PathBuf {
    root.join("results/baseline").join(format!("{plan}.csv"))
}

fn say_all(lines: &[String]) -> Result<()> {
    lines.iter().try_for_each(|line| say(format_args!("{line}")))
}

/// A table of what differs: which run, which count, before, now, their ratio; then runs that came and went.
fn changes(before: &[Counts], now: &[Counts]) -> Result<Vec<String>> {
    let by_run = |counts: &[Counts]| -> BTreeMap<String, Counts> {
        counts.iter().map(|counts| (counts.run(), counts.clone())).collect()
    };
    let (before, now) = (by_run(before), by_run(now));
    let mut rows = vec![["run", "count", "before", "now", "ratio"].map(str::to_owned)];
    for (run, now) in &now {
        for (count, before, now) in
            before.get(run).map_or(Ok(Vec::new()), |before| now.differences(before))?
        {
            let ratio = ratio(&before, &now).map_or(String::new(), |ratio| format!("{ratio:.4}"));
            rows.push([run.clone(), count, before, now, ratio]);
        }
    }
    let mut lines = if rows.len() > 1 { table(&rows) } else { Vec::new() };
    let new = now.keys().filter(|run| !before.contains_key(*run));
    lines.extend(new.map(|run| format!("not in the baseline: {run}")));
    let gone = before.keys().filter(|run| !now.contains_key(*run));
    lines.extend(gone.map(|run| format!("not in the plan: {run}")));
    Ok(lines)
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
