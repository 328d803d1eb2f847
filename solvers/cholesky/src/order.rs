//! Orders of the unknowns in which a factor stays sparse.

use crate::{Singular, failed};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::amd;
use faer::sparse::{SparseColMat, Triplet};

/// An order of unknowns.
pub struct Order {
    /// The unknown at each place.
    forward: Vec<usize>,
    /// The place of each unknown.
    inverse: Vec<usize>,
}

impl Order {
    /// An approximate minimum degree order of so many `unknowns`; `pairs` are those that the matrix couples, in any order and as
    /// often as may be.
    ///
    /// # Errors
    /// Where there are too many.
    pub fn minimum_degree(
        unknowns: usize,
        pairs: impl Iterator<Item = (usize, usize)>,
    ) -> Result<Self, Singular> {
        let pairs = pairs.chain((0..unknowns).map(|k| (k, k)));
        let lower: Vec<_> = pairs.map(|(i, j)| Triplet::new(i.max(j), i.min(j), 0.0)).collect();
        let matrix =
            SparseColMat::<usize, f64>::try_new_from_triplets(unknowns, unknowns, &lower).map_err(failed)?;
        let (mut forward, mut inverse) = (vec![0; unknowns], vec![0; unknowns]);
        let mut memory = MemBuffer::new(amd::order_scratch::<usize>(unknowns, matrix.compute_nnz()));
        let (control, stack) = (amd::Control::default(), MemStack::new(&mut memory));
        amd::order(&mut forward, &mut inverse, matrix.symbolic(), control, stack).map_err(failed)?;
        Ok(Self { forward, inverse })
    }

    /// The place of each unknown.
    pub fn places(&self) -> &[usize] {
        &self.inverse
    }

    pub(crate) fn permutation(&self) -> PermRef<'_, usize> {
        PermRef::new_checked(&self.forward, &self.inverse, self.forward.len())
    }
}
