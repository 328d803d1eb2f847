//! A scene through time: one method, one rule, until the end, an explosion or a refusal.

use crate::plan::rules::Rule;
use anyhow::Result;
use cases::{CaseError, Frozen, March, Observables, TimeStep};
use contact::Solver;
use results::simulation::Totals;
use runner::{Outcome, Status, Stop};

/// A time step that was made.
pub(crate) struct Seen<'a> {
    pub(crate) march: &'a March,
    pub(crate) time_step: &'a TimeStep,
    pub(crate) outcome: &'a Outcome,
    pub(crate) observables: &'a Observables,
    pub(crate) totals: &'a Totals,
}

/// How a simulation ended.
pub(crate) enum End {
    Completed,
    /// With the problem of the last good state.
    Exploded {
        /// `exploded`; or what made it explode, `solver-diverged` or `no-solution`.
        status: &'static str,
        why: String,
        last: Box<Frozen>,
    },
    /// The method refused a time step.
    Refused(String),
    /// An end was asked for, here.
    Interrupted(String),
}

/// Makes `time_steps` time steps; `see` sees each. `halt` may ask for an end after any iteration.
pub(crate) fn through_time(
    march: &mut March,
    solver: &dyn Solver,
    rule: &Rule,
    time_steps: u64,
    halt: &dyn Fn() -> bool,
    see: &mut dyn FnMut(&Seen) -> Result<()>,
) -> Result<(Totals, End)> {
    let mut totals = Totals::default();
    let mut failed = false;
    for k in 1..=time_steps {
        if halt() {
            return Ok((totals, End::Interrupted(format!("stopped before time step {k}"))));
        }
        let time_step = march.next()?;
        let (outcome, observables) = match march.solve(&time_step, solver, &rule.stop, rule.warm_start, halt)
        {
            Ok(made) => made,
            Err(error) => return Ok((totals, ended(error, k, time_step)?)),
        };
        add(&mut totals, &outcome);
        totals.restarted_time_steps += u64::from(failed && rule.warm_start);
        failed = matches!(outcome.status, Status::Diverged | Status::Infeasible);
        let (outcome, observables) = (&outcome, &observables);
        see(&Seen { march, time_step: &time_step, outcome, observables, totals: &totals })?;
    }
    Ok((totals, End::Completed))
}

/// What it means for a simulation that its `k`-th time step was not made.
fn ended(error: CaseError, k: u64, time_step: TimeStep) -> Result<End> {
    let why = error.to_string();
    Ok(match error {
        CaseError::Exploded { solved, .. } => {
            let status = match solved.map(|missed| missed.status) {
                Some(Status::Diverged) => "solver-diverged",
                Some(Status::Infeasible) => "no-solution",
                _ => "exploded",
            };
            End::Exploded { status, why, last: Box::new(time_step.frozen) }
        }
        CaseError::Setup(_) => End::Refused(format!("time step {k}: {why}")),
        CaseError::Interrupted { .. } => End::Interrupted(why),
        other => return Err(other.into()),
    })
}

impl End {
    /// Name in files.
    pub(crate) fn status(&self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Exploded { status, .. } => status,
            Self::Refused(_) => "skipped",
            Self::Interrupted(_) => "interrupted",
        }
    }

    /// How it is known that it exploded, why the method refused, or where it was stopped; empty if it was completed.
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

/// How many of the time steps did not converge to `stop`, in words; nothing if all did.
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
