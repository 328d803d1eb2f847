//! A run on a problem: repeated for its seconds, kept as a row with its curve.

use crate::identity::provenance;
use crate::plan::{Plan, Runs, Settings};
use crate::problems::{Known, Problem, Root, Studied};
use crate::run::{
    Conditions, Ended, Kept, Made, Recorder, Task, ended, ended_row, given_row, nothing_done, of_task,
    refused, repeated, scene_rows,
};
use anyhow::Result;
use contact::{ContactProblem, Mechanics, Vector};
use partition::{Decomposition, Grid, Partition, Scheme};
use results::journal::Record;
use results::schema::{ContactRow, GrainRow, Provenance, Run, Snapshot};
use runner::{Outcome, Progress};
use serde_json::{Map, Value, json};
use std::ops::ControlFlow;

/// Reason why a run with a warm start is skipped.
pub(super) const NO_START: &str = "the problem has no impulses of a time step before to begin from";

/// A problem of a study, whatever its mechanics.
pub(crate) trait OneProblem: Sync {
    /// Its name.
    fn name(&self) -> &str;

    /// Hash of its content.
    fn hash(&self) -> &str;

    /// Values set in its case.
    fn settings(&self) -> &Settings;

    /// A run on it; `None` if it was halted.
    fn run(
        &self,
        plan: &Plan,
        task: &Task<&dyn OneProblem>,
        conditions: &Conditions,
    ) -> Result<Option<Record>>;

    /// A run on it by all ranks, each with its share, which all must make; `None` if it was halted.
    #[cfg(any(feature = "mpi", test))]
    fn run_on_ranks(
        &self,
        plan: &Plan,
        task: &Task<&dyn OneProblem>,
        on: &crate::run::OnAllRanks,
    ) -> Result<Option<Record>>;

    /// The row of what another code answered, if that lies beside it.
    fn given_row(&self, plan: &Plan, root: &Root) -> Result<Option<Run>>;

    /// Its grains and contacts under some partitions, as they are drawn.
    fn scene_rows(
        &self,
        partitions: &[(String, Grid, Scheme)],
        root: &Root,
    ) -> Result<(Vec<GrainRow>, Vec<ContactRow>)>;
}

impl<M: Studied> OneProblem for Problem<M> {
    fn name(&self) -> &str {
        &self.frozen.name
    }

    fn hash(&self) -> &str {
        &self.hash
    }

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn run(
        &self,
        plan: &Plan,
        task: &Task<&dyn OneProblem>,
        conditions: &Conditions,
    ) -> Result<Option<Record>> {
        let Task { id, variant, selected, .. } = task;
        let task = Task { id: id.clone(), variant, selected: *selected, what: self };
        run_on_problem(plan, &task, conditions)
    }

    #[cfg(any(feature = "mpi", test))]
    fn run_on_ranks(
        &self,
        plan: &Plan,
        task: &Task<&dyn OneProblem>,
        on: &crate::run::OnAllRanks,
    ) -> Result<Option<Record>> {
        let Task { id, variant, selected, .. } = task;
        on.run(plan, &Task { id: id.clone(), variant, selected: *selected, what: self })
    }

    fn given_row(&self, plan: &Plan, root: &Root) -> Result<Option<Run>> {
        let Some(given) = &self.given else { return Ok(None) };
        Ok(Some(given_row(plan, self, given, self.known(root)?, provenance()?)))
    }

    fn scene_rows(
        &self,
        partitions: &[(String, Grid, Scheme)],
        root: &Root,
    ) -> Result<(Vec<GrainRow>, Vec<ContactRow>)> {
        Ok(scene_rows(&self.frozen, partitions, self.known(root)?.impulses()))
    }
}

/// One run, as often as `timing` says; `None` if it was halted. A method that cannot start on the problem is a row too: it
/// says why.
fn run_on_problem<M: Studied>(
    plan: &Plan,
    task: &Task<&Problem<M>>,
    conditions: &Conditions,
) -> Result<Option<Record>> {
    let Task { variant, what: problem, .. } = task;
    let known = problem.known(conditions.how.root)?;
    let timing = conditions.how.timing();
    let mut provenance = conditions.how.provenance.restarted();
    if let Runs::Elsewhere(programme) = &variant.method.runs {
        programme.code.version().unwrap_or_default().clone_into(&mut provenance.other_code);
    }
    let row = Run {
        spectrum: spectrum(plan, task, known),
        timing: timing.clone(),
        ..skipped_row(plan, task, known, provenance)
    };
    if variant.warm_start && problem.frozen.start.is_empty() {
        return Ok(Some(refused(row, NO_START)));
    }
    let ours = matches!(variant.method.runs, Runs::Here(_));
    let once = || once(plan, task, known, conditions);
    let (ended, (curve, snapshots), timing) = match repeated(&name(task), ours, &timing, once)? {
        Made::Halted => return Ok(None),
        Made::Refused(reason) => return Ok(Some(refused(row, &reason))),
        Made::Ended(ended, kept, timing) => (*ended, kept, timing),
    };
    let outcome = Outcome { status: known.ending(ended.outcome.status), ..ended.outcome };
    let mut run = ended_row(Run { timing, ..row }, &outcome, &curve);
    if let Some((is_known, by)) =
        M::polished_to(conditions.how.root, &problem.frozen, known, &outcome.impulses)?
    {
        let word = if is_known { "known" } else { "new" };
        word.clone_into(&mut run.known.polished_to);
        run.known.polished_by = by;
    }
    if !ours {
        run.derived.insert("rungs".to_owned(), serde_json::to_value(&ended.rungs)?);
    }
    if let Some(why) = ended.failed {
        (run.status, run.reason) = ("failed".to_owned(), why);
    }
    Ok(Some(Record { run, curve, snapshots }))
}

/// The row of a run that was skipped, if it is not run.
pub(crate) fn skipped_row<M: Studied>(
    plan: &Plan,
    task: &Task<&Problem<M>>,
    known: &Known<M>,
    provenance: Provenance,
) -> Run {
    of_task(task, nothing_done(plan, task.what, known, provenance))
}

/// The run, as a user reads it.
fn name<M: Studied>(task: &Task<&Problem<M>>) -> String {
    format!("{} on {}", task.variant.label(), task.what.frozen.name)
}

/// Returns the quantities that explain how the run ends, where the plan asks for them: the spectrum of the problem, its
/// dimension and the unknowns per contact; of a partition the most copies of a grain and the share of copies at boundaries,
/// the most neighbours of a subdomain and the most bytes that one sends in an exchange, and, without mass
/// splitting, the strength of the coupling between subdomains.
fn spectrum<M: Studied>(plan: &Plan, task: &Task<&Problem<M>>, known: &Known<M>) -> Map<String, Value> {
    if !plan.spectra {
        return Map::new();
    }
    let (problem, variant) = (&task.what.frozen.problem, task.variant);
    let mut columns = task.what.spectrum(known).clone();
    columns.extend([
        ("dimensions".to_owned(), json!(M::Place::LEN)),
        ("unknowns".to_owned(), json!(M::Impulse::LEN)),
    ]);
    // A run with a partition that does not fit the problem is skipped, and says why.
    if let Some((grid, scheme)) = variant.method.partition()
        && let Ok(partition) = Partition::of_contacts(problem, scheme, grid)
    {
        let decomposition = Decomposition::new(problem, &partition);
        let (neighbours, sent) = decomposition.greatest_exchange();
        let sent_bytes = sent * (size_of::<f64>() * M::Velocity::LEN) as u64;
        columns.extend([
            ("multiplicity".to_owned(), json!(decomposition.multiplicity.iter().copied().max())),
            ("boundary_share".to_owned(), json!(boundary_share(&decomposition.multiplicity))),
            ("neighbours".to_owned(), json!(neighbours)),
            ("sent_bytes".to_owned(), json!(sent_bytes)),
        ]);
        if variant.method.setting::<bool>("mass_splitting") == Some(false)
            && let Some(coupling) = M::coupling(problem, &partition.subdomain)
        {
            columns.insert("coupling".to_owned(), json!(coupling));
        }
    }
    columns
}

/// Returns the share of boundary grains among the grains of all subdomains, each copy counted (–).
fn boundary_share(multiplicity: &[u32]) -> f64 {
    let copies = |of: &dyn Fn(u32) -> bool| {
        multiplicity.iter().filter(|copies| of(**copies)).map(|copies| u64::from(*copies)).sum::<u64>() as f64
    };
    copies(&|copies| copies > 1) / copies(&|copies| copies > 0).max(1.0)
}

fn once<M: Studied>(
    plan: &Plan,
    task: &Task<&Problem<M>>,
    known: &Known<M>,
    conditions: &Conditions,
) -> Result<(Ended<M>, Kept)> {
    let (frozen, variant) = (&task.what.frozen, task.variant);
    let mut recorder = Recorder::new(plan.curves);
    let shown = plan.view.as_ref().is_some_and(|view| view.shows(&frozen.name, variant));
    let mut snapshots = shown.then(|| Snapshots::of(&frozen.problem));
    let mut line = conditions.bars.line(name(task));
    let r0 = frozen.start(variant.warm_start);
    let (truths, measured) = (known.truths(), conditions.how.measured);
    let ended = ended(&variant.method, truths, frozen, &r0, &plan.stop, measured, &mut |progress| {
        recorder.observe(progress);
        if let Some(snapshots) = &mut snapshots {
            snapshots.observe(progress);
        }
        line.show(progress, plan.stop.on);
        if (conditions.halt)() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let snapshots = snapshots.map_or_else(Vec::new, |kept| kept.finish(&ended.outcome));
    let curve = if ended.samples.is_empty() { recorder.finish() } else { ended.samples.clone() };
    Ok((ended, (curve, snapshots)))
}

/// Keeps the beginning of a run, iterations in a ratio of about 1.4, and its end: some thirty iterates of a hundred thousand.
pub(crate) struct Snapshots<'p, M: Mechanics> {
    problem: &'p ContactProblem<M>,
    kept: Vec<Snapshot>,
    /// The next iteration to be kept.
    next: u64,
}

impl<'p, M: Studied> Snapshots<'p, M> {
    pub(crate) fn of(problem: &'p ContactProblem<M>) -> Self {
        Self { problem, kept: Vec::new(), next: 0 }
    }

    /// Sees every iterate.
    pub(crate) fn observe(&mut self, progress: &Progress) {
        if let Some(measures) = progress.measures
            && progress.iteration >= self.next
        {
            self.keep(progress.iteration, measures.natural_map, progress.impulses);
            self.next = progress.iteration + (2 * progress.iteration).div_ceil(5).max(1);
        }
    }

    /// The iterates; the last one is that of the outcome.
    pub(crate) fn finish(mut self, outcome: &Outcome<M>) -> Vec<Snapshot> {
        if self.kept.last().is_none_or(|last| last.iteration != outcome.iterations) {
            self.keep(outcome.iterations, outcome.measures.natural_map, &outcome.impulses);
        }
        self.kept
    }

    /// Keeps the normal impulses of `r` (N·s), which contacts slide, and spins.
    fn keep(&mut self, iteration: u64, natural_map: f64, r: &[f64]) {
        let impulses_n_s = r.iter().step_by(M::Impulse::LEN).copied().map(rounded).collect();
        let statuses = (0..).zip(M::statuses(self.problem.contacts(), r).unwrap_or_default());
        let sliding = statuses.filter_map(|(contact, status)| (status == 2).then_some(contact)).collect();
        let mut velocity = self.problem.free_velocity().to_vec();
        self.problem.velocity(r, &mut velocity);
        // In space a spin is a vector, which the page does not draw.
        let spins = velocity.iter().map(M::spin).filter(|spin| spin.len() == 1);
        let spins_rad_per_s = spins.flatten().copied().map(rounded).collect();
        self.kept.push(Snapshot { iteration, natural_map, impulses_n_s, sliding, spins_rad_per_s });
    }
}

/// Rounds to three significant digits, for display.
fn rounded(r: f64) -> f64 {
    format!("{r:.2e}").parse().ok().filter(|rounded: &f64| rounded.is_finite()).unwrap_or(f64::NAN)
}
