//! A run on a problem: repeated for its seconds, kept as a row with its curve.

use crate::plan::{Plan, Runs, Settings};
use crate::problems::{Known, Problem, polished_to};
use crate::run::{
    Conditions, Ended, Kept, Made, Recorder, Task, ended, ended_row, refused, repeated, skipped_row,
};
use anyhow::Result;
use lineup::{Law, Ours, Posed};
use results::journal::Record;
use results::schema::{Ending, Run, Snapshot};
use runner::{Outcome, Progress};
use serde_json::json;
use std::ops::ControlFlow;

/// Reason why a run with a warm start is skipped.
pub(crate) const NO_START: &str = "the problem has no impulses of a time step before to begin from";

/// One run, as often as `timing` says; `None` if it was halted. A method that cannot start on the problem is a row too: it
/// says why.
pub(crate) fn run_on_problem(
    plan: &Plan,
    task: &Task<&Problem>,
    conditions: &Conditions,
) -> Result<Option<Record>> {
    let Task { variant, what: problem, .. } = task;
    let root = conditions.how.root;
    let known = problem.known(root)?;
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
    if variant.warm_start {
        match &problem.posed {
            Posed::Grains(posed) if posed.start().is_empty() => return Ok(Some(refused(row, NO_START))),
            Posed::W(_) => {
                return Ok(Some(refused(row, "a problem of W alone has no time step before")));
            }
            Posed::Grains(_) => {}
        }
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
    if let Posed::Grains(posed) = &problem.posed
        && let Some((is_known, by)) = polished_to(root, &**posed, known, &outcome.impulses)?
    {
        let word = if is_known { "known" } else { "new" };
        word.clone_into(&mut run.known.polished_to);
        run.known.polished_by = by;
    }
    if !ours {
        run.derived.insert("rungs".to_owned(), serde_json::to_value(&ended.rungs)?);
    }
    if let Some(why) = ended.failed {
        (run.status, run.reason) = (Ending::Failed, why);
    }
    Ok(Some(Record { run, curve, snapshots }))
}

/// The run, as a user reads it.
fn name(task: &Task<&Problem>) -> String {
    format!("{} on {}", task.variant.label(), task.what.name)
}

/// Returns the quantities that explain how the run ends, where the plan asks for them: the spectrum of the problem, its
/// dimension and the unknowns per contact; of a partition the most copies of a grain and the share of copies at boundaries,
/// the most neighbours of a subdomain and the most bytes that one sends in an exchange, and, without mass
/// splitting, the strength of the coupling between subdomains.
fn spectrum(plan: &Plan, task: &Task<&Problem>, known: &Known) -> Settings {
    let (Posed::Grains(problem), true) = (&task.what.posed, plan.spectra) else { return Settings::new() };
    let facts = problem.facts();
    let mut columns = task.what.spectrum(known).clone();
    columns.extend([
        ("dimensions".to_owned(), json!(facts.dimensions)),
        ("unknowns".to_owned(), json!(facts.of_contact)),
    ]);
    // A run with a partition that does not fit the problem is skipped, and says why.
    if let Runs::Here(Ours { cut: Some(cut), .. }) = &task.variant.method.runs
        && let Ok((partition, decomposition)) = problem.cut(cut.grid, cut.scheme)
    {
        let (neighbours, sent) = decomposition.greatest_exchange();
        let sent_bytes = sent * (size_of::<f64>() * facts.of_grain) as u64;
        columns.extend([
            ("multiplicity".to_owned(), json!(decomposition.multiplicity.iter().copied().max())),
            ("boundary_share".to_owned(), json!(boundary_share(&decomposition.multiplicity))),
            ("neighbours".to_owned(), json!(neighbours)),
            ("sent_bytes".to_owned(), json!(sent_bytes)),
        ]);
        if !cut.splits_mass
            && let Law::Frictionless(law) = problem.law()
            && let Some(coupling) = law.coupling(&partition.subdomain)
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

fn once(plan: &Plan, task: &Task<&Problem>, known: &Known, conditions: &Conditions) -> Result<(Ended, Kept)> {
    let Task { variant, what: problem, .. } = task;
    let mut recorder = Recorder::new(plan.curves);
    let shown = plan.view.as_ref().is_some_and(|view| view.shows(&problem.name, variant));
    let mut snapshots = shown.then(|| Snapshots::of(&problem.posed));
    let mut line = conditions.bars.line(name(task));
    let r0 = problem.start(variant.warm_start);
    let run =
        lineup::Run { truths: &known.impulses, r0: &r0, stop: &plan.stop, measured: conditions.how.measured };
    let ended = ended(&variant.method, problem, run, &mut |progress| {
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
pub(crate) struct Snapshots<'p> {
    problem: &'p Posed,
    kept: Vec<Snapshot>,
    /// The next iteration to be kept.
    next: u64,
}

impl<'p> Snapshots<'p> {
    pub(crate) fn of(problem: &'p Posed) -> Self {
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
    pub(crate) fn finish(mut self, outcome: &Outcome) -> Vec<Snapshot> {
        if self.kept.last().is_none_or(|last| last.iteration != outcome.iterations) {
            self.keep(outcome.iterations, outcome.measures.natural_map, &outcome.impulses);
        }
        self.kept
    }

    /// Keeps the normal impulses of `r` (N·s), which contacts slide, and spins.
    fn keep(&mut self, iteration: u64, natural_map: f64, r: &[f64]) {
        let facts = self.problem.facts();
        let impulses_n_s = r.iter().step_by(facts.of_contact).copied().map(rounded).collect();
        let mut snapshot = Snapshot { iteration, natural_map, impulses_n_s, ..Snapshot::default() };
        if let Posed::Grains(problem) = self.problem {
            let statuses = (0..).zip(problem.statuses(r).unwrap_or_default());
            snapshot.sliding =
                statuses.filter_map(|(contact, status)| (status == 2).then_some(contact)).collect();
            // In 3D a spin is a vector, which the page does not draw.
            if facts.has_friction && facts.dimensions == 2 {
                let velocity = problem.velocity(r);
                let spins = velocity.iter().skip(2).step_by(facts.of_grain);
                snapshot.spins_rad_per_s = spins.copied().map(rounded).collect();
            }
        }
        self.kept.push(snapshot);
    }
}

/// Rounds to three significant digits, for display.
fn rounded(r: f64) -> f64 {
    format!("{r:.2e}").parse().ok().filter(|rounded: &f64| rounded.is_finite()).unwrap_or(f64::NAN)
}
