//! The kernel: the contact problem of one time step, eq. (1)-(2), its operators, its law, its mass-scaled contacts and their
//! sweep, the measures of an iterate, and the traits of a method.
//!
//! Equation numbers are those of Iceta, Dureisseix, Alart, Giens 2009, hal-00413720. No method lives here.

pub mod acceleration;
pub mod adjacency;
mod discs;
mod error;
pub mod gauge;
pub mod lanes;
pub mod law;
mod measure;
mod measures;
pub mod mechanics;
pub mod memory;
pub mod number;
mod operators;
mod packing;
pub mod precision;
mod problem;
mod rough;
mod scaled;
mod solver;
pub mod status;
pub mod sums;
pub mod sweep;
pub mod threads;
mod truth;
pub mod vector;
pub mod visit;
mod work;

pub use adjacency::{Adjacency, Groups, by_levels, greedy_colours};
pub use discs::{Contact, Discs, Smooth, Spheres};
pub use error::{ProblemError, SetupError, is_not_negative, is_positive, shown};
pub use law::greatest;
pub use measure::Measure;
pub use measures::Measures;
pub use mechanics::{Column, Mass, Mechanics, Touch, VisitedIn};
pub use packing::Packing;
pub use problem::ContactProblem;
pub use rough::{
    Cone, Frictional, Rough, RoughColumn, RoughContact, RoughDiscs, RoughMass, RoughSpheres, SphereColumn,
    frame, obeys_friction,
};
pub use scaled::ScaledContact;
pub use solver::{Iteration, Solver};
pub use sums::{ratio, zeta};
pub use truth::Truth;
pub use vector::{Numbers, Place, Vector};
pub use visit::Visited;
pub use work::Work;
