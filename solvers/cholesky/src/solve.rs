//! The two passes over a factor, D columns at a time: those of a grain.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use crate::structure::{Structure, Supernode};
use nalgebra::SVector;
use std::array::from_fn;

/// x ← L⁻ᵗ L⁻¹ x, for one x per place.
#[inline(always)]
pub(crate) fn solve<const D: usize>(structure: &Structure<D>, values: &[f64], x: &mut [SVector<f64, D>]) {
    let parts = |k: usize, node: &Supernode| {
        (&structure.rows[node.rows.clone()], &values[node.start..structure.end(k)])
    };
    for (k, node) in structure.supernodes.iter().enumerate() {
        let (rows, panel) = parts(k, node);
        forward(node, rows, panel, x);
    }
    for (k, node) in structure.supernodes.iter().enumerate().rev() {
        let (rows, panel) = parts(k, node);
        backward(node, rows, panel, x);
    }
}

/// The columns of L of an own grain of a supernode: D×D blocks in its own rows, with the inverses of the diagonal entries, in the
/// rows of the own grains behind it, and in the others.
struct Columns<'p, const D: usize> {
    corner: [&'p [f64; D]; D],
    own: Blocks<'p, D>,
    others: Blocks<'p, D>,
}

/// D×D blocks one below the other, column by column.
type Blocks<'p, const D: usize> = [&'p [[f64; D]]; D];

impl<'p, const D: usize> Columns<'p, D> {
    /// Returns the view of the grain with this index among `own`, in a panel of so many rows.
    #[inline(always)]
    fn new(panel: &'p [f64], height: usize, own: usize, grain: usize) -> Self {
        let panel = &panel[D * grain * height..D * (grain + 1) * height];
        let column = |c: usize| panel[c * height..(c + 1) * height].as_chunks::<D>().0;
        Self {
            corner: from_fn(|c| &column(c)[grain]),
            own: from_fn(|c| &column(c)[grain + 1..own]),
            others: from_fn(|c| &column(c)[own..]),
        }
    }
}

/// The block with this index, times y.
#[inline(always)]
fn times<const D: usize>(blocks: &Blocks<'_, D>, index: usize, y: &SVector<f64, D>) -> SVector<f64, D> {
    let mut product = SVector::from(blocks[0][index]) * y[0];
    for c in 1..D {
        product += SVector::from(blocks[c][index]) * y[c];
    }
    product
}

/// The block with this index, transposed, times x.
#[inline(always)]
fn transposed_times<const D: usize>(
    blocks: &Blocks<'_, D>,
    index: usize,
    x: &SVector<f64, D>,
) -> SVector<f64, D> {
    let row = |r: usize| SVector::<f64, D>::from_fn(|c, _| blocks[c][index][r]);
    let mut product = row(0) * x[0];
    for r in 1..D {
        product += row(r) * x[r];
    }
    product
}

/// L y = x of the own grains, and what that takes from the rows below.
#[inline(always)]
fn forward<const D: usize>(node: &Supernode, rows: &[u32], panel: &[f64], x: &mut [SVector<f64, D>]) {
    let own = node.own.start as usize..node.own.end as usize;
    let height = D * (own.len() + rows.len());
    for (grain, at) in own.clone().enumerate() {
        let columns = Columns::new(panel, height, own.len(), grain);
        let mut y = x[at];
        for c in 0..D {
            for k in 0..c {
                y[c] -= columns.corner[k][c] * y[k];
            }
            y[c] *= columns.corner[c][c];
        }
        x[at] = y;
        for (k, x) in x[at + 1..own.end].iter_mut().enumerate() {
            *x -= times(&columns.own, k, &y);
        }
        for (k, row) in rows.iter().enumerate() {
            x[*row as usize] -= times(&columns.others, k, &y);
        }
    }
}

/// Lᵗ x = y of the own grains, from the last.
#[inline(always)]
fn backward<const D: usize>(node: &Supernode, rows: &[u32], panel: &[f64], x: &mut [SVector<f64, D>]) {
    let own = node.own.start as usize..node.own.end as usize;
    let height = D * (own.len() + rows.len());
    for (grain, at) in own.clone().enumerate().rev() {
        let columns = Columns::new(panel, height, own.len(), grain);
        let mut y = x[at];
        for (k, x) in x[at + 1..own.end].iter().enumerate() {
            y -= transposed_times(&columns.own, k, x);
        }
        for (k, row) in rows.iter().enumerate() {
            y -= transposed_times(&columns.others, k, &x[*row as usize]);
        }
        for c in (0..D).rev() {
            for k in c + 1..D {
                y[c] -= columns.corner[c][k] * y[k];
            }
            y[c] *= columns.corner[c][c];
        }
        x[at] = y;
    }
}
