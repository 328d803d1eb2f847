//! The factor of a matrix in 2×2 blocks.

use crate::{Order, Singular, failed, numeric, symbolic};
use faer::Side;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering};
use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMat, Triplet};
use nalgebra::{Matrix2, Vector2};

/// What a factor owes to the coupled grains alone: their order, and where the factor has entries.
pub struct BlockStructure {
    /// Place of each grain in the order.
    position: Vec<u32>,
    /// Where the matrix has entries, in the upper triangle and in this order.
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
}

/// The factor L of P K Pᵗ = L Lᵗ by columns of 2×2 blocks: many solves of one small system are bound by the entries that
/// they read, and a block has one index for four of them.
pub struct BlockFactor {
    /// Diagonal blocks, lower triangular, with the inverses of their diagonal entries.
    diagonal: Vec<Matrix2<f64>>,
    /// Column j has the blocks `first[j]..first[j + 1]` below its diagonal.
    first: Vec<u32>,
    row: Vec<u32>,
    block: Vec<Matrix2<f64>>,
}

impl BlockStructure {
    /// Orders so many `grains` by approximate minimum degree; `pairs` are those that the matrix couples.
    ///
    /// # Errors
    /// Where there are too many.
    pub fn new(grains: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Result<Self, Singular> {
        let pairs = pairs.map(|(i, j)| (i as usize, j as usize));
        let order = Order::minimum_degree(grains, pairs.clone())?;
        let place = order.places();
        let upper: Vec<_> = pairs
            .chain((0..grains).map(|grain| (grain, grain)))
            .flat_map(|(i, j)| upper((place[i].min(place[j]), place[i].max(place[j]), Matrix2::zeros())))
            .collect();
        let (pattern, _) = SparseColMat::<usize, f64>::try_new_from_triplets(2 * grains, 2 * grains, &upper)
            .map_err(failed)?
            .into_parts();
        let symbolic = symbolic(pattern.as_ref(), Side::Upper, SymmetricOrdering::Identity)?;
        Ok(Self { position: place.iter().map(|place| *place as u32).collect(), pattern, symbolic })
    }

    /// Place of each grain in the order: row and column of its block.
    pub fn position(&self) -> &[u32] {
        &self.position
    }

    /// Factorises the matrix with these blocks, each at the places of two grains; only what is in the upper triangle counts, and
    /// blocks of the same places add up.
    ///
    /// # Errors
    /// Where it is not positive definite in double precision.
    ///
    /// # Panics
    /// If it couples grains that are not among the pairs.
    pub fn factorise(
        &self,
        blocks: impl Iterator<Item = (usize, usize, Matrix2<f64>)>,
    ) -> Result<BlockFactor, Singular> {
        let entries = self.values(blocks.flat_map(upper));
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), &entries);
        let values = numeric(&self.symbolic, matrix, Side::Upper)?;
        let SymbolicCholeskyRaw::Simplicial(columns) = self.symbolic.raw() else {
            return Err(failed("not simplicial"));
        };
        Ok(BlockFactor::in_blocks(columns.col_ptr(), columns.row_idx(), &values))
    }

    /// The values of the matrix with these entries, in the order of its pattern. Entries of one place add up.
    fn values(&self, entries: impl Iterator<Item = Triplet<usize, usize, f64>>) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.row_idx().len()];
        for entry in entries {
            let column = self.pattern.col_range(entry.col);
            let rows = &self.pattern.row_idx()[column.clone()];
            let place = rows.partition_point(|row| *row < entry.row);
            assert!(rows.get(place) == Some(&entry.row), "the structure has every place of the matrix");
            values[column.start + place] += entry.val;
        }
        values
    }
}

/// The entries of a block in the upper triangle, rows 2p and 2p + 1 for the grain at place p.
fn upper((i, j, block): (usize, usize, Matrix2<f64>)) -> impl Iterator<Item = Triplet<usize, usize, f64>> {
    let entries = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter();
    let entries = entries.map(move |(x, y)| Triplet::new(2 * i + x, 2 * j + y, block[(x, y)]));
    entries.filter(|entry| entry.row <= entry.col)
}

impl BlockFactor {
    /// From columns of entries, in rising rows. Columns 2j and 2j + 1 have entries in the same blocks.
    fn in_blocks(start: &[usize], row_of: &[usize], values: &[f64]) -> Self {
        let mut factor = Self { diagonal: Vec::new(), first: vec![0], row: Vec::new(), block: Vec::new() };
        for ends in start.windows(3).step_by(2) {
            let (left, right) = (&values[ends[0]..ends[1]], &values[ends[1]..ends[2]]);
            factor.diagonal.push(Matrix2::new(1.0 / left[0], 0.0, left[1], 1.0 / right[0]));
            let rows = row_of[ends[0]..ends[1]][2..].chunks_exact(2);
            for ((rows, left), right) in rows.zip(left[2..].chunks_exact(2)).zip(right[1..].chunks_exact(2)) {
                factor.row.push((rows[0] / 2) as u32);
                factor.block.push(Matrix2::new(left[0], right[0], left[1], right[1]));
            }
            factor.first.push(factor.row.len() as u32);
        }
        factor
    }

    /// x ← (P K Pᵗ)⁻¹ x, for one x per place.
    pub fn solve(&self, x: &mut [Vector2<f64>]) {
        // L y = x, column by column
        for (j, diagonal) in self.diagonal.iter().enumerate() {
            let (row, block) = self.column(j);
            let y0 = x[j].x * diagonal.m11;
            let y = Vector2::new(y0, (x[j].y - diagonal.m21 * y0) * diagonal.m22);
            x[j] = y;
            for (i, block) in row.iter().zip(block) {
                x[*i as usize] -= block * y;
            }
        }
        // Lᵗ x = y, from the last
        for (j, diagonal) in self.diagonal.iter().enumerate().rev() {
            let (row, block) = self.column(j);
            let mut y = x[j];
            for (i, block) in row.iter().zip(block) {
                y -= block.tr_mul(&x[*i as usize]);
            }
            let x1 = y.y * diagonal.m22;
            x[j] = Vector2::new((y.x - diagonal.m21 * x1) * diagonal.m11, x1);
        }
    }

    /// The blocks of column j below its diagonal.
    fn column(&self, j: usize) -> (&[u32], &[Matrix2<f64>]) {
        let blocks = self.first[j] as usize..self.first[j + 1] as usize;
        (&self.row[blocks.clone()], &self.block[blocks])
    }

    /// Entries of L: each is used twice in a solve.
    pub fn entries(&self) -> usize {
        3 * self.diagonal.len() + 4 * self.block.len()
    }
}
