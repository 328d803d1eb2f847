//! A study in `results/runs`, found by its plan, and a run of any, found by its id.

use crate::plan::{Marcher, Plan, as_typed};
use crate::problems::KeptProblem;
use crate::root::Root;
use crate::store::runs_folder;
use anyhow::{Context, Result, bail};
use cases::AnyFrozen;
use lineup::content_hash;
use results::error::StoreError;
use results::journal::{Record, Texts, entry};
use results::schema::{Ending, Run};
use results::settings::{CASE, MARCH, MISSED_BEFORE, MOMENT, TIME_STEP};
use results::simulation::Simulated;
use results::store::{journals, tables_folder};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Runs found, by id: name and record; a simulation has no record. Of two runs of one id the later, but one with iterates
/// before one without.
type Found = BTreeMap<String, (String, Option<Record>)>;

/// Returns the folder of the newest study of a plan.
pub(crate) fn stored(root: &Root, plan: &Plan) -> Result<PathBuf> {
    let runs = runs_folder(root);
    tables_folder(&runs, &plan.name).with_context(|| {
        let quick = tables_folder(&runs, &format!("{}-quick", plan.name));
        let quick = if quick.is_some() { "; its quick form is: add --quick" } else { "" };
        let runs = runs.display();
        format!("no study of plan `{0}` is stored in {runs}{quick}: `gravel bench {0}` runs it", plan.name)
    })
}

/// The run whose id begins with `begin`.
pub(crate) fn stored_run(root: &Root, begin: &str) -> Result<Record> {
    let folder = runs_folder(root);
    let (mut found, mut damaged) = (Found::new(), Vec::new());
    for journal in journals(&folder)? {
        read(&journal, begin, &mut found, &mut damaged)?;
    }
    let names: Vec<String> = found.values().map(|(name, _)| name.clone()).collect();
    match (names.as_slice(), found.pop_first()) {
        ([name], Some((_, (_, Some(record))))) => {
            if record.run.status == Ending::Skipped {
                bail!("run {name} was skipped, it has no iterations to show: {}", record.run.reason);
            }
            // One of them may be a later run of this id.
            for line in damaged {
                eprintln!("{line}");
            }
            Ok(record)
        }
        ([simulation], _) => bail!(
            "{simulation} is a simulation: `gravel view` shows runs on a single problem; `gravel simulate` with --vtk \
             writes the frames of one"
        ),
        ([], _) if !damaged.is_empty() => {
            bail!("no run that can be read has the id `{begin}`, and: {}", damaged.join("; "))
        }
        ([], _) => bail!(
            "`{begin}` is no problem and no case, and no run in {} begins so: reports show the id of each run, on their \
             page and in iterations.csv",
            folder.display()
        ),
        _ => bail!("`{begin}` is the beginning of several ids, give more of it: {}", names.join(", ")),
    }
}

/// Adds the runs of a journal whose ids begin so, and the lines that are damaged.
fn read(journal: &Path, begin: &str, found: &mut Found, damaged: &mut Vec<String>) -> Result<()> {
    let named = format!("\"id\":\"{begin}");
    let mut texts = Texts::new(journal, File::open(journal).with_context(|| journal.display().to_string())?);
    for number in 1.. {
        let text = match texts.next() {
            None => break,
            Some(Ok(text)) => text,
            Some(Err(error @ StoreError::Line { .. })) => {
                damaged.push(error.to_string());
                continue;
            }
            Some(Err(error)) => return Err(error.into()),
        };
        if !text.windows(named.len()).any(|part| part == named.as_bytes()) {
            continue;
        }
        if texts.unsealed() == number {
            let journal = journal.display();
            eprintln!(
                "{journal}, line {number}: from before there were checksums; damage to it would go unnoticed"
            );
        }
        if let Ok(Simulated { simulation: s, .. }) = entry(&text) {
            let name = name([&s.id, &s.method, &s.variant, &s.scene, &s.plan]);
            found.insert(s.id, (name, None));
            continue;
        }
        let record: Record = entry(&text).with_context(|| format!("{}, line {number}", journal.display()))?;
        let run = &record.run;
        let before = found.get(&run.id).and_then(|(_, before)| before.as_ref());
        if !record.snapshots.is_empty() || before.is_none_or(|before| before.snapshots.is_empty()) {
            let name = name([&run.id, &run.method, &run.variant, &run.problem, &run.plan]);
            found.insert(run.id.clone(), (name, Some(record)));
        }
    }
    Ok(())
}

/// The problem of a stored run, if it still is what it was.
pub(crate) fn problem_of_run(root: &Root, run: &Run) -> Result<AnyFrozen> {
    if run.grains == 0 && run.contacts > 0 {
        bail!("its problem is W alone: there are no grains to show");
    }
    let mut settings = run.problem_settings.clone();
    settings.retain(|key, _| key != MISSED_BEFORE && key != MOMENT);
    let mut problem = match settings.remove(CASE) {
        None => AnyFrozen::read(&root.problem(&run.problem)?)?,
        Some(case) => {
            let time_step = settings.remove(TIME_STEP);
            let path = root.case(&as_typed(&case))?;
            let march = settings.remove(MARCH).map(Marcher::deserialize).transpose()?;
            KeptProblem::read(&path, &settings, time_step.as_ref(), march.as_ref())?
                .problem(root, &run.problem)?
        }
    };
    let (before, now) = (&run.problem_hash, content_hash(&*lineup::problem(problem.clone())));
    if now != *before {
        bail!("the problem has changed since: its hash was {before}, and is {now} now");
    }
    problem.rename(&run.problem);
    Ok(problem)
}

/// Reports whether a text can be an id, or a beginning of one long enough to search for.
pub(crate) fn is_id(text: &str) -> bool {
    (4..=16).contains(&text.len()) && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f'))
}

/// Id, then method and variant, on what, in which study.
fn name([id, method, variant, on, plan]: [&str; 5]) -> String {
    format!("{id} ({} on {on} in `{plan}`)", format!("{method} {variant}").trim_end())
}
