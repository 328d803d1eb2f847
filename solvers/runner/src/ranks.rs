//! The loop where ranks share a problem: each advances its own subdomains, and all measure and decide together.

use crate::{Measured, Outcome, Progress, Stop, run};
use analysis::Meter;
use contact::{Iteration, Measure, Mechanics, SetupError, Work};
use partition::{Distributed, Refused, Share, Team, Traffic};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Largest natural map of a solution (–), as of those that are certified.
const SOLVED: f64 = 1e-8;

/// Result of a run on ranks: the same at all of them, but for the impulses.
#[derive(Clone, Debug)]
pub struct OnRanks {
    /// Outcome of the run: the impulses of this rank's contacts, seconds of the rank that took longest, work of all ranks. What the
    /// last change moves is not computed.
    pub outcome: Outcome,
    /// Data that each rank sent while it advanced, and the time it waited.
    pub traffic: Vec<Traffic>,
    /// The rank that worked longest while it advanced: all others waited for it, in the end.
    pub slowest: usize,
}

/// Impulses of a rank beside its share of a problem, in the order of its contacts (N·s).
#[derive(Clone, Copy, Debug)]
pub struct Beside<'r> {
    /// The impulses to begin from.
    pub start: &'r [f64],
    /// Solutions: errors are measured to the nearest. All ranks have as many.
    pub solutions: &'r [Vec<f64>],
}

/// Counts what a rank sends while it advances, without what is sent to measure.
struct Counted<'i> {
    iteration: Box<dyn Iteration + 'i>,
    team: Team,
    traffic: Traffic,
}

impl Iteration for Counted<'_> {
    fn advance(&mut self) {
        let before = self.team.traffic();
        self.iteration.advance();
        self.traffic += self.team.traffic().since(&before);
    }

    fn impulses(&self, r: &mut [f64]) {
        self.iteration.impulses(r);
    }

    fn velocity_jump(&self) -> f64 {
        self.iteration.velocity_jump()
    }

    fn stalled(&self) -> bool {
        self.iteration.stalled()
    }

    fn derived(&self) -> Vec<(&'static str, f64)> {
        self.iteration.derived()
    }

    fn critical_path(&self) -> Option<u64> {
        self.iteration.critical_path()
    }

    /// Returns the work of all ranks, which all must ask for.
    fn work(&self) -> Work {
        of_all(self.iteration.work(), &self.team)
    }
}

/// Runs `solver` until `stop` on the problem of which this rank has a `share`; all ranks of the `team` must do it, each
/// with what it has `beside`. The observer sees the measures and the work of all, and the impulses of this rank; where one ends the
/// run, all do.
///
/// The measures are those of one machine but for round-off, since each subdomain adds up its contacts, then a tree all subdomains:
/// so they are the same bits for any number of ranks.
///
/// # Errors
/// As on one machine, at all ranks if at one.
pub fn solve_on_ranks<M: Mechanics>(
    solver: &dyn Distributed<M>,
    share: &Share<M>,
    team: &Team,
    Beside { start, solutions }: Beside<'_>,
    stop: &Stop,
    measured: Measured,
    observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<OnRanks, Refused> {
    stop.check()?;
    let expected = "another measure: the true velocity of this problem is not known";
    let is_known = !solutions.is_empty() || stop.on != Measure::VelocityError;
    SetupError::unless(is_known, "on", stop.on, expected)?;
    team.unless_refused(share.problem.unless_admissible(start))?;
    let mut judge = Meter::over(share, team);
    for (k, solution) in solutions.iter().enumerate() {
        let left = judge.against_impulses(solution);
        let expected = "impulses that solve this problem, which leave a natural map of at most 1e-8";
        SetupError::unless(
            left <= SOLVED,
            "solution",
            format!("number {k}, which leaves {left:e}"),
            expected,
        )?;
    }
    let clock = Instant::now();
    let iteration = solver.start_in(share, start, team)?;
    let setup = clock.elapsed();
    let mut counted = Counted { iteration, team: team.clone(), traffic: Traffic::default() };
    let (end, _) = run(&mut judge, &mut counted, start.to_vec(), stop, measured, observe);
    let Traffic { messages, bytes, waiting_ns } = counted.traffic;
    let nanoseconds = [setup, end.iterating].map(|time| time.as_nanos() as f64);
    let counts = [messages, bytes, waiting_ns].map(|count| count as f64);
    let of_ranks = team.gather(&[&nanoseconds[..], &counts[..]].concat());
    let longest = |k: usize| {
        let longest = of_ranks.iter().map(|of_rank| of_rank[k]).fold(0.0, f64::max);
        Duration::from_nanos(longest as u64)
    };
    let worked = |rank: &usize| of_ranks[*rank][1] - of_ranks[*rank][4];
    let slowest = (0..team.size()).max_by(|a, b| worked(a).total_cmp(&worked(b))).unwrap_or(0);
    let traffic = of_ranks.iter().map(|of_rank| {
        let [messages, bytes, waiting_ns] = [2, 3, 4].map(|k| of_rank[k] as u64);
        Traffic { messages, bytes, waiting_ns }
    });
    let outcome = Outcome { setup: longest(0), iterating: longest(1), ..end };
    Ok(OnRanks { outcome, traffic: traffic.collect(), slowest })
}

/// The work of all ranks; a product W p is one of all.
fn of_all(work: Work, team: &Team) -> Work {
    let own = work.named().map(|(_, count)| count as f64);
    let first = team.mine().start;
    // Exact below 2⁵³.
    let own = team.mine().map(|e| if e == first { own } else { [0.0; 6] });
    let all = Work::of(team.sum(own).map(|count| count as u64));
    Work { delassus_products: work.delassus_products, ..all }
}
