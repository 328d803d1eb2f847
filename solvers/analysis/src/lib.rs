//! What the operator of a problem says without any method: the proof that there is no solution, the spectrum of W_D⁻¹ W, and
//! bounds of eigenvalues that cost one pass over the contacts.

mod bounds;
mod infeasible;
mod spectrum;

pub use bounds::{delassus_bound, scaled_delassus_bound};
pub use infeasible::{any_proves_infeasible, proves_infeasible};
pub use spectrum::{Closed, Spectrum, coupling, greatest_eigenvalue};
