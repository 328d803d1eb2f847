//! A run on a problem that ranks share: one row, with what they sent each other.

use crate::plan::{Method, Plan};
use crate::problems::Problem;
use crate::root::Root;
use crate::run::problem::NO_START;
use crate::run::{Recorder, Task, ended_row, refused, skipped_row};
use crate::team::share::{Posted, Shared, cut_of, of_whole};
use crate::terminal::exit;
use anyhow::{Context, Result};
use lineup::Posed;
use partition::Refused;
use results::journal::Record;
use results::provenance::load_average;
use results::schema::{Exchange, Provenance, Run, Timing};
use runner::{Beside, Measured, Outcome, Progress, Status, Stop};
use std::ops::ControlFlow;
use std::time::Instant;

/// Runs a method on the shares of all ranks, which all must do, each from the impulses `start` of its contacts (N·s).
pub(crate) fn on_ranks(
    method: &Method,
    (Shared { share, team, solutions, .. }, start): (&Shared, &[f64]),
    stop: &Stop,
    measured: Measured,
    observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<(Outcome, Exchange)> {
    let beside = Beside { start, solutions };
    let ended = share.solve(team, method.ours()?, beside, stop, measured, observe)?;
    // The reason is that of the rank which has one.
    let own = match ended {
        Ok(end) => Ok(Some(end)),
        Err(Refused::Elsewhere) => Ok(None),
        Err(Refused::Here(reason)) => Err(reason.to_string()),
    };
    let end = team.agree(own).map_err(anyhow::Error::msg)?.context("another rank cannot start")?;
    let waiting_ns = end.traffic.iter().map(|of_rank| of_rank.waiting_ns).max().unwrap_or(0);
    let exchange = Exchange {
        ranks: team.size() as u32,
        messages: end.traffic.iter().map(|of_rank| of_rank.messages).sum(),
        message_bytes: end.traffic.iter().map(|of_rank| of_rank.bytes).sum(),
        waiting_s: waiting_ns as f64 * 1e-9,
        slowest_rank: end.slowest as u32,
        ..Exchange::default()
    };
    Ok((end.outcome, exchange))
}

/// All ranks, and what their rows say of them.
pub(crate) struct OnAllRanks<'a> {
    pub(crate) posted: &'a Posted,
    pub(crate) root: &'a Root,
    pub(crate) provenance: &'a Provenance,
    pub(crate) repeats: u32,
    /// α (s) and β (s/B) of the machine; undefined of one rank.
    pub(crate) prices: (f64, f64),
}

impl OnAllRanks<'_> {
    /// A run, as often as the plan says; `None` if it was halted.
    pub(crate) fn run(&self, plan: &Plan, task: &Task<&Problem>) -> Result<Option<Record>> {
        let timing = Timing {
            repeats: self.repeats,
            timed_alone: true,
            load_average: load_average(),
            ..Timing::default()
        };
        let known = self.posted.first_alone(|| task.what.known(self.root))?;
        let row =
            Run { timing: timing.clone(), ..skipped_row(plan, task, known, self.provenance.restarted()) };
        let skipped = |reason: &str| Ok(Some(refused(row.clone(), reason)));
        let Posed::Grains(problem) = &task.what.posed else {
            return skipped("ranks share grains, and there is W alone");
        };
        let method = &task.variant.method;
        // A variant with one subdomain has one, and one rank at most.
        let given = method.partition().map(|(grid, _)| grid);
        let shared = cut_of(self.posted, method, given, None)
            .and_then(|(_, grid, scheme)| of_whole(self.posted, task.what, known, (grid, scheme)));
        let shared = match self.posted.agree(shared) {
            Ok(shared) => shared,
            Err(reason) => return skipped(&format!("{reason:#}")),
        };
        let start = match task.variant.warm_start {
            false => vec![0.0; shared.start.len()],
            true if problem.start().is_empty() => return skipped(NO_START),
            true => shared.start.clone(),
        };
        let clock = Instant::now();
        let mut all = Vec::new();
        for _ in 0..self.repeats {
            let mut recorder = Recorder::new(plan.curves);
            let ended = on_ranks(method, (&shared, &start), &plan.stop, Measured::Grid, &mut |progress| {
                recorder.observe(progress);
                if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            match ended {
                Err(reason) => return skipped(&format!("{reason:#}")),
                Ok((end, _)) if end.status == Status::Interrupted => return Ok(None),
                Ok((end, exchange)) => all.push((end, exchange, recorder.finish())),
            }
        }
        all.sort_by_key(|(end, ..)| end.iterating);
        let (end, exchange, curve) = all.swap_remove((all.len() - 1) / 2);
        let (latency_s, seconds_per_byte) = self.prices;
        let exchange = Exchange { latency_s, seconds_per_byte, ..exchange };
        let timing = Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing };
        let outcome = Outcome { status: known.ending(end.status), ..end };
        let subdomains = shared.team.subdomains() as u32;
        let run = ended_row(Run { timing, exchange, subdomains, ..row }, &outcome, &curve);
        Ok(Some(Record { run, curve, snapshots: Vec::new() }))
    }
}
