//! Sparse Cholesky factors L Lᵗ of symmetric positive definite matrices, with a fill-reducing order (crate `faer`): by entries, or
//! in 2×2 blocks, one for the two translations of a grain.
//!
//! All factors are simplicial and sequential: summed in one order everywhere.

mod blocks;
mod entries;
mod order;

pub use blocks::{BlockFactor, BlockStructure};
pub use entries::Factor;
pub use faer::sparse::Triplet;
pub use order::Order;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side, Spec};
use thiserror::Error;

/// Why a matrix cannot be factorised.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct Singular(String);

fn failed(why: impl std::fmt::Debug) -> Singular {
    Singular(format!("{why:?}"))
}

/// Where the factor of a matrix with this `pattern` in one triangle has entries.
fn symbolic(
    pattern: SymbolicSparseColMatRef<'_, usize>,
    side: Side,
    order: SymmetricOrdering<'_, usize>,
) -> Result<SymbolicCholesky<usize>, Singular> {
    let parameters = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
        ..CholeskySymbolicParams::default()
    };
    factorize_symbolic_cholesky(pattern, side, order, parameters).map_err(failed)
}

/// The entries of the factor of `matrix`.
fn numeric(
    symbolic: &SymbolicCholesky<usize>,
    matrix: SparseColMatRef<'_, usize, f64>,
    side: Side,
) -> Result<Vec<f64>, Singular> {
    let mut values = vec![0.0; symbolic.len_val()];
    let mut memory = MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()));
    symbolic
        .factorize_numeric_llt(
            &mut values,
            matrix,
            side,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Spec::default(),
        )
        .map_err(failed)?;
    Ok(values)
}

#[cfg(test)]
mod tests;
