//! Sparse Cholesky factor of a subdomain's matrix, with a fill-reducing order.

use contact::SetupError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Par, Side, Spec};

/// The factor L of P K Pᵗ = L Lᵗ, where P is an approximate minimum degree order.
pub(crate) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    scratch: MemBuffer,
    dimension: usize,
}

/// Many solves of one small system: simplicial factors beat blocks of columns, and are summed in one order everywhere.
fn parameters() -> CholeskySymbolicParams<'static> {
    CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
        ..CholeskySymbolicParams::default()
    }
}

impl Factor {
    /// Factorises the symmetric matrix whose lower triangle has these entries; entries of one place add up.
    pub(crate) fn new(dimension: usize, lower: &[Triplet<usize, usize, f64>]) -> Result<Self, SetupError> {
        let failed = |why: &dyn std::fmt::Debug| {
            let value = format!("so large that a subdomain's matrix cannot be factorised ({why:?})");
            SetupError::new("kappa_l_minus", value, "smaller")
        };
        let matrix =
            SparseColMat::try_new_from_triplets(dimension, dimension, lower).map_err(|e| failed(&e))?;
        let matrix = matrix.as_ref();
        let order = SymmetricOrdering::Amd;
        let symbolic = factorize_symbolic_cholesky(matrix.symbolic(), Side::Lower, order, parameters())
            .map_err(|error| failed(&error))?;
        let mut values = vec![0.0; symbolic.len_val()];
        let needed = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(needed)),
                Spec::default(),
            )
            .map_err(|error| failed(&error))?;
        let scratch = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Ok(Self { symbolic, values, scratch, dimension })
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

    /// Entries of L: each is used twice in a solve.
    pub(crate) fn entries(&self) -> usize {
        self.values.len()
    }
}
