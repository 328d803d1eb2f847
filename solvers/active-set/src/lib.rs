//! Primal-dual active set on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r, begun by conjugate gradients: the solution to round-off
//! for a few sparse factorisations.
//!
//! M. Hintermüller, K. Ito, K. Kunisch, The primal-dual active set strategy as a semismooth Newton method, SIAM J. Optim. 13
//! (2002) 865-888; with the proximal term of R. T. Rockafellar, Augmented Lagrangians and applications of the proximal point
//! algorithm in convex programming, Math. Oper. Res. 1 (1976) 97-116, which keeps the matrix regular where more contacts are closed
//! than equilibrium needs, and chooses among their impulses those nearest to the given ones.
//!
//! Near a solution each set is nearly that of the solution, and the last is it: the iterate is then exact. Far from it sets can
//! wander or come back. So an iteration is one of three: of the conjugate gradient, until what is left of the law is small, or an
//! interior point would have been cheaper; of the active set, as long as each few sets leave less than all before; of an interior
//! point, which finds its way from anywhere, until what is left is a hundredth of what it was, and the active set tries again. Where
//! the interior point finds no way on either, conjugate gradients go on from the best impulses, twice as long each time.
//!
//! With friction accelerated sweeps of Gauss-Seidel take the place of conjugate gradients, Newton's method on the statuses open, stick
//! and slide that of the set, and proximal points that of the interior point (`frictional.rs`).

mod cone;
mod convex;
mod frictional;
mod inner;
mod interior;
mod scaled;
mod set;

pub use convex::Convex;
pub use inner::{Inner, PENALTY, Whole};
pub use set::Set;

use cg::{Cg, Preconditioner};
use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work};
use interior::Interior;
use scaled::Scaled;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Method that finds the first set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// By conjugate gradients, preconditioned by the diagonal of W; for problems without friction, whose default it is.
    Cg,
    /// By accelerated sweeps of Gauss-Seidel; for problems with friction, whose default it is.
    Sweeps,
    /// By the law from the start impulses: without any, the contacts that approach.
    ColdSet,
    /// By an interior point; for problems without friction.
    InteriorPoint,
}

/// Settings of the active set.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ActiveSet {
    /// Method that finds the first set: unless given `cg`, with friction `sweeps`.
    pub start: Option<Start>,
    /// Residual of the law at which the first set is taken, as a natural map (–).
    pub start_accuracy: f64,
    /// Warm start: start impulses, where there are some, take the place of `start`: the first set is theirs, with friction if they
    /// reach `start_accuracy`.
    pub warm: bool,
}

/// On 18 packings of 60 to 10,000 discs, frozen, settled and deposited, this takes in the mean 1.2 times as long as the best of
/// 1e-1 to 1e-3 for each, and never more than 2.1 times; 1e-2 likewise, but up to 2.8 times.
impl Default for ActiveSet {
    fn default() -> Self {
        Self { start: None, start_accuracy: 3e-3, warm: true }
    }
}

/// Sets one after the other that leave no less than one before, after which another way is taken.
const PATIENCE: u32 = 8;

/// Largest ratio of the residual after an interior point's steps to that before them (–).
const NEARER: f64 = 1e-2;

/// Steps of an interior point that a conjugate gradient may take the time of (–): twice those that lead to the neighbourhood of a
/// solution.
const STEPS: f64 = 28.0;

/// Phase of an iteration.
enum Phase<const D: usize> {
    /// Conjugate gradients, for so many iterations at most.
    Gradient { run: Box<cg::Run<D>>, iterations: u64, most: u64 },
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
    phase: Phase<D>,
    interior: Option<Interior>,
    /// True where the interior point found no way on.
    is_lost: bool,
    /// Residual that the conjugate gradient is to reach (√J).
    accuracy: f64,
    /// Iterations that the next conjugate gradient may take.
    most: u64,
    /// Products of the conjugate gradients that ended.
    products: u64,
    /// √(Σ max(0, −b)²/`W_αα`) (√J).
    scale: f64,
    best: Best,
    tries: Tries,
    /// Impulses that prove that there is no solution (N·s).
    ray: Option<Vec<f64>>,
}

/// The impulses that leave least of the law, of all since the first set or step: what the run shows. Between good sets there are
/// some that hold what cannot be held, with impulses beyond all measure.
pub(crate) struct Best {
    /// Residual of these impulses (√J).
    left: f64,
    /// N·s, in the problem's order.
    impulses: Vec<f64>,
}

/// The sets since the last change of phase.
#[derive(Default)]
struct Tries {
    sets: Vec<u64>,
    in_vain: u32,
}

impl Best {
    /// Takes the impulses that `give` writes if they leave less; says whether they do.
    pub(crate) fn take(&mut self, left: f64, give: impl FnOnce(&mut [f64])) -> bool {
        let is_better = left < self.left;
        if is_better {
            self.left = left;
            give(&mut self.impulses);
        }
        is_better
    }
}

impl<const D: usize, K: Inner<D>> Run<'_, D, K> {
    /// Returns the linear solver for the matrices of its sets.
    pub fn inner(&self) -> &K {
        &self.set.scaled.inner
    }

    fn gradient(&mut self) {
        let Phase::Gradient { run, iterations, most } = &mut self.phase else { return };
        run.advance();
        *iterations += 1;
        if run.left() <= self.accuracy || iterations == most {
            self.products += run.work().delassus_products;
            run.impulses(&mut self.best.impulses);
            self.set.begin(&self.best.impulses);
            self.best.left = self.set.left();
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

    /// Changes to the phase that follows where sets wander.
    fn other_way(&mut self) {
        self.tries = Tries::default();
        if self.is_lost {
            self.begin_gradient();
        } else {
            let left = self.interior.as_ref().map_or(self.scale, Interior::left);
            self.phase = Phase::Interior { until: NEARER * left };
        }
    }

    fn begin_gradient(&mut self) {
        let cg = Cg { preconditioner: Preconditioner::Diagonal };
        // What was possible once is so again.
        if let Ok(run) = cg.run(self.problem, &self.best.impulses) {
            self.phase = Phase::Gradient { run: Box::new(run), iterations: 0, most: self.most };
        }
        self.most = self.most.saturating_mul(2);
    }

    fn interior(&mut self, until: f64) {
        let scale = self.scale;
        let scaled = self.set.lend_factor();
        let interior = self.interior.get_or_insert_with(|| Interior::new(scaled, scale));
        if !interior.step(scaled) {
            self.is_lost = true;
            self.ray = self.set.ray_of(self.problem, &interior.s);
            if self.ray.is_some() { self.phase = Phase::Ended } else { self.begin_gradient() }
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
            Phase::Gradient { .. } => self.gradient(),
            Phase::Set => self.set(),
            Phase::Interior { until } => self.interior(until),
            Phase::Ended => {}
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        match (&self.phase, &self.ray) {
            (_, Some(ray)) => r.copy_from_slice(ray),
            (Phase::Gradient { run, .. }, _) => run.impulses(r),
            _ => r.copy_from_slice(&self.best.impulses),
        }
    }

    fn stalled(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    fn work(&self) -> Work {
        let mut work = self.set.work();
        work.delassus_products += self.products;
        if let Phase::Gradient { run, .. } = &self.phase {
            work += run.work();
        }
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
        SetupError::unless_not_negative("start_accuracy", self.start_accuracy)?;
        let mut set = Set::on(Scaled::new(problem, inner));
        let scale = problem.scale().sqrt();
        let most = (STEPS * set.step_in_iterations()).max(1.0) as u64;
        set.begin(r0);
        let is_warm = self.warm && r0.iter().any(|r| *r > 0.0);
        let phase = match self.start {
            Some(Start::Sweeps) => {
                let expected = "cg, cold-set or interior-point: its sweeps are for problems with friction";
                return Err(SetupError::new("start", "sweeps", expected));
            }
            Some(Start::ColdSet) => Phase::Set,
            _ if is_warm => Phase::Set,
            Some(Start::InteriorPoint) => Phase::Interior { until: NEARER * NEARER * scale },
            None | Some(Start::Cg) => {
                let run = Cg { preconditioner: Preconditioner::Diagonal }.run(problem, r0)?;
                Phase::Gradient { run: Box::new(run), iterations: 0, most }
            }
        };
        let best = Best { left: set.left(), impulses: r0.to_vec() };
        Ok(Run {
            problem,
            set,
            phase,
            interior: None,
            is_lost: false,
            accuracy: self.start_accuracy * scale,
            most,
            products: 0,
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
