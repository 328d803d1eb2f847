//! Sparse Cholesky factor of K = 1 + κ H̃_A H̃_Aᵗ, with a fill-reducing order.

use crate::row::Row;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Par, Side, Spec};

/// P, an approximate minimum degree order of the unknowns.
pub(crate) struct Order {
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

impl Order {
    /// For any of the contacts `rows` being active.
    pub(crate) fn of<'r>(dimension: usize, rows: impl Iterator<Item = &'r Row>) -> Option<Self> {
        let matrix = lower(dimension, rows, 1.0)?;
        let (mut forward, mut inverse) = (vec![0; dimension], vec![0; dimension]);
        let needed = amd::order_scratch::<usize>(dimension, matrix.compute_nnz());
        let mut memory = MemBuffer::new(needed);
        let stack = MemStack::new(&mut memory);
        amd::order(&mut forward, &mut inverse, matrix.symbolic(), amd::Control::default(), stack).ok()?;
        Some(Self { forward, inverse })
    }
}

/// The lower triangle of K.
fn lower<'r>(
    dimension: usize,
    rows: impl Iterator<Item = &'r Row>,
    penalty: f64,
) -> Option<SparseColMat<usize, f64>> {
    let mut lower: Vec<_> = (0..dimension).map(|k| Triplet::new(k, k, 1.0)).collect();
    for row in rows {
        for (i, a) in row.entries() {
            let below = row.entries().filter(|(j, _)| *j <= i);
            lower.extend(below.map(|(j, b)| Triplet::new(i, j, penalty * a * b)));
        }
    }
    SparseColMat::try_new_from_triplets(dimension, dimension, &lower).ok()
}

/// The factor L of P K Pᵗ = L Lᵗ.
pub(crate) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    scratch: MemBuffer,
    dimension: usize,
}

impl Factor {
    /// Factorises K of the active `rows`; `None` if its numbers overflow.
    pub(crate) fn new<'r>(
        dimension: usize,
        rows: impl Iterator<Item = &'r Row>,
        penalty: f64,
        order: &Order,
    ) -> Option<Self> {
        let matrix = lower(dimension, rows, penalty)?;
        // Simplicial: summed in one order everywhere.
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..CholeskySymbolicParams::default()
        };
        let order = PermRef::new_checked(&order.forward, &order.inverse, dimension);
        let order = SymmetricOrdering::Custom(order);
        let symbolic = factorize_symbolic_cholesky(matrix.symbolic(), Side::Lower, order, parameters).ok()?;
        let mut values = vec![0.0; symbolic.len_val()];
        let needed = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix.as_ref(),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(needed)),
                Spec::default(),
            )
            .ok()?;
        let scratch = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Some(Self { symbolic, values, scratch, dimension })
    }

    /// x ← K⁻¹ x.
    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        let x = MatMut::from_column_major_slice_mut(x, self.dimension, 1);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }

    /// Rows of K.
    pub(crate) fn dimension(&self) -> usize {
        self.dimension
    }

    /// Entries of L: each is used twice in a solve.
    pub(crate) fn entries(&self) -> usize {
        self.values.len()
    }
}
