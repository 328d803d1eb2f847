//! Runs on a problem that is W alone, as files of other codes have it: by the methods that need no grains.

use crate::identity::hash_of_w;
use crate::plan::{Method, Plan, Settings};
use crate::problems::Root;
use crate::run::{
    Conditions, Ended, Kept, Made, Observe, OneProblem, Recorder, Task, asked, ended_row, of_task, refused,
    repeated,
};
use anyhow::{Result, bail};
use contact::acceleration::{Acceleration, LAG, SLACK};
use local::LocalProblem;
use partition::{Grid, Scheme};
use results::journal::Record;
use results::schema::{ContactRow, GrainRow, KnownSolutions, Run};
use runner::{LocalTruth, Measured, Outcome, Progress, Stop, solve_local};
use std::ops::ControlFlow;
use std::sync::OnceLock;

/// A problem of W alone in a study.
pub(crate) struct OnW {
    pub(crate) name: String,
    hash: String,
    /// Nothing can be set.
    settings: Settings,
    pub(crate) problem: LocalProblem,
    /// A solution, once it was looked for; nobody asks for one where it is set from the start.
    truth: OnceLock<Option<LocalTruth>>,
}

impl OnW {
    /// Of a plan that compares its runs with a solution, or does not.
    pub(crate) fn new(name: String, problem: LocalProblem, reference: bool) -> Self {
        let truth = if reference { OnceLock::new() } else { OnceLock::from(None) };
        Self { hash: hash_of_w(&problem), name, settings: Settings::new(), problem, truth }
    }

    /// A solution, if the active set ends at one. With friction there may be others.
    pub(crate) fn truth(&self) -> Option<&LocalTruth> {
        self.truth.get_or_init(|| truth(&self.problem)).as_ref()
    }
}

/// A natural map that tells a solution (–), and the iterations in which it is looked for.
const SOLVED: Stop = Stop { on: contact::Measure::NaturalMap, tolerance: 1e-12, max_iterations: 200_000 };

fn truth(problem: &LocalProblem) -> Option<LocalTruth> {
    let method = local::Method::ActiveSet { start_accuracy: active_set::ActiveSet::default().start_accuracy };
    let goes_on = &mut |_: &Progress| ControlFlow::Continue(());
    let outcome = solve_local(None, method, problem, &SOLVED, Measured::Needed, goes_on).ok()?;
    let is_solved = outcome.measures.natural_map <= SOLVED.tolerance;
    is_solved.then(|| LocalTruth::new(problem, outcome.impulses))
}

/// The method where there are no grains.
///
/// # Errors
/// Names the method that needs them, or the setting that has no meaning without.
fn without_grains(method: &Method) -> Result<local::Method> {
    const SWEEPS: &[&str] = &["subdomains", "acceleration", "lag", "slack"];
    let (own, local): (&[&str], _) = match method.name {
        "nsgs" | "nsgs-dd" => {
            let subdomains = method.partition().map_or(1, |(grid, _)| grid.count());
            let acceleration: Acceleration = method.setting("acceleration").unwrap_or_default();
            let lag = method.setting("lag").unwrap_or(LAG);
            let momentum = acceleration.momentum(lag, method.setting("slack").unwrap_or(SLACK))?;
            (SWEEPS, local::Method::Nsgs { subdomains: usize::try_from(subdomains)?, momentum })
        }
        "cg" => {
            let preconditioner = method.setting("preconditioner").unwrap_or_default();
            (&["preconditioner"], local::Method::Cg { preconditioner })
        }
        "active-set" => {
            let start_accuracy = method.setting("start_accuracy").unwrap_or_default();
            (&["start_accuracy"], local::Method::ActiveSet { start_accuracy })
        }
        other => bail!(
            "method `{other}` needs grains, and there is W alone: nsgs, nsgs-dd, cg and active-set do without"
        ),
    };
    let plain = Method::parse(method.name, &[])?;
    let is_other = |key: &str, value| !own.contains(&key) && plain.settings.get(key) != Some(value);
    let other = method.settings.iter().find(|(key, value)| is_other(key, value));
    if let Some((key, value)) = other {
        bail!("method `{}`: `{key}` = {value} has no meaning where there is W alone", method.name);
    }
    Ok(local)
}

/// Runs `method` from r = 0 until `stop`, beside a solution if one is known.
///
/// # Errors
/// Says why the method cannot start on the problem.
pub(crate) fn solved_on_w(
    method: &Method,
    truth: Option<&LocalTruth>,
    problem: &LocalProblem,
    stop: &Stop,
    measured: Measured,
    observe: &mut Observe,
) -> Result<Outcome> {
    Ok(solve_local(truth, without_grains(method)?, problem, stop, measured, observe)?)
}

impl OnW {
    fn once(
        &self,
        plan: &Plan,
        task: &Task<&dyn OneProblem>,
        conditions: &Conditions,
    ) -> Result<(Ended, Kept)> {
        let (variant, measured) = (task.variant, conditions.how.measured);
        let mut recorder = Recorder::new(plan.curves);
        let mut line = conditions.bars.line(self.label(task));
        let mut observe = |progress: &Progress| {
            recorder.observe(progress);
            line.show(progress, plan.stop.on);
            if (conditions.halt)() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let outcome =
            solved_on_w(&variant.method, self.truth(), &self.problem, &plan.stop, measured, &mut observe)?;
        let ended = Ended { outcome, rungs: Vec::new(), samples: Vec::new(), failed: None };
        Ok((ended, (recorder.finish(), Vec::new())))
    }

    fn label(&self, task: &Task<&dyn OneProblem>) -> String {
        format!("{} on {}", task.variant.label(), self.name)
    }
}

impl OneProblem for OnW {
    fn name(&self) -> &str {
        &self.name
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
        let timing = conditions.how.timing();
        let solutions = if plan.reference { Some(u32::from(self.truth().is_some())) } else { None };
        let row = Run {
            contacts: self.problem.contact_count() as u32,
            known: KnownSolutions { solutions, ..KnownSolutions::default() },
            timing: timing.clone(),
            ..asked(plan, self, conditions.how.provenance.restarted())
        };
        let row = of_task(task, row);
        if task.variant.warm_start {
            return Ok(Some(refused(row, "a problem of W alone has no time step before")));
        }
        let once = || self.once(plan, task, conditions);
        Ok(match repeated(&self.label(task), true, &timing, once)? {
            Made::Halted => None,
            Made::Refused(reason) => Some(refused(row, &reason)),
            Made::Ended(ended, (curve, snapshots), timing) => {
                let run = ended_row(Run { timing, ..row }, &ended.outcome, &curve);
                Some(Record { run, curve, snapshots })
            }
        })
    }

    #[cfg(any(feature = "mpi", test))]
    fn run_on_ranks(
        &self,
        plan: &Plan,
        task: &Task<&dyn OneProblem>,
        on: &crate::run::OnAllRanks,
    ) -> Result<Option<Record>> {
        let row = of_task(task, asked(plan, self, on.provenance.restarted()));
        Ok(Some(refused(row, "ranks share grains, and there is W alone")))
    }

    fn given_row(&self, _: &Plan, _: &Root) -> Result<Option<Run>> {
        Ok(None)
    }

    fn scene_rows(&self, _: &[(String, Grid, Scheme)], _: &Root) -> Result<(Vec<GrainRow>, Vec<ContactRow>)> {
        Ok((Vec::new(), Vec::new()))
    }
}
