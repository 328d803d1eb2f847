//! Newton's method on the statuses of contacts, begun by accelerated sweeps, then by plain ones where these come no nearer.

use crate::LocalProblem;
use crate::exact::{Exact, Own};
use crate::newton::Newton;
use crate::sweeps::Sweeps;
use contact::acceleration::{Acceleration, LAG};
use contact::{Iteration, SetupError, Work};

/// One rung of the ladder over the one before (–): at each Newton's method has a try.
const RUNG: f64 = 0.1;

/// Rungs that a ladder has at most: as many decades lie between the greatest number and the least.
const RUNGS: usize = 633;

/// Sweeps in which what is left must be halved: accelerated ones, or plain ones follow; plain ones, or the run ends.
const PATIENCE_OF_ACCELERATED: u64 = 1000;
const PATIENCE: u64 = 20_000;

/// Sweeps from one look at what they leave to the next.
const LOOK: u64 = 10;

/// Time that a factor takes for each entry of W, and a sweep for each contact (ns): measured on dumps of 82 to 356 contacts, on which a factor
/// took 70 to 140 ns an entry, whatever its multiply-adds, and a sweep 40 to 53 ns a contact.
const ENTRY: u64 = 100;
const VISIT: u64 = 45;

/// Largest residual of the law at an end where no step reduces it, over the problem's scale (–): else it is no end.
const AT_THE_END: f64 = 1e-12;

enum Phase<'p, const D: usize> {
    Accelerated(Sweeps<'p, D>),
    Plain(Sweeps<'p, D>),
    Ended,
}

/// A run on one problem.
pub(crate) struct ActiveSet<'p, const D: usize> {
    problem: &'p LocalProblem,
    phase: Phase<'p, D>,
    newton: Newton<'p, D>,
    /// Residual before Newton's method has its step, while it has a try (√J).
    trying: Option<f64>,
    /// Next residual threshold (√J).
    rung: f64,
    /// √ of the problem's scale (√J).
    scale: f64,
    /// The impulses that leave least (N·s), and what they leave (√J).
    best: (Vec<f64>, f64),
    /// Iterations of the phase, and what was left when it was last halved, at which of them (√J).
    iterations: u64,
    halved: (f64, u64),
    /// Sweeps that take the time of a factor.
    sweeps_of_factor: u64,
    /// Work of the phase that ended.
    work: Work,
}

impl<'p, const D: usize> ActiveSet<'p, D>
where
    Own<D>: Exact<D>,
{
    /// From r = 0, by accelerated sweeps to `start_accuracy` (–).
    ///
    /// # Errors
    /// Those of [`Sweeps::new`]: there are none.
    pub(crate) fn new(problem: &'p LocalProblem, start_accuracy: f64) -> Result<Self, SetupError> {
        let scale = problem.scale().sqrt();
        let momentum = Acceleration::Nesterov.momentum(LAG, None)?;
        Ok(Self {
            problem,
            phase: Phase::Accelerated(Sweeps::new(problem, 1, momentum)?),
            newton: Newton::new(problem),
            trying: None,
            rung: start_accuracy * scale,
            scale,
            best: (vec![0.0; problem.q().len()], scale),
            iterations: 0,
            halved: (scale, 0),
            sweeps_of_factor: sweeps_of_factor::<D>(problem),
            work: Work::default(),
        })
    }

    /// Takes the impulses `r` (N·s) for the best, if they leave less of the law; returns what they leave (√J).
    fn take(&mut self, r: Vec<f64>) -> f64 {
        let left = self.problem.left(&r, &self.problem.velocity(&r));
        if left < self.best.1 {
            self.best = (r, left);
        }
        left
    }

    /// One sweep, and from time to time a look at what it leaves.
    fn approach(&mut self) {
        let (Phase::Accelerated(sweeps) | Phase::Plain(sweeps)) = &mut self.phase else { return };
        self.iterations += 1;
        sweeps.advance();
        if !self.iterations.is_multiple_of(LOOK) {
            return;
        }
        let mut r = vec![0.0; self.best.0.len()];
        sweeps.impulses(&mut r);
        let left = self.take(r);
        let is_plain = matches!(self.phase, Phase::Plain(_));
        let patience = if is_plain { PATIENCE } else { PATIENCE_OF_ACCELERATED };
        if left <= 0.5 * self.halved.0 {
            self.halved = (left, self.iterations);
        }
        if left <= self.rung && self.is_due() {
            self.rung = next_rung(self.rung, left);
            self.newton.begin(&self.best.0);
            self.trying = Some(left);
        } else if self.iterations >= self.halved.1 + patience || !left.is_finite() {
            self.next_phase();
        }
    }

    /// Reports whether sweeps have taken the time of all factors, the next among them.
    fn is_due(&self) -> bool {
        let visits = self.work_of_phases().contact_updates;
        let sweeps = visits / self.problem.contact_count().max(1) as u64;
        sweeps >= (self.newton.work().factorisations + 1) * self.sweeps_of_factor
    }

    fn next_phase(&mut self) {
        self.work = self.work_of_phases();
        let phase = match std::mem::replace(&mut self.phase, Phase::Ended) {
            Phase::Accelerated(_) => Sweeps::new(self.problem, 1, None).ok(),
            _ => None,
        };
        if let Some(mut sweeps) = phase {
            sweeps.begin(&self.best.0);
            self.phase = Phase::Plain(sweeps);
        }
        (self.iterations, self.halved) = (0, (self.best.1, 0));
    }

    /// One step of Newton's method; where it leaves no less, what came before goes on.
    fn newton(&mut self, before: f64) {
        let has_factor = self.newton.step();
        let left = self.take(self.newton.impulses());
        if self.newton.is_round_off(left) {
            self.trying = None;
            self.next_to_end();
        } else if !has_factor || !(left < before) {
            self.trying = None;
            if self.best.1 <= AT_THE_END * self.scale {
                self.next_to_end();
            }
        } else {
            self.trying = Some(left);
        }
    }

    fn next_to_end(&mut self) {
        self.work = self.work_of_phases();
        self.phase = Phase::Ended;
    }

    fn work_of_phases(&self) -> Work {
        let mut work = self.work;
        if let Phase::Accelerated(sweeps) | Phase::Plain(sweeps) = &self.phase {
            work += sweeps.work();
        }
        work
    }
}

/// Returns the sweeps that take the time of a factor of W, all contacts closed.
fn sweeps_of_factor<const D: usize>(problem: &LocalProblem) -> u64 {
    let contacts = problem.contact_count();
    let blocks: usize = (0..contacts).map(|contact| problem.row::<D>(contact).count()).sum();
    ((D * D * blocks) as u64 * ENTRY).div_ceil((contacts as u64 * VISIT).max(1))
}

/// The first rung from `rung` down that is below what is `left` (√J); 0 where nothing is.
fn next_rung(rung: f64, left: f64) -> f64 {
    let rungs = std::iter::successors(Some(rung), |rung| Some(RUNG * rung));
    rungs.take(RUNGS).find(|rung| *rung < left).unwrap_or(0.0)
}

impl<const D: usize> Iteration for ActiveSet<'_, D>
where
    Own<D>: Exact<D>,
{
    fn advance(&mut self) {
        match self.trying {
            Some(before) => self.newton(before),
            None => self.approach(),
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        match &self.phase {
            Phase::Accelerated(sweeps) | Phase::Plain(sweeps) if self.trying.is_none() => sweeps.impulses(r),
            _ => r.copy_from_slice(&self.best.0),
        }
    }

    fn stalled(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    fn work(&self) -> Work {
        let mut work = self.work_of_phases();
        work += self.newton.work();
        work
    }
}
