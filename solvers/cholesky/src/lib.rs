//! Sparse factors of matrices that couple grains, D rows for the D unknowns of a grain: its two translations, and its spin where it
//! has one. Those of Cholesky, L Lᵗ, and L U where grains act on each other otherwise than the others on them, as where they slide.
//!
//! A multifrontal factorisation (J. W. H. Liu, The multifrontal method for sparse matrix solution: theory and practice, SIAM
//! Review 34 (1992) 82-109) in D×D blocks: the graph of the grains is analysed once, matrices of its structure are then factorised
//! front by front, each a small dense matrix. Sums are made in one order everywhere, whatever the threads.

mod factor;
mod front;
mod general;
mod lu;
mod order;
mod solve;
mod structure;
mod supernodes;
mod tree;

pub use factor::{Coupling, Factor};
pub use general::General;
pub use lu::{Lu, OneWay};
pub use order::Order;
pub use structure::Structure;

use thiserror::Error;

/// Why a matrix cannot be factorised.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct Singular(String);

impl Singular {
    fn new(why: impl std::fmt::Debug) -> Self {
        Self(format!("{why:?}"))
    }
}

#[cfg(test)]
mod tests;
