//! Kernels of measures: what an iterate does to the grains, and the sums over contacts that its measures are computed from.
//!
//! The velocity y that impulses r add to the grains has the unit of the kernel: m/s, or √J where grains are mass-scaled. Impulses are
//! added up at each grain in the order of the contacts, whether contacts push one after the other or each grain gathers its own: the
//! operations and their order are the same with any number of threads, and a contact that is evaluated alone has the bits that it has
//! among all.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

mod columns;
mod lanes;
mod sums;

use crate::mechanics::Mechanics;
use crate::problem::ContactProblem;
use std::ops::Range;

pub use columns::Scaled;
pub use lanes::Plain;
pub use sums::{Sums, ratio, zeta};

/// Contacts, or grains, that are summed up together, then block by block, so that the number of threads changes no bit.
pub const BLOCK: usize = 8192;

/// Places of the candidate and the antagonist of a contact among the grains of a gauge; `None` for a wall.
pub type Ends = (u32, Option<u32>);

/// Kernel of the measures of some contacts of a problem, between some grains: a subdomain, or all.
pub trait Gauge<M: Mechanics>: Sized + Send + Sync {
    /// Takes some `contacts` of the problem, each by its index and its ends among the `grains`, given by their indices.
    fn new(
        problem: &ContactProblem<M>,
        contacts: impl Iterator<Item = (usize, Ends)> + Clone,
        grains: impl ExactSizeIterator<Item = usize>,
    ) -> Self;

    /// Length of y: the grains, and a wall if the kernel has a place for it.
    fn places(&self) -> usize;

    /// Computes y from the impulses `r` (N·s).
    fn push(&self, r: &[f64], y: &mut [M::Velocity]);

    /// Returns y of one place alone.
    fn gather(&self, place: usize, r: &[f64]) -> M::Velocity;

    /// Sums up a range of contacts with the impulses `r` (N·s) of all contacts; only the natural map, if `alone`.
    fn sums(&self, contacts: Range<usize>, r: &[f64], y: &[M::Velocity], alone: bool) -> Sums;

    /// Returns the natural map's term (J) and the approach velocity −`v_n` (m/s) of a contact whose grains are evaluated alone.
    fn alone(&self, contact: usize, r: &[f64]) -> (f64, f64);

    /// Returns a bound of |s| = (Σ `W_αα` r²)^½ (√J).
    fn size(&self, r: &[f64]) -> f64;

    /// Returns (Σ b²/`W_αα`)^½ (√J).
    fn size_of_b(&self) -> f64;

    /// Returns a velocity of a grain of inertia `mass` (m/s) in the unit of y.
    fn scaled(mass: M::Mass, velocity: M::Velocity) -> M::Velocity;

    /// Returns the squared size of a grain's y (J).
    fn squared(&self, grain: usize, y: M::Velocity) -> f64;
}
