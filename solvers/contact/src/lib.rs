//! The contact problem of one time step, eq. (1)-(2): data, law, measures, the contacts of a sweep, the interface of the
//! methods, the only loop.
//!
//! Equation numbers are those of Iceta, Dureisseix, Alart, Giens 2009, hal-00413720. No method of the line-up lives here.

pub mod adjacency;
mod convergence;
pub mod interface;
pub mod law;
pub mod measures;
pub mod operators;
pub mod problem;
pub mod scaled;
pub mod solve;
pub mod spectrum;
pub mod sweep;
pub mod threads;
pub mod truth;

pub use adjacency::{Adjacency, greedy_colours};
pub use interface::{Iteration, SetupError, Solver, Work, shown};
pub use measures::{Measure, Measures, Meter};
pub use problem::{Contact, ContactProblem, ProblemError};
pub use scaled::ScaledContact;
pub use solve::{Outcome, Progress, Status, Stop, solve, solve_against};
pub use spectrum::Spectrum;
pub use threads::together;
pub use truth::{Truth, proves_infeasible};
