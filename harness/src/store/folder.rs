//! The folder of a study: opened, gone on with, its tables and report written.

use crate::identity::COMMIT;
use crate::plan::file::Plan;
use crate::plan::methods::names;
use crate::problems::files::Root;
use crate::store::notes::notes;
use crate::study::selection::Selection;
use crate::study::tasks::{Kind, by_id, missing};
use crate::terminal::output::say;
use crate::terminal::{exit, interrupt};
use anyhow::{Context, Result, anyhow};
use reports::{About, Formats, Wanted, made};
use results::journal::Entry;
use results::schema::Provenance;
use results::store::{Store, StoreError};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Keeps aside what the store of a plan holds, if asked.
pub(crate) fn begin_anew(root: &Root, fresh: bool, plan: &str) -> Result<()> {
    if fresh && let Some(kept) = Store::set_aside(&runs_folder(root), plan)? {
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

/// Writes the tables of a study from its store, and its report if the user did not stop it.
pub(crate) fn finish<K: Kind>(
    root: &Root,
    study: &K,
    mut store: Store<K::Record>,
    provenance: &Provenance,
) -> Result<ExitCode> {
    let Selection { plan, again, .. } = study.selection();
    let tasks = study.tasks()?;
    let known = by_id(store.records());
    let mut ended = Vec::new();
    for task in &tasks {
        ended.extend(known.get(task.id.as_str()).map(|record| (task.clone(), (*record).clone())));
    }
    let rows = study.rows(root, ended, provenance)?;
    if interrupt::asked() {
        let missing = missing(&tasks, &known.into_keys().collect()).len();
        store.write_tables(&rows)?;
        say(format_args!(
            "stopped; {} missing: {missing}, the others are kept; `gravel bench {again}` goes on",
            K::TASKS
        ))?;
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    let notes = notes(study, &tasks, store.records())?;
    let out = root.join("reports/out").join(&plan.name);
    let before = made(&out);
    let formats = Formats::default().and_those_of(&before);
    let wanted = Wanted { charts: &plan.charts(), formats, against: None };
    let about = about(plan, again);
    let (written, drawn) =
        rayon::join(|| store.write_tables(&rows), || reports::report(&rows, &about, wanted, &out));
    // The tables come before the words, which may meet a closed pipe.
    written?;
    say(format_args!("{}", reports::summary(&rows)?))?;
    for note in notes {
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

/// Where the rows and the files of a report are, and which of those that were there `before` it are gone.
pub(crate) fn say_files(stored: &Path, out: &Path, files: &[PathBuf], before: &[String]) -> Result<()> {
    say(format_args!("rows and curves   {}", stored.display()))?;
    say(format_args!("tables and figures {}", out.display()))?;
    for file in files {
        say(format_args!("  {}", file.file_name().unwrap_or_default().to_string_lossy()))?;
    }
    let gone: Vec<&str> =
        before.iter().map(String::as_str).filter(|name| !files.contains(&out.join(name))).collect();
    if !gone.is_empty() {
        say(format_args!("removed, since this report does not make them: {}", gone.join(", ")))?;
    }
    Ok(())
}
