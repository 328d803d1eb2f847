//! The folder of a study: opened, gone on with, its tables and report written.

use crate::identity::COMMIT;
use crate::plan::file::Plan;
use crate::plan::methods::names;
use crate::problems::files::Root;
use crate::store::tables::{notes, tables};
use crate::study::runs::Study;
use crate::study::selection::Selection;
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
            study.selection.again
        ))?;
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    let Selection { plan, again, .. } = &study.selection;
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
