//! `gravel regress` and `gravel bless`: the counts of a plan against those that were accepted.

use crate::cli::args::StudyArgs;
use crate::problems::files::Root;
use crate::store::baseline::{Counts, ExpectedFailure, expected_failures, read, to_csv};
use crate::store::folder::provenance;
use crate::study::problems::OnProblems;
use crate::study::selection::Selection;
use crate::study::tasks::{How, Kind, missing, run_all};
use crate::terminal::interrupt;
use crate::terminal::output::{say, write_whole};
use anyhow::{Context, Result, bail};
use std::collections::{BTreeMap, HashSet};
use std::io;
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
    /// Make N different runs at a time [default: one per processor]; counts do not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

impl Args {
    fn study(&self) -> StudyArgs {
        StudyArgs::plan(&self.plan, self.quick)
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
    let selection = args.study().selection(root)?;
    let baseline = baseline(root, &selection.plan.name);
    if !baseline.is_file() {
        bail!(
            "{}: there is no baseline yet; `gravel bless {}` writes it",
            baseline.display(),
            selection.again
        );
    }
    let before = read(&baseline)?;
    let again = selection.again.clone();
    let now = Now::count(root, args, selection)?;
    let mut wrong = changes(&before, &now.counts);
    wrong.extend(now.unexpected());
    if wrong.is_empty() {
        let runs = now.counts.len();
        say(format_args!("{}: {runs} runs, all as in {}", now.plan, baseline.display()))?;
        return Ok(ExitCode::SUCCESS);
    }
    say_all(&wrong)?;
    say(format_args!(
        "{}: not as in {}; if that is meant, `gravel bless {}` accepts it",
        now.plan,
        baseline.display(),
        again
    ))?;
    Ok(ExitCode::FAILURE)
}

/// Makes the counts the baseline.
pub(crate) fn bless(root: &Root, args: &Args) -> Result<ExitCode> {
    let now = Now::count(root, args, args.study().selection(root)?)?;
    let before = if now.baseline.is_file() { read(&now.baseline)? } else { Vec::new() };
    say_all(&changes(&before, &now.counts))?;
    if let Some(folder) = now.baseline.parent() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    write_whole(&now.baseline, &to_csv(&now.counts)?)?;
    say(format_args!("{}: {} runs, now in {}", now.plan, now.counts.len(), now.baseline.display()))?;
    let unexpected = now.unexpected();
    say_all(&unexpected)?;
    Ok(if unexpected.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

impl Now {
    /// Makes all runs of the plan; nothing is stored.
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
            bail!("stopped before all runs were made: nothing was compared");
        }
        let counts = Counts::of(&tasks, &records.into_inner().unwrap_or_else(PoisonError::into_inner))?;
        Ok(Self { plan, counts, baseline, expected })
    }

    /// Failures that nobody expects, and expected ones that do not come.
    fn unexpected(&self) -> Vec<String> {
        let mut told = Vec::new();
        let mut expected: BTreeMap<&str, &ExpectedFailure> =
            self.expected.iter().map(|failure| (failure.run.as_str(), failure)).collect();
        for counts in &self.counts {
            let (run, status) = (counts.run(), counts.status.as_str());
            match expected.remove(run.as_str()) {
                None if status != "converged" => told.push(format!("unexpected failure: {run}: {status}")),
                Some(failure) if failure.status != status => told.push(format!(
                    "unexpected: {run}: {status}, where {} is expected: {}",
                    failure.status, failure.why
                )),
                _ => {}
            }
        }
        told.extend(expected.keys().map(|run| format!("expected to fail, and not in the plan: {run}")));
        told
    }
}

fn baseline(root: &Root, plan: &str) -> PathBuf {
    root.join("results/baseline").join(format!("{plan}.csv"))
}

fn say_all(lines: &[String]) -> io::Result<()> {
    lines.iter().try_for_each(|line| say(format_args!("{line}")))
}

/// A table of what differs: which run, which count, before, now, their ratio; then runs that came and went.
fn changes(before: &[Counts], now: &[Counts]) -> Vec<String> {
    let by_run = |counts: &[Counts]| -> BTreeMap<String, Counts> {
        counts.iter().map(|counts| (counts.run(), counts.clone())).collect()
    };
    let (before, now) = (by_run(before), by_run(now));
    let mut rows = Vec::new();
    for (run, now) in &now {
        let differences = before.get(run).map(|before| now.differences(before)).unwrap_or_default();
        rows.extend(differences.into_iter().map(|(count, before, now)| {
            let ratio = ratio(&before, &now).map_or(String::new(), |ratio| format!("{ratio:.4}"));
            [run.clone(), count, before, now, ratio]
        }));
    }
    let mut lines = table(&rows);
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
    if rows.is_empty() {
        return Vec::new();
    }
    let head = ["run", "count", "before", "now", "ratio"].map(str::to_owned);
    let all = || std::iter::once(&head).chain(rows);
    let width = |column: usize| all().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(width);
    all()
        .map(|[run, count, before, now, ratio]| {
            format!("{run:<a$}  {count:<b$}  {before:>c$}  {now:>d$}  {ratio:>e$}").trim_end().to_owned()
        })
        .collect()
}
