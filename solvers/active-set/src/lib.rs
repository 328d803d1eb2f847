//! Primal-dual active set on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r, begun by accelerated sweeps of Gauss-Seidel: the solution to
//! round-off for a few sparse factorisations.
//!
//! M. Hintermüller, K. Ito, K. Kunisch, The primal-dual active set strategy as a semismooth Newton method, SIAM J. Optim. 13
//! (2002) 865-888; with the proximal term of R. T. Rockafellar, Augmented Lagrangians and applications of the proximal point
//! algorithm in convex programming, Math. Oper. Res. 1 (1976) 97-116, which keeps the matrix regular where more contacts are closed
//! than equilibrium needs, and chooses among their impulses those nearest to the given ones.
//!
//! An iteration is a sweep, a set, or a step of an interior point (`frictionless.rs`). With friction Newton's method on the statuses open,
//! stick and slide takes the place of the set; where sweeps stall, convex programmes and proximal points lead to where it ends
//! (`frictional.rs`).

mod cone;
mod conic;
mod frictional;
mod frictionless;
mod inner;
mod interior;
mod layout;
mod scaled;
mod set;
mod start;

pub use conic::Conic;
pub use frictionless::Run;
pub use inner::{Inner, PENALTY, Whole};
pub use set::Set;
pub use start::{ACCURACY_OF_DEARER, Start};

use contact::SetupError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the active set.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ActiveSet {
    /// Method that finds the first set: unless given `sweeps`.
    pub start: Option<Start>,
    /// Residual of the law at which the first set is taken, as a natural map (–): unless given 1e-3; 3e-3 with friction,
    /// with conjugate gradients, and where there is W alone.
    pub start_accuracy: Option<f64>,
    /// Warm start: start impulses, where there are some, give the first set in the place of conjugate gradients or an interior point. Sweeps
    /// begin from them.
    pub warm: bool,
}

impl Default for ActiveSet {
    fn default() -> Self {
        Self { start: None, start_accuracy: None, warm: true }
    }
}

/// The impulses that leave least of the law, of all that were looked at: what the run shows, unless the start has its turn. Between good
/// sets there are some that hold what cannot be held, with impulses beyond all measure.
#[derive(Clone)]
pub(crate) struct Best {
    /// Residual of these impulses (√J).
    left: f64,
    /// N·s, in the problem's order.
    impulses: Vec<f64>,
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

impl ActiveSet {
    /// Returns the accuracy of the start (–): `or`, unless given.
    fn accuracy(&self, or: f64) -> Result<f64, SetupError> {
        let accuracy = self.start_accuracy.unwrap_or(or);
        SetupError::unless_not_negative("start_accuracy", accuracy)?;
        Ok(accuracy)
    }
}
