//! Newton's method on the statuses of contacts, begun by conjugate gradients, then by sweeps where these come no nearer.

use crate::exact::{Exact, Own};
use crate::gradient::Stored;
use crate::newton::Newton;
use crate::sweeps::Sweeps;
use crate::{LocalProblem, gradient};
use cg::{ConeRun, Preconditioner};
use contact::{Iteration, Work};

/// One rung of the ladder over the one before (–): at each Newton's method has a try.
const RUNG: f64 = 0.1;

/// Rungs that a ladder has at most: as many decades lie between the greatest number and the least.
const RUNGS: usize = 633;

/// Iterations in which what is left must be halved: conjugate gradients, or sweeps follow; sweeps, or the run ends.
const PATIENCE: u64 = 200;
const PATIENCE_OF_SWEEPS: u64 = 20_000;

/// Sweeps from one look at what they leave to the next.
const LOOK: u64 = 10;

/// Largest residual of the law at an end where no step reduces it, over the problem's scale (–): else it is no end.
const AT_THE_END: f64 = 1e-12;

enum Phase<'p, const D: usize> {
    Gradient(Box<ConeRun<Stored<'p, D>, D>>),
    Sweeps(Box<Sweeps<'p, D>>),
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
    /// Work of the phase that ended.
    work: Work,
}

impl<'p, const D: usize> ActiveSet<'p, D>
where
    Own<D>: Exact<D>,
{
    /// From r = 0, by conjugate gradients to `start_accuracy` (–).
    pub(crate) fn new(problem: &'p LocalProblem, start_accuracy: f64) -> Self {
        let scale = problem.scale().sqrt();
        Self {
            problem,
            phase: Phase::Gradient(Box::new(gradient(problem, Preconditioner::Diagonal))),
            newton: Newton::new(problem),
            trying: None,
            rung: start_accuracy * scale,
            scale,
            best: (vec![0.0; problem.q().len()], scale),
            iterations: 0,
            halved: (scale, 0),
            work: Work::default(),
        }
    }

    /// Takes the impulses `r` (N·s) for the best, if they leave less of the law; returns what they leave (√J).
    fn take(&mut self, r: Vec<f64>) -> f64 {
        let left = self.problem.left(&r, &self.problem.velocity(&r));
        if left < self.best.1 {
            self.best = (r, left);
        }
        left
    }

    /// One iteration of the gradient or of the sweeps, and a look at what it leaves.
    fn approach(&mut self) {
        self.iterations += 1;
        let (left, patience) = match &mut self.phase {
            Phase::Gradient(run) => {
                run.advance();
                let left = run.left();
                if left < self.best.1 {
                    run.impulses(&mut self.best.0);
                    self.best.1 = left;
                }
                (left, PATIENCE)
            }
            Phase::Sweeps(sweeps) => {
                sweeps.advance();
                if !self.iterations.is_multiple_of(LOOK) {
                    return;
                }
                let mut r = vec![0.0; self.best.0.len()];
                sweeps.impulses(&mut r);
                (self.take(r), PATIENCE_OF_SWEEPS)
            }
            Phase::Ended => return,
        };
        if left <= 0.5 * self.halved.0 {
            self.halved = (left, self.iterations);
        }
        if left <= self.rung {
            self.rung = next_rung(self.rung, left);
            self.newton.begin(&self.best.0);
            self.trying = Some(left);
        } else if self.iterations >= self.halved.1 + patience || !left.is_finite() {
            self.next_phase();
        }
    }

    fn next_phase(&mut self) {
        let ended = std::mem::replace(&mut self.phase, Phase::Ended);
        if let Phase::Gradient(run) = ended {
            self.work = run.work();
            if let Ok(mut sweeps) = Sweeps::new(self.problem, 1, None) {
                sweeps.begin(&self.best.0);
                self.phase = Phase::Sweeps(Box::new(sweeps));
            }
        } else if let Phase::Sweeps(sweeps) = ended {
            self.work += sweeps.work();
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
        match &self.phase {
            Phase::Gradient(run) => work += run.work(),
            Phase::Sweeps(sweeps) => work += sweeps.work(),
            Phase::Ended => {}
        }
        work
    }
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
            Phase::Gradient(run) if self.trying.is_none() => run.impulses(r),
            Phase::Sweeps(sweeps) if self.trying.is_none() => sweeps.impulses(r),
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
