//! A scene through time: one method, one rule, until the end, an explosion or a refusal; and its row and series.

use crate::plan::Rule;
use crate::problems::Scene;
use crate::run::{Conditions, Task};
use crate::terminal::write_sealed;
use anyhow::Result;
use cases::{AnyFrozen, CaseError, Observables, Side, Start};
use lineup::{Attempt, OneMarch, OneProblem, Ours, march};
use results::name::{Name, StopOn};
use results::schema::{Provenance, Timing};
use results::settings::CASE;
use results::simulation::{Observed, Role, Simulated, Simulation, SimulationEnding, Totals};
use results::store::LAST_STATES;
use runner::{Outcome, Status, Stop};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// A scene under a rule.
#[derive(Clone, Copy)]
pub(crate) struct Through<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) rule: Rule,
    /// Its part in the study.
    pub(crate) role: Role,
}

impl Through<'_> {
    /// Its time step, and until when each is solved from what.
    pub(crate) fn in_words(&self) -> String {
        let start = match self.rule.warm_start {
            Start::Nothing => ", cold",
            Start::Previous => "",
            Start::Extrapolated => ", extrapolated",
        };
        let (h, stop) = (self.scene.case.scene.time_step_s, &self.rule.stop);
        format!("h = {h} s, {} ≤ {:e}{start}", stop.on, stop.tolerance)
    }
}

/// One simulation; `None` if it was halted. One that explodes leaves the problem of its last good state in the folder of the
/// study.
pub(crate) fn run_simulation(
    plan: &str,
    task: &Task<Through>,
    conditions: &Conditions,
) -> Result<Option<Simulated>> {
    let clock = Instant::now();
    let Task { variant, what: Through { scene, rule, .. }, .. } = task;
    let Conditions { how, bars, halt } = conditions;
    let Scene { case, name, time_steps, every, .. } = scene;
    let mut march = march(case)?;
    let timing = how.timing();
    let row = nothing_done(plan, task, &*march, how.provenance.restarted());
    let mut line = bars.line(format!("{} on {name}, {}", variant.label(), task.what.in_words()));
    let mut series = Series { every: *every, rows: Vec::new(), since: None };
    let ours = variant.method.ours()?;
    let (totals, end) = through_time(&mut *march, ours, rule, *time_steps, halt, &mut |seen: &Seen| {
        series.see(seen);
        line.show_time_step(seen.totals.time_steps, *time_steps);
        Ok(ControlFlow::Continue(()))
    })?;
    let Some(status) = end.ending() else { return Ok(None) };
    let last_state = match (&end, how.folder) {
        (End::Exploded { last, .. }, Some(folder)) => keep(last, folder, &task.id)?,
        _ => String::new(),
    };
    let simulation = Simulation {
        status,
        reason: end.reason().to_owned(),
        last_state,
        totals,
        timing: Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing },
        ..row
    };
    Ok(Some(Simulated { simulation, series: series.rows }))
}

/// Writes the problem of the last good state below the folder of the study, and returns its path there.
fn keep(last: &AnyFrozen, folder: &Path, id: &str) -> Result<String> {
    let file = format!("{LAST_STATES}/{id}.json");
    write_sealed(&folder.join(&file), &last.to_json()?)?;
    Ok(file)
}

/// The row of a simulation that has reached nothing yet.
fn nothing_done(
    plan: &str,
    task: &Task<Through>,
    march: &dyn OneMarch,
    provenance: Provenance,
) -> Simulation {
    let Task { id, variant, what: Through { scene, rule, role }, .. } = task;
    let bodies = march.bodies();
    let mut settings = scene.settings.clone();
    settings.insert(CASE.to_owned(), scene.case.name.as_str().into());
    Simulation {
        id: id.clone(),
        plan: plan.to_owned(),
        scene: scene.name.clone(),
        scene_settings: settings,
        scene_hash: scene.hash.clone(),
        role: *role,
        grains: bodies.len() as u32,
        mass_kg: bodies.iter().map(|body| body.mass).sum(),
        mean_diameter_m: march.mean_diameter(),
        gravity_m_per_s2: scene.case.scene.gravity_m_per_s2,
        time_step_s: scene.case.scene.time_step_s,
        duration_s: scene.duration_s,
        method: variant.method.name.to_owned(),
        settings: variant.method.settings.clone(),
        variant: variant.name.clone(),
        warm_start: rule.warm_start.is_warm(),
        start: rule.warm_start.name().to_owned(),
        stop_on: StopOn(rule.stop.on),
        tolerance: rule.stop.tolerance,
        max_iterations: rule.stop.max_iterations,
        provenance,
        ..Simulation::default()
    }
}

/// The series of a simulation, thinned: a row for every so many time steps.
struct Series {
    every: u64,
    rows: Vec<Observed>,
    /// The row that is being gathered.
    since: Option<Observed>,
}

impl Series {
    fn see(&mut self, seen: &Seen) {
        let now = observed(seen);
        // Rows begin after whole numbers of them.
        let gathered = |since: &Observed| (since.time_step - 1) % self.every + 1;
        let row = self.since.take().map_or(now, |since| joined(&since, now, gathered(&since)));
        if seen.totals.time_steps.is_multiple_of(self.every) {
            self.rows.push(row);
        } else {
            self.since = Some(row);
        }
    }
}

/// Returns the observables of a time step, as rows hold them.
pub(crate) fn observed(seen: &Seen) -> Observed {
    let o = seen.observables;
    let [floor_impulse_n_s, left_impulse_n_s, right_impulse_n_s, ..] = o.wall_impulses;
    Observed {
        time_step: seen.march.time_steps(),
        time_s: o.time,
        contacts: o.contacts as u32,
        iterations: seen.totals.iterations,
        kinetic_energy_j: o.kinetic_energy,
        mean_height_m: o.mean_height,
        greatest_overlap_m: o.greatest_overlap,
        mean_overlap_m: o.mean_overlap,
        greatest_speed_m_per_s: o.greatest_speed,
        greatest_displacement_m: o.greatest_displacement,
        floor_impulse_n_s,
        left_impulse_n_s,
        right_impulse_n_s,
        energy: o.energy,
        stress: o.stress,
        bulk: o.bulk,
        shape: o.shape,
    }
}

/// The later row, of one time step, with the impulses and the energies of both and their extremes, and the mean of the stresses of so
/// many time steps and its own.
fn joined(earlier: &Observed, later: Observed, time_steps: u64) -> Observed {
    let mut energy = earlier.energy;
    energy += later.energy;
    Observed {
        energy,
        stress: earlier.stress.and_then(time_steps, later.stress),
        bulk: earlier.bulk.and_then(time_steps, later.bulk),
        greatest_overlap_m: earlier.greatest_overlap_m.max(later.greatest_overlap_m),
        greatest_speed_m_per_s: earlier.greatest_speed_m_per_s.max(later.greatest_speed_m_per_s),
        floor_impulse_n_s: earlier.floor_impulse_n_s + later.floor_impulse_n_s,
        left_impulse_n_s: earlier.left_impulse_n_s + later.left_impulse_n_s,
        right_impulse_n_s: earlier.right_impulse_n_s + later.right_impulse_n_s,
        ..later
    }
}

/// A time step that was solved.
pub(crate) struct Seen<'a> {
    pub(crate) march: &'a dyn OneMarch,
    pub(crate) problem: &'a dyn OneProblem,
    /// The antagonist of each contact.
    pub(crate) sides: &'a [Side],
    pub(crate) outcome: &'a Outcome,
    pub(crate) observables: &'a Observables,
    pub(crate) totals: &'a Totals,
}

/// End of a simulation.
pub(crate) enum End {
    Completed,
    /// A simulation that exploded, with the problem of its last good state.
    Exploded {
        /// [`SimulationEnding::Exploded`], or the reason.
        status: SimulationEnding,
        why: String,
        last: Box<AnyFrozen>,
    },
    /// The method refused a time step.
    Refused(String),
    /// The user stopped it, here.
    Interrupted(String),
}

/// Makes `time_steps` time steps; `see` sees each, and may complete the simulation there. `halt` may ask for an end after any iteration.
pub(crate) fn through_time(
    march: &mut dyn OneMarch,
    ours: &Ours,
    rule: &Rule,
    time_steps: u64,
    halt: &dyn Fn() -> bool,
    see: &mut dyn FnMut(&Seen) -> Result<ControlFlow<()>>,
) -> Result<(Totals, End)> {
    let mut totals = Totals::default();
    let mut failed = false;
    let before = march.time_steps();
    for k in before + 1..=before.saturating_add(time_steps) {
        if halt() {
            return Ok((totals, End::Interrupted(format!("stopped before time step {k}"))));
        }
        let Attempt { frozen, sides, solved } = march.solve(ours, &rule.stop, rule.warm_start, halt)?;
        let (outcome, observables) = match solved {
            Ok(solved) => solved,
            Err(error) => return Ok((totals, ended(error, k, frozen)?)),
        };
        add(&mut totals, &outcome);
        totals.energy += observables.energy;
        totals.restarted_time_steps += u64::from(failed && rule.warm_start.is_warm());
        failed = matches!(outcome.status, Status::Diverged | Status::Infeasible);
        let (problem, outcome, observables) = (&*lineup::problem(frozen), &outcome, &observables);
        let seen = Seen { march, problem, sides: &sides, outcome, observables, totals: &totals };
        if see(&seen)?.is_break() {
            break;
        }
    }
    Ok((totals, End::Completed))
}

/// Returns the end of a simulation whose `k`-th time step, with the problem `frozen`, was not solved.
fn ended(error: CaseError, k: u64, frozen: AnyFrozen) -> Result<End> {
    let why = error.to_string();
    Ok(match error {
        CaseError::Exploded { solved, .. } => {
            let status = match solved.map(|missed| missed.status) {
                Some(Status::Diverged) => SimulationEnding::SolverDiverged,
                Some(Status::Infeasible) => SimulationEnding::NoSolution,
                _ => SimulationEnding::Exploded,
            };
            End::Exploded { status, why, last: Box::new(frozen) }
        }
        CaseError::Setup(_) => End::Refused(format!("time step {k}: {why}")),
        CaseError::Interrupted { .. } => End::Interrupted(why),
        other => return Err(other.into()),
    })
}

impl End {
    /// Returns the ending of the simulation, unless the user stopped it.
    fn ending(&self) -> Option<SimulationEnding> {
        match self {
            Self::Completed => Some(SimulationEnding::Completed),
            Self::Exploded { status, .. } => Some(*status),
            Self::Refused(_) => Some(SimulationEnding::Skipped),
            Self::Interrupted(_) => None,
        }
    }

    /// Name in files.
    pub(crate) fn status(&self) -> &'static str {
        self.ending().map_or(Status::Interrupted.name(), Name::name)
    }

    /// Returns the status that decides the exit code: that of the worst time step, where all were made.
    pub(crate) fn worst(&self, totals: &Totals) -> &'static str {
        match self {
            Self::Completed if totals.infeasible_time_steps > 0 => SimulationEnding::NoSolution.name(),
            Self::Completed if totals.missed_time_steps > 0 => Status::IterationLimit.name(),
            end => end.status(),
        }
    }

    /// Returns the evidence that it exploded, the reason why the method refused, or the place where it was stopped; empty if
    /// it was completed.
    pub(crate) fn reason(&self) -> &str {
        match self {
            Self::Completed => "",
            Self::Exploded { why, .. } | Self::Refused(why) | Self::Interrupted(why) => why,
        }
    }
}

/// Adds a time step that was solved.
fn add(totals: &mut Totals, outcome: &Outcome) {
    totals.time_steps += 1;
    totals.missed_time_steps += u64::from(outcome.status != Status::Converged);
    totals.diverged_time_steps += u64::from(outcome.status == Status::Diverged);
    totals.infeasible_time_steps += u64::from(outcome.status == Status::Infeasible);
    totals.iterations += outcome.iterations;
    totals.setup_s += outcome.setup.as_secs_f64();
    totals.iterating_s += outcome.iterating.as_secs_f64();
    totals.work += outcome.work;
}

/// Returns, in words, the number of time steps that did not converge to `stop`; nothing if all did.
pub(crate) fn missed(totals: &Totals, stop: &Stop) -> Option<String> {
    let Totals { time_steps, missed_time_steps: missed, restarted_time_steps: restarted, .. } = *totals;
    let (diverged, infeasible) = (totals.diverged_time_steps, totals.infeasible_time_steps);
    let Stop { on, tolerance, .. } = stop;
    let mut text = format!("{missed} of {time_steps} time steps did not converge to {on} ≤ {tolerance:e}");
    if diverged + infeasible > 0 {
        let of_these = format!(": {diverged} diverged, {infeasible} had no solution; ");
        text = text + &of_these + &format!("{restarted} began from r = 0 after one of these");
    }
    (missed > 0).then_some(text)
}
