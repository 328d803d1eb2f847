//! The reference as a method of the line-up.

use crate::constraint::Constraint;
use crate::interior::{Interior, Verdict};
use active_set::Set;
use analysis::proves_infeasible;
use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the interior point. The start impulses are ignored: an interior point begins from its own centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct InteriorPoint {
    /// True where the iterations after the first, which is the interior point's whole run, are polish steps; else it ends with
    /// the first.
    pub polish: bool,
}

/// To round-off, as the reference needs it.
impl Default for InteriorPoint {
    fn default() -> Self {
        Self { polish: true }
    }
}

/// A run on one problem.
pub(crate) struct Run<'p, const D: usize> {
    problem: &'p Packing<Smooth<D>>,
    /// None where no contact pushes: r = 0.
    interior: Option<Interior>,
    polish: Set<D>,
    polishes: bool,
    r: Vec<f64>,
    ran: bool,
    /// Least residual of polished impulses, and the steps since it was halved.
    left: f64,
    in_vain: u32,
}

/// Polish steps that do not halve what is left after which no better impulses are to be expected.
const PATIENCE: u32 = 8;

impl<'p, const D: usize> Run<'p, D> {
    /// Lays the programme out; says why it cannot.
    pub(crate) fn new(problem: &'p Packing<Smooth<D>>, r0: &[f64], polishes: bool) -> Result<Self, String> {
        let pushed = problem.scale() > 0.0;
        let interior = if pushed { Some(Interior::new(problem, &Constraint::all(problem))?) } else { None };
        Ok(Self {
            problem,
            interior,
            polish: Set::new(problem).map_err(|error| error.to_string())?,
            polishes,
            r: r0.to_vec(),
            ran: false,
            left: f64::INFINITY,
            in_vain: 0,
        })
    }

    /// r of the interior point, 0 where no contact pushes.
    pub(crate) fn interior_point(&mut self) -> Verdict {
        self.ran = true;
        if let Some(interior) = &mut self.interior {
            interior.run(&mut self.r)
        } else {
            self.r.fill(0.0);
            Verdict::Solution
        }
    }

    /// One set, from the impulses that the one before left.
    pub(crate) fn polish(&mut self) {
        self.polish.begin(&self.r);
        let done = self.polish.step();
        self.polish.impulses(&mut self.r);
        let left = self.polish.left();
        if done.is_some() && left < 0.5 * self.left {
            (self.left, self.in_vain) = (left, 0);
        } else {
            self.in_vain += 1;
        }
    }

    /// Ends with the impulses of a proof of infeasibility, if they are near one.
    fn take_ray(&mut self) {
        let mut ray = self.r.clone();
        self.balance(&mut ray);
        if proves_infeasible(self.problem, &ray) {
            self.r = ray;
            self.polishes = false;
        }
    }

    /// See [`Set::balance`].
    pub(crate) fn balance(&mut self, ray: &mut [f64]) {
        self.polish.balance(ray);
    }

    /// r (N·s).
    pub(crate) fn impulses(&self) -> &[f64] {
        &self.r
    }
}

impl<const D: usize> Iteration for Run<'_, D> {
    fn advance(&mut self) {
        if !self.ran {
            if self.interior_point() == Verdict::Infeasible {
                self.take_ray();
            }
        } else if self.polishes {
            self.polish();
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn stalled(&self) -> bool {
        self.ran && (!self.polishes || self.in_vain >= PATIENCE)
    }

    /// Clarabel counts its factorisations; the entries of its solves it does not tell, so those are the polish's alone.
    fn work(&self) -> Work {
        let of_interior = self.interior.as_ref().filter(|_| self.ran).map_or(0, Interior::factorisations);
        let Work { factorisations, triangular_solve_entries, .. } = self.polish.work();
        Work { factorisations: of_interior + factorisations, triangular_solve_entries, ..Work::default() }
    }
}

impl<const D: usize> Solver<Smooth<D>> for InteriorPoint {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let run = Run::new(problem, r0, self.polish);
        // What no validated problem gives, unless its numbers overflow when scaled.
        Ok(Box::new(run.map_err(|why| SetupError::new("problem", why, "one whose numbers can be scaled"))?))
    }
}
