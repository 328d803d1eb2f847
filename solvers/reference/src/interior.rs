//! The quadratic programme in V by a primal-dual interior point (crate `clarabel`).

use crate::constraint::Constraint;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use contact::{ContactProblem, Smooth, law};

/// min ½ |y|² subject to H̃ᵗ y + b̃ ≥ 0, with y = M^½ (V − `V_free`) and b̃ = `W_D`^(−½) b, both over √(Σ max(0, −b)²/`W_αα`):
/// the solution is of the order of 1, as absolute tolerances want it. The multipliers are r̃.
pub(crate) struct Interior {
    solver: DefaultSolver<f64>,
    /// From multipliers to impulses (N·s).
    unscale: Vec<f64>,
}

/// Verdict of the interior point on its answer; the certificate judges the answer, not this word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// The multipliers are near a solution.
    Solution,
    /// The multipliers are near a proof that there is none.
    Infeasible,
    /// It stopped for this reason, which its multipliers may be good for all the same.
    Stopped(SolverStatus),
}

/// The default of clarabel, 1e-8: asked for much more it stops far earlier.
fn settings() -> Result<DefaultSettings<f64>, String> {
    // Without presolve, there is one multiplier for each contact.
    let settings = DefaultSettingsBuilder::default().verbose(false).presolve_enable(false).build();
    settings.map_err(|error| error.to_string())
}

impl Interior {
    /// Lays the programme out. Its matrix does not change: its order is found here, its factors in the run.
    pub(crate) fn new<const D: usize>(
        problem: &ContactProblem<Smooth<D>>,
        constraints: &[Constraint<D>],
    ) -> Result<Self, String> {
        let (contacts, columns) = (constraints.len(), D * problem.grain_count());
        let scale = problem.scale().sqrt();
        let identity = CscMatrix::identity(columns);
        let (mut of_row, mut of_column, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (contact, constraint) in constraints.iter().enumerate() {
            for (column, value) in constraint.entries() {
                of_row.push(contact);
                of_column.push(column);
                values.push(-value);
            }
        }
        let matrix = CscMatrix::new_from_triplets(contacts, columns, of_row, of_column, values);
        let bound: Vec<f64> =
            problem.b().iter().zip(constraints).map(|(b, constraint)| b / constraint.root / scale).collect();
        let cones = [NonnegativeConeT(contacts)];
        let solver = DefaultSolver::new(&identity, &vec![0.0; columns], &matrix, &bound, &cones, settings()?)
            .map_err(|error| error.to_string())?;
        Ok(Self { solver, unscale: constraints.iter().map(|constraint| scale / constraint.root).collect() })
    }

    /// Runs, writes the impulses (N·s) or the ray, and says which it takes them for.
    pub(crate) fn run(&mut self, r: &mut [f64]) -> Verdict {
        self.solver.solve();
        for ((r, z), unscale) in r.iter_mut().zip(&self.solver.solution.z).zip(&self.unscale) {
            *r = law::non_negative(z * unscale);
        }
        match self.solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Verdict::Solution,
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => Verdict::Infeasible,
            other => Verdict::Stopped(other),
        }
    }

    /// Matrices factorised: one to begin with, and one in each of its iterations.
    pub(crate) fn factorisations(&self) -> u64 {
        u64::from(self.solver.solution.iterations) + 1
    }
}
