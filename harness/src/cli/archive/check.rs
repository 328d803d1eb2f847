//! The check of a packed study, or of archived rows: their checksums, and a share of their runs made again.

use super::pack::{ROWS, unpacked};
use super::{Row, counted};
use crate::cli::args::StudyArgs;
use crate::identity::provenance;
use crate::plan::{Curves, Method, Variant};
use crate::problems::{Known, Problem};
use crate::root::Root;
use crate::run::{Conditions, How, Recorder, Task, Through, ended, ended_row};
use crate::store::{has_tables, problem_of_run, studies_in, tables_of};
use crate::study::{Kind, ThroughTime, run_id};
use crate::terminal::{Bars, exit, progress, say};
use anyhow::{Context, Result, ensure};
use cases::AnyFrozen;
use contact::Measure;
use lineup::hash_of;
use results::journal::{Entry, Record};
use results::schema::Ending;
use results::settings::TIME_STEP;
use results::simulation::Simulated;
use results::study::{Runs, Study as Rows};
use runner::{Measured, Stop};
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(super) struct Check {
    /// A file that `gravel archive` wrote; or a folder of tables, or of such folders, such as results/archive
    #[arg(value_name = "FILE|FOLDER")]
    what: PathBuf,
    /// Share of the runs that are made again, drawn by the hash of their id and the salt (%)
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, value_parser = percent)]
    share: f64,
    /// Text that draws others, such as a commit
    #[arg(long, value_name = "TEXT", default_value = "")]
    salt: String,
    /// Make those alone that this counted budget of a study holds, in the order in which they are drawn: iterations times contacts, of
    /// simulations times grains; a time step before a problem that is not stored counts as 100 iterations
    #[arg(long, value_name = "N")]
    budget: Option<u64>,
}

fn percent(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=100.0).contains(share));
    share.ok_or_else(|| format!("`{text}` is no number from 0 to 100"))
}

/// Record made again, and the id that it has now; none if the user stopped it.
type Again<R> = Option<(R, String)>;

impl Check {
    pub(super) fn run(&self, root: &Root) -> Result<ExitCode> {
        let name = || self.what.display().to_string();
        let folder = tempfile::tempdir().context("a folder for the files of the study")?;
        let mut studies = Vec::new();
        let unpacked_root = if self.what.is_file() {
            unpacked(&self.what, folder.path()).with_context(name)?;
            studies.push(folder.path().join(ROWS));
            Some(Root::find(Some(folder.path().to_owned()))?)
        } else {
            studies = if has_tables(&self.what) { vec![self.what.clone()] } else { studies_in(&self.what)? };
            None
        };
        let mut differ = 0;
        for study in studies {
            differ += self
                .study(unpacked_root.as_ref().unwrap_or(root), &study)
                .with_context(|| study.display().to_string())?;
            if exit::requested() {
                eprintln!("stopped: not all was checked");
                return Ok(exit::code("interrupted"));
            }
        }
        Ok(if differ == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    /// Checks the tables of a study and makes a share of its runs again; returns how many of this code differ.
    fn study(&self, root: &Root, folder: &Path) -> Result<usize> {
        let rows = tables_of(folder)?;
        match &rows {
            Rows::Runs(Runs { records, .. }) => {
                let is_ours = |record: &&Record| {
                    let ended =
                        !matches!(record.run.status, Ending::Skipped | Ending::Given | Ending::Failed);
                    ended && record.run.grains > 0 && record.run.provenance.other_code.is_empty()
                };
                let of: Vec<&Record> = records.iter().filter(is_ours).collect();
                let cost = |record: &Record| {
                    let run = &record.run;
                    let steps = run.problem_settings.get(TIME_STEP).and_then(Value::as_u64).unwrap_or(0);
                    let march = if collected(root, &run.problem_hash).is_some() { 0 } else { 100 * steps };
                    (run.iterations + march) * u64::from(run.contacts)
                };
                self.again(&rows, &of, &cost, &|record| made_again(root, record))
            }
            Rows::Simulations(all) => {
                let of: Vec<&Simulated> = all.iter().collect();
                let plan = all.first().map_or("", |one| &one.simulation.plan);
                let study = ThroughTime::new(
                    StudyArgs::plan(plan.trim_end_matches("-quick"), plan.ends_with("-quick"))
                        .selection(root)?,
                    root,
                    false,
                )?;
                let cost =
                    |one: &Simulated| one.simulation.totals.iterations * u64::from(one.simulation.grains);
                self.again(&rows, &of, &cost, &|one| simulated_again(root, &study, one))
            }
        }
    }

    /// Makes a share of `all` again, with the ids that they have now; says which differ, and returns how many do of the same id: those
    /// of earlier code may.
    fn again<R: Entry>(
        &self,
        rows: &Rows,
        all: &[&R],
        cost: &dyn Fn(&R) -> u64,
        made: &dyn Fn(&R) -> Result<Again<R>>,
    ) -> Result<usize> {
        let mut drawn = all.to_vec();
        drawn.sort_by_cached_key(|record| hash_of(&json!([record.id(), self.salt])));
        drawn.truncate((self.share / 100.0 * all.len() as f64).ceil() as usize);
        let (mut left, mut beyond, mut unmade, mut differ) = (self.budget.unwrap_or(u64::MAX), 0, 0, [0, 0]);
        let bar = progress::bar(drawn.len() as u64, "made again");
        for record in &drawn {
            let price = cost(record);
            if price > left {
                beyond += 1;
                continue;
            }
            left -= price;
            let name = || format!("{} ({})", record.name(), record.id());
            let found = match made(record) {
                Ok(None) => return Ok(differ[1]),
                Ok(Some((again, id))) => difference(*record, &again).map(|found| (found, id == record.id())),
                Err(why) => {
                    unmade += 1;
                    bar.suspend(|| say(format_args!("{}: it is not made again: {why:#}", name())))?;
                    None
                }
            };
            if let Some((found, is_same)) = found {
                differ[usize::from(is_same)] += 1;
                let earlier = if is_same { "" } else { ", of earlier code" };
                bar.suspend(|| say(format_args!("{}{earlier}: {found}", name())))?;
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        let some =
            |count: u32, words: &str| if count > 0 { format!(", {count} {words}") } else { String::new() };
        let left_out = some(beyond, "beyond the budget") + &some(unmade, "not made again");
        let study = Row::all(rows).first().map_or("no rows", |row| row.plan);
        let (all, number, [earlier, same]) = (counted(rows), drawn.len(), differ);
        say(format_args!(
            "{study}: {all}, checksums right; {number} drawn{left_out}; of this code {same} differ, of earlier code {earlier}"
        ))?;
        Ok(same)
    }
}

/// Returns the first count in which two records differ, with both values. A series is measured, not counted.
fn difference<R: Entry>(record: &R, again: &R) -> Option<String> {
    let counts = |of: &R| {
        let all = of.counts().into_iter();
        all.filter(|(name, _)| !name.starts_with("series")).collect::<Vec<_>>()
    };
    let both = counts(record).into_iter().zip(counts(again));
    let mut differ = both.filter(|((_, before), (_, now))| before != now);
    differ.next().map(|((count, before), (_, now))| format!("`{count}` was {before}, and is {now}"))
}

/// Returns the file of a problem that the collection of a checkout holds.
fn collected(root: &Root, hash: &str) -> Option<PathBuf> {
    root.collected(&root.join("cases/collection"), hash)
}

/// Makes a run again; `None` if the user stopped it.
fn made_again(root: &Root, record: &Record) -> Result<Again<Record>> {
    let run = &record.run;
    let frozen = match collected(root, &run.problem_hash) {
        Some(file) => AnyFrozen::read(&file)?,
        None => problem_of_run(root, run)?,
    };
    let (problem, method) = (Problem::alone(frozen, true), Method::new(&run.method, run.settings.clone())?);
    ensure!(
        problem.hash == run.problem_hash,
        "its problem was {}, and is {}",
        run.problem_hash,
        problem.hash
    );
    // The solution changes no count of the others.
    let needs_truth = matches!(run.stop_on.0, Measure::VelocityError | Measure::Zeta)
        || run.status == Ending::FalseConvergence;
    let known = if needs_truth { problem.known(root)? } else { &Known::default() };
    let stop = Stop { on: run.stop_on.0, tolerance: run.tolerance, max_iterations: run.max_iterations };
    let (mut recorder, r0) = (Recorder::new(Curves::Ends), problem.start(run.warm_start));
    let asked = lineup::Run { truths: &known.impulses, r0: &r0, stop: &stop, measured: Measured::Grid };
    let made = ended(&method, &problem, asked, &mut |progress| {
        recorder.observe(progress);
        if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    if exit::requested() {
        return Ok(None);
    }
    let mut outcome = made.outcome;
    outcome.status = known.ending(outcome.status);
    let curve = recorder.finish();
    let run = ended_row(run.clone(), &outcome, &curve);
    let variant = Variant { method, warm_start: run.warm_start, name: String::new(), problems: Vec::new() };
    let id = run_id(&problem.hash, &variant, &stop);
    Ok(Some((Record { run, curve, snapshots: Vec::new() }, id)))
}

/// Makes a simulation again; `None` if the user stopped it.
fn simulated_again(root: &Root, study: &ThroughTime, simulated: &Simulated) -> Result<Again<Simulated>> {
    let one = &simulated.simulation;
    // A setting that came later has its default.
    let settings = Method::new(&one.method, one.settings.clone())?.settings;
    let same = |task: &&Task<Through>| {
        let (what, method) = (&task.what, &task.variant.method);
        let (rule, stop) = (&what.rule, &what.rule.stop);
        let is_same_rule = (stop.on, stop.tolerance, stop.max_iterations)
            == (one.stop_on.0, one.tolerance, one.max_iterations)
            && (one.start.is_empty() || one.start == rule.warm_start.name());
        what.role == one.role
            && what.scene.hash == one.scene_hash
            && what.scene.case.scene.time_step_s == one.time_step_s
            && method.name == one.method
            && method.settings == settings
            && is_same_rule
    };
    let tasks = study.tasks();
    let task = tasks.iter().find(same).context("its plan has no such simulation any more")?;
    let (provenance, bars) = (provenance()?, Bars::new(1));
    let (jobs, measured) = (NonZeroUsize::MIN, Measured::Grid);
    let how = How { root, folder: None, provenance: &provenance, repeats: 1, jobs, measured };
    let made = study.run(task, &Conditions { how: &how, bars: &bars, halt: &exit::requested })?;
    Ok(made.map(|made| (made, task.id.clone())))
}
