//! `gravel-mpi bench`: the runs of a plan that its store for so many ranks lacks, each on all ranks; rank 0 stores the rows.

use crate::cli::args::StudyArgs;
use crate::identity::provenance;
use crate::problems::{Problem, Root, Studied};
use crate::run::{Recorder, Task, ended_row, skipped_row};
use crate::store::{finish, open};
use crate::study::{Kind, OnProblems, by_id, missing};
use crate::team::shared::{Posted, cut_of, of_whole};
use crate::team::solve::{exchanged, on_ranks};
use crate::terminal::{exit, say};
use anyhow::{Result, bail};
use results::journal::Record;
use results::provenance::load_average;
use results::schema::{Exchange, Provenance, Run, Sample, Timing};
use results::store::Store;
use runner::{Measured, Outcome, Status};
use std::collections::HashSet;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::time::Instant;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Run all again, those that are there as well; the new rows replace them in the tables
    #[arg(long)]
    rerun: bool,
}

/// All ranks, and what their rows say of them.
pub(crate) struct OnRanks<'a> {
    posted: &'a Posted,
    provenance: &'a Provenance,
    repeats: u32,
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
    if first {
        say(format_args!("plan {name}: {} of {} runs to do", wanted.len(), study.size()))?;
    }
    let on = OnRanks { posted, provenance: &provenance, repeats };
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

impl OnRanks<'_> {
    /// A run, as often as the plan says; `None` if it was halted.
    pub(crate) fn run<M: Studied>(
        &self,
        plan: &crate::plan::Plan,
        task: &Task<&Problem<M>>,
    ) -> Result<Option<Record>> {
        let timing = Timing {
            repeats: self.repeats,
            timed_alone: true,
            load_average: load_average(),
            ..Timing::default()
        };
        let row = Run { timing: timing.clone(), ..skipped_row(plan, task, self.provenance.restarted()) };
        let skipped = |reason: &str| {
            let run = Run { reason: reason.to_owned(), ..row.clone() };
            Ok(Some(Record { run, curve: Vec::new(), snapshots: Vec::new() }))
        };
        if task.variant.warm_start {
            return skipped("ranks begin from r = 0");
        }
        let method = &task.variant.method;
        // A variant with one subdomain has one, and one rank at most.
        let given = method.partition().map(|(grid, _)| grid);
        let shared = cut_of(self.posted, method, given, None)
            .and_then(|(_, grid, scheme)| of_whole(self.posted, &task.what.frozen, grid, scheme));
        let shared = match self.posted.agree(shared) {
            Ok(shared) => shared,
            Err(reason) => return skipped(&format!("{reason:#}")),
        };
        let clock = Instant::now();
        let mut all = Vec::new();
        for _ in 0..self.repeats {
            let mut recorder = Recorder::new(plan.curves);
            let ended = on_ranks(method, &shared, &plan.stop, Measured::Grid, &mut |progress| {
                recorder.observe(progress);
                if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            match ended {
                Err(reason) => return skipped(&format!("{reason:#}")),
                Ok(end) if end.status == Status::Interrupted => return Ok(None),
                Ok(end) => all.push((end, recorder.finish())),
            }
        }
        all.sort_by_key(|(end, _)| end.iterating);
        let (end, curve): (runner::OnRanks, Vec<Sample>) = all.swap_remove((all.len() - 1) / 2);
        let (messages, message_bytes, waiting_s) = exchanged(&end.traffic);
        let (ranks, slowest_rank) = (self.posted.size() as u32, end.slowest as u32);
        let exchange = Exchange { ranks, messages, message_bytes, waiting_s, slowest_rank };
        let timing = Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing };
        let outcome = Outcome::<M> {
            status: end.status,
            iterations: end.iterations,
            measures: end.measures,
            impulses: Vec::new(),
            velocity: Vec::new(),
            setup: end.setup,
            iterating: end.iterating,
            work: end.work,
            derived: end.derived,
            critical_path: end.critical_path,
        };
        let subdomains = shared.team.subdomains() as u32;
        let run = ended_row(Run { timing, exchange, subdomains, ..row }, &outcome, &curve);
        Ok(Some(Record { run, curve, snapshots: Vec::new() }))
    }
}
