//! The start of the active set: sweeps or conjugate gradients, how near they are to come, and how long they may take.

use cg::Cg;
use contact::acceleration::Acceleration;
use contact::{Iteration, Mechanics, Packing, SetupError, Smooth, Solver};
use nsgs::Nsgs;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Method that finds the first set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// By conjugate gradients, preconditioned by the diagonal of W; for problems without friction.
    Cg,
    /// By accelerated sweeps of Gauss-Seidel.
    #[default]
    Sweeps,
    /// By the law from the start impulses: without any, the contacts that approach.
    ColdSet,
    /// By an interior point; with friction by convex programmes, which mostly come near in packings at rest, and seldom where walls move.
    InteriorPoint,
}

/// Residual of the law at which the first set is taken, as a natural map (–). On 18 packings of 60 to 10,000 discs and 250 to 3,000
/// spheres 1e-3 takes in the mean 1.2 times as long as the best of 1e-2 to 3e-4 for each, and never more than 2.5 times.
const ACCURACY: f64 = 1e-3;

/// That with friction, with conjugate gradients, and where there is W alone (–). It was chosen for conjugate gradients, on 18 packings of discs, and
/// taken over for the others.
pub const ACCURACY_OF_DEARER: f64 = 3e-3;

/// Steps of an interior point that the start may take the time of (–): twice those that lead to the neighbourhood of a solution.
pub(crate) const STEPS: f64 = 28.0;

/// Time of an accelerated sweep at a contact with so many unknowns, and of an iteration of the conjugate gradient at one with one (ns).
const SWEEP: [f64; 3] = [4.0, 9.0, 20.0];
const GRADIENT: f64 = 6.0;

/// Ratio of a residual at which sets, or Newton's method, are tried to that of the last try (–).
pub(crate) const RUNG: f64 = 0.1;

/// Sweeps from one look at the residual to the next: a look costs about as much as two.
pub(crate) const LOOK: u64 = 25;

impl Start {
    /// Returns the accuracy to which it is run unless another is given (–).
    pub(crate) fn accuracy(self) -> f64 {
        if self == Self::Cg { ACCURACY_OF_DEARER } else { ACCURACY }
    }

    /// Returns how many iterations take as long as a factor and two solves with it, of so many multiply-adds and entries, where there are
    /// so many `contacts` with so many `unknowns` each: 0.1 ns per multiply-add, 3 ns per entry, and 30 ns per contact.
    pub(crate) fn iterations_of(
        self,
        (multiply_adds, entries): (u64, usize),
        contacts: usize,
        unknowns: usize,
    ) -> f64 {
        let factor = (0.1 * multiply_adds as f64 + 3.0 * entries as f64) / contacts.max(1) as f64 + 30.0;
        factor / if self == Self::Cg { GRADIENT } else { SWEEP[unknowns - 1] }
    }
}

/// Run of the start.
pub(crate) enum Begun<'p, const D: usize> {
    Sweeps(Box<dyn Iteration + 'p>),
    /// Its residual is known after each iteration.
    Gradient(Box<cg::GrainRun<Smooth<D>>>),
}

impl<'p, const D: usize> Begun<'p, D> {
    /// Begins the method of `start` on a `problem`, from impulses (N·s).
    pub(crate) fn new(start: Start, problem: &'p Packing<Smooth<D>>, r0: &[f64]) -> Result<Self, SetupError> {
        if start == Start::Cg {
            let run = Cg::preconditioned().run(problem, r0)?;
            return Ok(Self::Gradient(Box::new(run)));
        }
        accelerated(problem, r0).map(Self::Sweeps)
    }

    /// Reports whether its residual is to be looked at after so many iterations: of the gradient, where that has come to an `accuracy` (√J).
    pub(crate) fn is_due(&self, iterations: u64, accuracy: f64) -> bool {
        match self {
            Self::Sweeps(_) => iterations.is_multiple_of(LOOK),
            Self::Gradient(run) => run.left() <= accuracy,
        }
    }

    pub(crate) fn run(&self) -> &dyn Iteration {
        match self {
            Self::Sweeps(run) => &**run,
            Self::Gradient(run) => &**run,
        }
    }

    pub(crate) fn advance(&mut self) {
        match self {
            Self::Sweeps(run) => run.advance(),
            Self::Gradient(run) => run.advance(),
        }
    }
}

/// Begins accelerated sweeps from the impulses `r0` (N·s).
pub(crate) fn accelerated<'p, M: Mechanics>(
    problem: &'p Packing<M>,
    r0: &[f64],
) -> Result<Box<dyn Iteration + 'p>, SetupError> {
    Nsgs { acceleration: Acceleration::Nesterov, ..Nsgs::default() }.start(problem, r0)
}
