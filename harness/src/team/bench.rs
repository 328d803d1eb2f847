//! `gravel-mpi bench`: the runs of a plan that its store for so many ranks lacks, each on all ranks; rank 0 stores the rows.

use crate::cli::args::StudyArgs;
use crate::identity::provenance;
use crate::root::Root;
use crate::store::{about, draw, finish, open, records_of, runs_folder};
use crate::study::{Kind, OnProblems, by_id, missing};
use crate::team::ping;
use crate::team::run::OnAllRanks;
use crate::team::share::Posted;
use crate::terminal::{exit, say};
use anyhow::{Result, bail};
use reports::{About, Chart, Formats, Wanted};
use results::journal::Record;
use results::name::Name;
use results::schema::Run;
use results::store::Store;
use results::study::{Runs, Study as Rows};
use std::collections::HashSet;
use std::fs;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Run all again, those that are there as well; the new rows replace them in the tables
    #[arg(long)]
    rerun: bool,
}

pub(crate) fn run(posted: &Posted, root: &Root, args: &Args) -> Result<ExitCode> {
    let first = posted.rank() == 0;
    let plan = posted.agree(args.study.selection(root))?.plan;
    if plan.through_time() {
        bail!("plan {}: it marches through time, which is done on one machine", plan.name);
    }
    // The same counts as on one machine, in other seconds.
    let (base, repeats) = (plan.name, plan.repeats.get());
    let name = format!("{base}-on-{}-ranks", posted.size());
    let provenance = posted.agree(provenance())?;
    let mut store: Option<Store<Record>> =
        posted.agree(if first { open(root, &name).map(Some) } else { Ok(None) })?;
    let study = posted.first_alone(|| selection_of(args, root, &name))?;
    let tasks = study.tasks();
    let known = store.as_ref().filter(|_| !args.rerun);
    let done: HashSet<&str> =
        known.map_or_else(HashSet::new, |store| by_id(store.records()).into_keys().collect());
    let ids: HashSet<String> = missing(&tasks, &done).into_iter().map(|task| task.id).collect();
    let wanted: Vec<f64> = tasks.iter().map(|task| f64::from(u8::from(ids.contains(&task.id)))).collect();
    let wanted = posted.all()?.gather(if first { &wanted } else { &[] }).swap_remove(0);
    let wanted: HashSet<&str> =
        tasks.iter().zip(wanted).filter(|(_, wanted)| *wanted > 0.0).map(|(task, _)| &*task.id).collect();
    let (left, size) = (wanted.len(), study.size());
    posted.agree(if first {
        say(format_args!("plan {name}: {left} of {size} runs to do"))
    } else {
        Ok(())
    })?;
    let prices = ping::prices(posted);
    let on = OnAllRanks { posted, root, provenance: &provenance, repeats, prices };
    let mut known = HashSet::new();
    for task in tasks.iter().filter(|task| wanted.contains(&*task.id) && known.insert(task.id.clone())) {
        let record = on.run(&study.selection().plan, task)?;
        let Some(record) = record else { break };
        let whole = exit::whole();
        let kept = store.as_mut().map_or(Ok(()), |store| {
            let Run { problem, method, variant, status, iterations, .. } = &record.run;
            let status = status.name();
            say(format_args!("{problem}, {method} {variant}: {status} after {iterations} iterations"))?;
            Ok(store.append(record)?)
        });
        drop(whole);
        posted.agree(kept)?;
    }
    let finished = store.map_or(Ok(ExitCode::SUCCESS), |store| {
        let code = finish(root, &study, store)?;
        if !exit::requested() {
            draw_all(root, &study, &base)?;
        }
        Ok(code)
    });
    posted.agree(finished)
}

/// Draws what is stored of a plan on one rank and on several, measured beside predicted.
fn draw_all(root: &Root, study: &OnProblems, base: &str) -> Result<()> {
    let (stores, tasks) = (runs_folder(root), study.tasks());
    let mut counts: Vec<u32> = Vec::new();
    for entry in fs::read_dir(&stores)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        let count =
            name.strip_prefix(base).and_then(|name| name.strip_prefix("-on-")?.strip_suffix("-ranks"));
        counts.extend(count.and_then(|count| count.parse::<u32>().ok()));
    }
    counts.sort_unstable();
    if !(counts.first() == Some(&1) && counts.len() > 1) {
        return Ok(());
    }
    let mut rows = Runs::default();
    for count in counts {
        let stored: Vec<Record> = records_of(&stores.join(format!("{base}-on-{count}-ranks")))?;
        let known = by_id(&stored);
        for mut record in tasks.iter().filter_map(|task| known.get(&*task.id).map(|r| (*r).clone())) {
            record.run.settings.insert("ranks".to_owned(), count.into());
            rows.records.push(record);
        }
    }
    let name = format!("{base}-on-ranks");
    let selection = study.selection();
    let about = About { name: name.clone(), draw: None, ..about(&selection.plan, &selection.again) };
    let charts: Vec<Chart> = Chart::named("ranks").into_iter().collect();
    draw(root, &name, &stores, Formats::default(), |formats, out| {
        let wanted = Wanted { charts: &charts, formats, against: None };
        Ok(reports::report(&Rows::Runs(rows), &about, wanted, out)?)
    })
}

/// The study of the plan on the command line, under the name of its store.
fn selection_of(args: &Args, root: &Root, name: &str) -> Result<OnProblems> {
    let mut selection = args.study.selection(root)?;
    name.clone_into(&mut selection.plan.name);
    OnProblems::new(selection, root, true)
}
