//! `gravel bench`: the runs of a plan that its store lacks, then tables and a report.

use crate::COMMIT;
use crate::asked::{Asked, StudyArgs};
use crate::execute::{How, execute, few};
use crate::exit;
use crate::inputs::Root;
use crate::interrupt;
use crate::methods::names;
use crate::output::say;
use crate::plan::{MOST_REPEATS, Plan};
use crate::report::say_files;
use crate::simulations;
use crate::study::{Progress, Study};
use crate::tables::{notes, tables};
use anyhow::{Context, Result, anyhow, bail};
use reports::{About, Formats, Wanted, made};
use results::journal::Entry;
use results::schema::Provenance;
use results::store::{Store, StoreError};
use std::collections::HashSet;
use std::num::{NonZeroU32, NonZeroUsize};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Make N different runs at a time: the counts are the same, but seconds are then not taken alone
    #[arg(long, value_name = "N", default_value = "1", value_parser = few)]
    pub(crate) jobs: NonZeroUsize,
    /// Make every run N times, and one before that is not counted; its seconds are medians [default: the plan's
    /// `repeats`, or 1]
    #[arg(long, value_name = "N")]
    pub(crate) repeats: Option<NonZeroU32>,
    /// Make all runs again, those that are there as well; the new rows replace them in the tables
    #[arg(long)]
    pub(crate) rerun: bool,
    /// Begin anew; what was there is kept in a folder named after the time
    #[arg(long, conflicts_with = "rerun")]
    fresh: bool,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    if let Some(repeats) = args.repeats.filter(|repeats| *repeats > MOST_REPEATS) {
        bail!("--repeats {repeats}: it must be at most {MOST_REPEATS}");
    }
    let asked = args.study.asked(root)?;
    if asked.plan.simulate.is_some() {
        return simulations::bench(root, args, asked);
    }
    let provenance = provenance()?;
    begin_anew(root, args, &asked.plan.name)?;
    // A place that cannot be written to is known before a problem is made.
    let store = open(root, &asked.plan.name)?;
    let study = Study::made(asked, root)?;
    let plan = &study.asked.plan;
    let Progress { missing, left_s } = study.progress(store.records());
    let tasks = if args.rerun { study.missing(&HashSet::new()) } else { missing };
    interrupt::listen()?;
    let (all, of_each, missing) = (study.asked.runs(), study.asked.variants.len(), tasks.len());
    let left =
        left_s.filter(|s| *s >= 1.0 && !args.rerun).map_or(String::new(), |s| format!(", about {s:.0} s"));
    say(format_args!(
        "plan {}: {all} runs, {of_each} on each problem; {missing} of {all} runs to make{left}",
        plan.name
    ))?;
    for note in &study.asked.notes {
        say(format_args!("  {note}"))?;
    }
    let how = How { jobs: args.jobs, repeats: args.repeats.unwrap_or(plan.repeats).get() };
    let store = Mutex::new(store);
    let ended = execute(root, &study, &tasks, how, &provenance, &|record| {
        Ok(store.lock().unwrap_or_else(PoisonError::into_inner).append(record)?)
    });
    let store = store.into_inner().unwrap_or_else(PoisonError::into_inner);
    stopped(ended, &study.asked.again)?;
    finish(root, &study, store, &provenance)
}

/// Keeps aside what the store of a plan holds, if asked.
pub(crate) fn begin_anew(root: &Root, args: &Args, plan: &str) -> Result<()> {
    if args.fresh
        && let Some(kept) = Store::set_aside(&runs_folder(root), plan)?
    {
        say(format_args!("what was there is now in {}", kept.display()))?;
    }
    Ok(())
}

/// An error does not lose what ended before it.
pub(crate) fn stopped(ended: Result<()>, again: &str) -> Result<()> {
    ended.with_context(|| format!("stopped; what ended before is kept, `gravel bench {again}` goes on"))
}

/// Where studies are stored.
pub(crate) fn runs_folder(root: &Root) -> PathBuf {
    root.join("results/runs")
}

/// Opens the store of a plan, and says what was lost with a process that was killed.
pub(crate) fn open<R: Entry>(root: &Root, plan: &str) -> Result<Store<R>> {
    let told = |error| match error {
        StoreError::Line { .. } => {
            anyhow!(
                "{error}; take the line out and its run is made again, or `gravel bench --fresh` keeps the file aside and \
                 begins anew"
            )
        }
        error => error.into(),
    };
    let store = Store::open(&runs_folder(root), plan).map_err(told)?;
    store.check_methods(&names()).map_err(told)?;
    if store.dropped() > 0 {
        let folder = store.folder().display();
        eprintln!("{folder}: the last run was not written to its end ({} bytes): dropped", store.dropped());
    }
    Ok(store)
}

/// Makes the tables of a study from its store, and its report if the user did not stop it.
pub(crate) fn finish(
    root: &Root,
    study: &Study,
    mut store: Store,
    provenance: &Provenance,
) -> Result<ExitCode> {
    let tables = tables(root, study, store.records(), provenance)?;
    if interrupt::asked() {
        store.write_tables(&tables)?;
        let missing = study.progress(store.records()).missing.len();
        say(format_args!(
            "stopped; runs missing: {missing}, the others are kept; `gravel bench {}` goes on",
            study.asked.again
        ))?;
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    let Asked { plan, again, .. } = &study.asked;
    let out = root.join("reports/out").join(&plan.name);
    let before = made(&out);
    let formats = Formats::default().and_those_of(&before);
    let wanted = Wanted { charts: &plan.charts(), formats, against: None };
    let about = about(plan, again);
    let (written, drawn) =
        rayon::join(|| store.write_tables(&tables), || reports::report(&tables, &about, wanted, &out));
    // The tables come before the words, which may meet a closed pipe.
    written?;
    say(format_args!("{}", reports::iterations_text(&tables)?))?;
    for note in notes(study, store.records()) {
        say(format_args!("{note}"))?;
    }
    say_files(store.folder(), &out, &drawn?, &before)?;
    Ok(ExitCode::SUCCESS)
}

/// What the page of a study says of it, whose arguments are `again`.
pub(crate) fn about(plan: &Plan, again: &str) -> About {
    // A study that is changed is drawn by its own command alone.
    let drawn_again = again.split_whitespace().skip(1).all(|word| word == "--quick");
    let draw = drawn_again.then(|| again.to_owned());
    About { name: plan.name.clone(), why: plan.why.clone(), bench: again.to_owned(), draw }
}

/// This build, on this machine.
pub(crate) fn provenance() -> Result<Provenance> {
    let rustc = rustc_version_runtime::version().to_string();
    let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
    Ok(Provenance::gather(COMMIT, &rustc, profile, rayon::current_num_threads() as u32)?)
}
