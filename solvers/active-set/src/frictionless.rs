//! Without friction: sweeps, sets and an interior point, each in its turn.
//!
//! Near a solution each set is nearly that of the solution, and the last is it: the iterate is then exact. Far from it sets can
//! wander or come back. So an iteration is one of three: a sweep, until what is left of the law is small, or an interior point would
//! have been cheaper; of the active set, as long as each few sets leave less than all before; of an interior point, which finds its way
//! from anywhere, until what is left is a hundredth of what it was, and the active set tries again. No set is tried before the start has
//! taken the time of its factor: so the way that was not needed costs no more than the one that was. Where sets wander, sweeps resume
//! to a tenth of what was left, as long as they may; then the interior point has its turn. Where that fails too, sweeps begin anew
//! from the best impulses, twice as many each time. Conjugate gradients may take the place of sweeps.

use crate::inner::{Inner, Whole};
use crate::interior::Interior;
use crate::scaled::Scaled;
use crate::set::Set;
use crate::start::{Begun, RUNG, STEPS, Start};
use crate::{ActiveSet, Best};
use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work};

/// Sets one after the other that leave no less than one before, after which another way is taken.
const PATIENCE: u32 = 8;

/// Largest ratio of the residual after an interior point's steps to that before them (–).
const NEARER: f64 = 1e-2;

/// Phase of an iteration.
#[derive(Clone, Copy)]
enum Phase {
    /// The start.
    Begun,
    /// Sets.
    Set,
    /// An interior point, until so much is left (√J).
    Interior { until: f64 },
    /// No further iteration helps.
    Ended,
}

/// A run of the active set, with what solves with the matrices of its sets.
pub struct Run<'p, const D: usize, K: Inner<D> = Whole<D>> {
    problem: &'p Packing<Smooth<D>>,
    set: Set<D, K>,
    phase: Phase,
    /// Method of the start, and of what follows where all else fails; its run, iterations, and how many it may take.
    start: Start,
    begun: Option<Begun<'p, D>>,
    iterations: u64,
    most: u64,
    /// Iterations that take as long as a factor, and those after which a set may be taken.
    of_factor: u64,
    due: u64,
    interior: Option<Interior>,
    /// True where the interior point found no way on.
    is_lost: bool,
    /// Residual that the start is to reach, and with which it last ended (√J).
    accuracy: f64,
    handed: f64,
    /// Work of the starts that ended.
    ended: Work,
    /// √(Σ max(0, −b)²/`W_αα`) (√J).
    scale: f64,
    best: Best,
    tries: Tries,
    /// Impulses that prove that there is no solution (N·s).
    ray: Option<Vec<f64>>,
}

/// The sets since the last change of phase.
#[derive(Default)]
struct Tries {
    sets: Vec<u64>,
    in_vain: u32,
}

impl<const D: usize, K: Inner<D>> Run<'_, D, K> {
    /// Returns the linear solver for the matrices of its sets.
    pub fn inner(&self) -> &K {
        &self.set.scaled.inner
    }

    /// Makes one iteration of the start, and at times looks at its residual.
    fn begin(&mut self) {
        let Some(begun) = &mut self.begun else { return };
        begun.advance();
        self.iterations += 1;
        let is_over = self.iterations == self.most;
        if !(is_over || self.iterations >= self.due && begun.is_due(self.iterations, self.accuracy)) {
            return;
        }
        let mut r = vec![0.0; self.best.impulses.len()];
        begun.run().impulses(&mut r);
        self.set.begin(&r);
        let left = self.set.left();
        self.best.take(left, |best| best.copy_from_slice(&r));
        if is_over || matches!(begun, Begun::Gradient(_)) || left <= self.accuracy {
            self.handed = left;
            self.phase = Phase::Set;
        }
    }

    /// One set. Where it is the last one and leaves as much as before, there may be no solution.
    fn set(&mut self) {
        let before = self.set.left();
        let changed = self.set.step();
        self.judge(before, changed);
    }

    fn judge(&mut self, before: f64, changed: Option<usize>) {
        let left = self.set.left();
        let is_better = self.best.take(left, |r| self.set.impulses(r));
        if self.set.is_solved() {
            self.phase = Phase::Ended;
        } else if changed.is_none() || !left.is_finite() {
            self.other_way();
        } else if changed == Some(0) && !(left < 0.5 * before) {
            self.ray = self.set.ray(self.problem);
            if self.ray.is_some() { self.phase = Phase::Ended } else { self.other_way() }
        } else {
            let fingerprint = self.set.fingerprint();
            let came_back = changed != Some(0) && self.tries.sets.contains(&fingerprint);
            self.tries.sets.push(fingerprint);
            self.tries.in_vain = if is_better { 0 } else { self.tries.in_vain + 1 };
            if came_back || self.tries.in_vain == PATIENCE {
                self.other_way();
            }
        }
    }

    /// Changes to the phase that follows where sets wander: the start resumes, an interior point has its turn, or the start begins anew.
    fn other_way(&mut self) {
        self.tries = Tries::default();
        if self.begun.is_some() && self.iterations < self.most {
            self.accuracy = RUNG * self.accuracy.min(self.best.left);
            self.due = self.iterations + self.of_factor;
            // Sets may have come nearer before they wandered.
            if self.best.left < self.handed { self.begin_from_best() } else { self.phase = Phase::Begun }
        } else if self.is_lost {
            self.begin_anew();
        } else {
            let left = self.interior.as_ref().map_or(self.scale, Interior::left);
            self.phase = Phase::Interior { until: NEARER * left };
        }
    }

    fn begin_anew(&mut self) {
        if self.begun.is_some() {
            self.most = self.most.saturating_mul(2);
        }
        (self.iterations, self.due) = (0, self.of_factor);
        self.begin_from_best();
    }

    fn begin_from_best(&mut self) {
        // What was possible once is so again.
        let Ok(begun) = Begun::new(self.start, self.problem, &self.best.impulses) else { return };
        if let Some(ended) = self.begun.replace(begun) {
            self.ended += ended.run().work();
        }
        self.phase = Phase::Begun;
    }

    fn interior(&mut self, until: f64) {
        let scale = self.scale;
        let scaled = self.set.lend_factor();
        let interior = self.interior.get_or_insert_with(|| Interior::new(scaled, scale));
        if !interior.step(scaled) {
            self.is_lost = true;
            self.ray = self.set.ray_of(self.problem, &interior.s);
            if self.ray.is_some() { self.phase = Phase::Ended } else { self.begin_anew() }
        } else if interior.left() > until {
            let scaled = &self.set.scaled;
            self.best.take(interior.left(), |r| scaled.impulses(&interior.s, r));
        } else {
            self.set.s.copy_from_slice(&interior.s);
            let closed = interior.s.iter().zip(&interior.t).map(|(s, t)| s > t).collect();
            self.phase = Phase::Set;
            self.set.measure();
            let before = self.set.left();
            let changed = self.set.hold(closed);
            self.judge(before, changed);
        }
    }
}

impl<const D: usize, K: Inner<D>> Iteration for Run<'_, D, K> {
    fn advance(&mut self) {
        match self.phase {
            Phase::Begun => self.begin(),
            Phase::Set => self.set(),
            Phase::Interior { until } => self.interior(until),
            Phase::Ended => {}
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        match (self.phase, &self.ray, &self.begun) {
            (_, Some(ray), _) => r.copy_from_slice(ray),
            (Phase::Begun, _, Some(begun)) => begun.run().impulses(r),
            _ => r.copy_from_slice(&self.best.impulses),
        }
    }

    fn stalled(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    fn work(&self) -> Work {
        let mut work = self.set.work();
        work += self.ended;
        self.begun.iter().for_each(|begun| work += begun.run().work());
        work
    }
}

impl ActiveSet {
    /// The run that [`Solver::start`] begins, with `inner` in the place of one factor of the whole.
    ///
    /// # Errors
    /// As there.
    pub fn run<'p, const D: usize, K: Inner<D>>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
        inner: K,
    ) -> Result<Run<'p, D, K>, SetupError> {
        let start = self.start.unwrap_or_default();
        let accuracy = self.accuracy(start.accuracy())?;
        let mut set = Set::on(Scaled::new(problem, inner));
        let scale = problem.scale().sqrt();
        let of_factor = start.iterations_of(set.scaled.inner.cost(), set.scaled.contacts(), 1);
        set.begin(r0);
        // Sweeps begin from them.
        let is_warm = self.warm && start != Start::Sweeps && r0.iter().any(|r| *r > 0.0);
        let phase = match start {
            Start::ColdSet => Phase::Set,
            _ if is_warm => Phase::Set,
            Start::InteriorPoint => Phase::Interior { until: NEARER * NEARER * scale },
            Start::Sweeps | Start::Cg => Phase::Begun,
        };
        let begun = matches!(phase, Phase::Begun).then(|| Begun::new(start, problem, r0)).transpose()?;
        let best = Best { left: set.left(), impulses: r0.to_vec() };
        Ok(Run {
            problem,
            set,
            phase,
            start,
            begun,
            iterations: 0,
            most: (STEPS * of_factor).max(1.0) as u64,
            of_factor: of_factor as u64,
            due: of_factor as u64,
            interior: None,
            is_lost: false,
            accuracy: accuracy * scale,
            handed: f64::INFINITY,
            ended: Work::default(),
            scale,
            best,
            tries: Tries::default(),
            ray: None,
        })
    }
}

impl<const D: usize> Solver<Smooth<D>> for ActiveSet {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Ok(Box::new(self.run(problem, r0, Whole::new(problem)?)?))
    }
}
