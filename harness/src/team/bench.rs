//! `gravel-mpi bench`: the runs of a plan that its store for so many ranks lacks, each on all ranks; rank 0 stores the rows.

use crate::cli::args::StudyArgs;
use crate::identity::provenance;
use crate::problems::Root;
use crate::run::{OnAllRanks, Posted};
use crate::store::{finish, open};
use crate::study::{Kind, OnProblems, by_id, missing};
use crate::terminal::say;
use anyhow::{Result, bail};
use results::journal::Record;
use results::schema::Run;
use results::store::Store;
use std::collections::HashSet;
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
    let (name, repeats) = (format!("{}-on-{}-ranks", plan.name, posted.size()), plan.repeats.get());
    let provenance = posted.agree(provenance())?;
    let mut store: Option<Store<Record>> =
        posted.agree(if first { open(root, &name).map(Some) } else { Ok(None) })?;
    // What has to be computed is computed and kept by rank 0 alone, then read by all.
    let mut begun = None;
    for turn in [true, false] {
        let own = if first == turn { selection_of(args, root, &name).map(Some) } else { Ok(None) };
        if let Some(study) = posted.agree(own)? {
            begun = Some(study);
        }
    }
    let Some(study) = begun else { bail!("a rank has no study") };
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
    let on = OnAllRanks { posted, provenance: &provenance, repeats };
    let mut known = HashSet::new();
    for task in tasks.iter().filter(|task| wanted.contains(&*task.id) && known.insert(task.id.clone())) {
        let record = task.what.run_on_ranks(&study.selection().plan, task, &on)?;
        let Some(record) = record else { break };
        let kept = store.as_mut().map_or(Ok(()), |store| {
            let Run { problem, method, variant, status, iterations, .. } = &record.run;
            say(format_args!("{problem}, {method} {variant}: {status} after {iterations} iterations"))?;
            Ok(store.append(record)?)
        });
        posted.agree(kept)?;
    }
    let finished = store.map_or(Ok(ExitCode::SUCCESS), |store| finish(root, &study, store));
    posted.agree(finished)
}

/// The study of the plan on the command line, under the name of its store.
fn selection_of(args: &Args, root: &Root, name: &str) -> Result<OnProblems> {
    let mut selection = args.study.selection(root)?;
    name.clone_into(&mut selection.plan.name);
    OnProblems::new(selection, root, true)
}
