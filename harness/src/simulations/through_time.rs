//! A scene through time: one method, one rule, until the end, an explosion or a refusal.

use crate::plan::Rule;
use anyhow::Result;
use cases::{CaseError, Frozen, March, Observables, TimeStep};
use contact::{Outcome, Solver, Status, Work};
use std::ops::ControlFlow;
use std::time::Duration;

/// What all time steps took together.
#[derive(Clone, Copy, Default)]
pub(crate) struct Totals {
    pub(crate) time_steps: u64,
    /// Time steps that did not converge.
    pub(crate) missed: u64,
    pub(crate) iterations: u64,
    pub(crate) setup: Duration,
    pub(crate) iterating: Duration,
    pub(crate) work: Work,
}

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
        why: String,
        last: Box<Frozen>,
    },
    /// The method refused a time step.
    Refused(String),
    /// The observer asked for an end.
    Interrupted,
}

/// Makes `time_steps` time steps; `see` sees each, and may ask for an end.
pub(crate) fn through_time(
    march: &mut March,
    solver: &dyn Solver,
    rule: &Rule,
    time_steps: u64,
    see: &mut dyn FnMut(&Seen) -> Result<ControlFlow<()>>,
) -> Result<(Totals, End)> {
    let mut totals = Totals::default();
    for k in 1..=time_steps {
        let time_step = march.next()?;
        let (outcome, observables) = match march.make(&time_step, solver, &rule.stop, rule.warm_start) {
            Ok(made) => made,
            Err(error @ CaseError::Exploded { .. }) => {
                let (why, last) = (error.to_string(), Box::new(time_step.frozen));
                return Ok((totals, End::Exploded { why, last }));
            }
            Err(CaseError::Setup(error)) => {
                return Ok((totals, End::Refused(format!("time step {k}: {error}"))));
            }
            Err(error) => return Err(error.into()),
        };
        totals.add(&outcome);
        let (outcome, observables) = (&outcome, &observables);
        if see(&Seen { march, time_step: &time_step, outcome, observables, totals: &totals })?.is_break() {
            return Ok((totals, End::Interrupted));
        }
    }
    Ok((totals, End::Completed))
}

impl Totals {
    fn add(&mut self, outcome: &Outcome) {
        self.time_steps += 1;
        self.missed += u64::from(outcome.status != Status::Converged);
        self.iterations += outcome.iterations;
        self.setup += outcome.setup;
        self.iterating += outcome.iterating;
        let (all, one) = (&mut self.work, &outcome.work);
        all.contact_updates += one.contact_updates;
        all.delassus_products += one.delassus_products;
        all.interface_values += one.interface_values;
        all.triangular_solve_entries += one.triangular_solve_entries;
        all.factorisations += one.factorisations;
    }
}
