//! Local problems: v = W r + q and Coulomb's law, with a stored W and no grains, as other codes write them; and the methods that need
//! no more.
//!
//! A block `W_αα` may couple normal and tangents, since contact points of bodies of any shape lie anywhere. NSGS solves the law
//! at one contact exactly all the same.

mod active_set;
mod exact;
mod gradient;
mod graph;
mod newton;
mod problem;
mod quartic;
mod sweeps;

pub use cg::Preconditioner;
pub use problem::LocalProblem;

use active_set::ActiveSet;
use cg::Run;
use contact::acceleration::Momentum;
use contact::precision::Precision;
use contact::{Iteration, SetupError};
use exact::{Exact, Own};
use gradient::Stored;
use nalgebra::SVector;
use sweeps::Sweeps;

/// A method that needs no grains, with its settings. All begin from r = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Non-linear Gauss-Seidel by subdomains of the graph of W, all at once; in one, in the order of the contacts.
    Nsgs {
        /// Number of subdomains.
        subdomains: usize,
        /// Extrapolation over the iterations, if any.
        momentum: Option<Momentum>,
    },
    /// The conjugate gradient of Renouf and Alart.
    Cg {
        /// Scaling of the gradient.
        preconditioner: Preconditioner,
    },
    /// Newton's method on the statuses of contacts, begun by accelerated sweeps.
    ActiveSet {
        /// Residual of the law at which the sweeps first end, as a natural map (–).
        start_accuracy: f64,
    },
}

impl Method {
    /// Binds the method to a problem.
    ///
    /// # Errors
    /// Names the setting that has no meaning for it.
    pub fn start<'p>(&self, problem: &'p LocalProblem) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        match problem.dimension() {
            1 => self.start_with::<1>(problem),
            2 => self.start_with::<2>(problem),
            _ => self.start_with::<3>(problem),
        }
    }

    fn start_with<'p, const D: usize>(
        self,
        problem: &'p LocalProblem,
    ) -> Result<Box<dyn Iteration + 'p>, SetupError>
    where
        Own<D>: Exact<D>,
    {
        Ok(match self {
            Self::Nsgs { subdomains, momentum } => Box::new(Sweeps::<D>::new(problem, subdomains, momentum)?),
            Self::Cg { preconditioner } => Box::new(gradient::<D>(problem, preconditioner)),
            Self::ActiveSet { start_accuracy } => {
                SetupError::unless_not_negative("start_accuracy", start_accuracy)?;
                Box::new(ActiveSet::<D>::new(problem, start_accuracy)?)
            }
        })
    }
}

/// The conjugate gradient from r = 0.
fn gradient<const D: usize>(
    problem: &LocalProblem,
    preconditioner: Preconditioner,
) -> Run<Stored<'_, D>, SVector<f64, D>> {
    let stored = Stored::new(problem, preconditioner == Preconditioner::Diagonal);
    let greatest = stored.greatest();
    Run::new(stored, greatest, Precision::Double)
}

#[cfg(test)]
mod tests;
