//! Judgement of iterates and of the operator of a problem: measures, on one machine or of all ranks; the proof that there is no solution, to which a few hundred conjugate gradients on ½ dᵗ W d
//! may lead and which is made in exact arithmetic, the spectrum of W_D⁻¹ W, and bounds of eigenvalues that cost one pass over the contacts. No method of the line-up.

mod bounds;
mod infeasible;
mod meter;
mod spectrum;

pub use bounds::{Bounded, delassus_bound, scaled_delassus_bound};
pub use infeasible::{Proof, proves_infeasible};
pub use meter::Meter;
pub use spectrum::{Closed, Spectrum, coupling, greatest_eigenvalue};
