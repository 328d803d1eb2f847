//! The factor of any matrix, by entries.

use crate::{Order, Singular, failed, numeric, symbolic};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymmetricOrdering};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Par, Side};

/// The factor L of P K Pᵗ = L Lᵗ.
pub struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    scratch: MemBuffer,
    dimension: usize,
}

impl Factor {
    /// Factorises the matrix with these entries in the `lower` triangle; those of one place add up.
    ///
    /// # Errors
    /// Where it is not positive definite in double precision, or too large.
    pub fn new(
        dimension: usize,
        lower: &[Triplet<usize, usize, f64>],
        order: &Order,
    ) -> Result<Self, Singular> {
        let matrix = SparseColMat::try_new_from_triplets(dimension, dimension, lower).map_err(failed)?;
        let order = SymmetricOrdering::Custom(order.permutation());
        let symbolic = symbolic(matrix.symbolic(), Side::Lower, order)?;
        let values = numeric(&symbolic, matrix.as_ref(), Side::Lower)?;
        let scratch = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Ok(Self { symbolic, values, scratch, dimension })
    }

    /// x ← K⁻¹ x.
    pub fn solve(&mut self, x: &mut [f64]) {
        let x = MatMut::from_column_major_slice_mut(x, self.dimension, 1);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }

    /// Rows of K.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Entries of L: each is used twice in a solve.
    pub fn entries(&self) -> usize {
        self.values.len()
    }
}
