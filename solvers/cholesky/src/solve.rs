//! The two passes over a factor, two columns at a time: those of a grain.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use crate::structure::{Structure, Supernode};
use nalgebra::Vector2;

/// x ← L⁻ᵗ L⁻¹ x, for one x per place.
#[inline(always)]
pub(crate) fn solve(structure: &Structure, values: &[f64], x: &mut [Vector2<f64>]) {
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

/// Two columns of L, those of an own grain of a supernode: the inverses of the diagonal entries, the one between them, and 2×2
/// blocks in the rows of the own grains behind it, and in the others.
struct Columns<'p> {
    first: f64,
    between: f64,
    second: f64,
    own: Blocks<'p>,
    others: Blocks<'p>,
}

/// 2×2 blocks one below the other: their left columns, and their right ones.
type Blocks<'p> = (&'p [[f64; 2]], &'p [[f64; 2]]);

impl<'p> Columns<'p> {
    /// Of the grain with this index among `own`, in a panel of so many rows.
    #[inline(always)]
    fn new(panel: &'p [f64], height: usize, own: usize, grain: usize) -> Self {
        let (left, right) = panel[2 * grain * height..2 * (grain + 1) * height].split_at(height);
        let ((left, _), (right, _)) = (left.as_chunks(), right.as_chunks());
        let ([first, between], second) = (left[grain], right[grain][1]);
        let (own_left, other_left) = left[grain + 1..].split_at(own - grain - 1);
        let (own_right, other_right) = right[grain + 1..].split_at(own - grain - 1);
        Self { first, between, second, own: (own_left, own_right), others: (other_left, other_right) }
    }
}

/// L y = x of the own grains, and what that takes from the rows below.
#[inline(always)]
fn forward(node: &Supernode, rows: &[u32], panel: &[f64], x: &mut [Vector2<f64>]) {
    let own = node.own.start as usize..node.own.end as usize;
    let height = 2 * (own.len() + rows.len());
    for (grain, at) in own.clone().enumerate() {
        let columns = Columns::new(panel, height, own.len(), grain);
        let first = x[at].x * columns.first;
        let y = Vector2::new(first, (x[at].y - columns.between * first) * columns.second);
        x[at] = y;
        for (x, (left, right)) in x[at + 1..own.end].iter_mut().zip(columns.own.0.iter().zip(columns.own.1)) {
            *x -= Vector2::from(*left) * y.x + Vector2::from(*right) * y.y;
        }
        for (row, (left, right)) in rows.iter().zip(columns.others.0.iter().zip(columns.others.1)) {
            let x = &mut x[*row as usize];
            *x -= Vector2::from(*left) * y.x + Vector2::from(*right) * y.y;
        }
    }
}

/// Lᵗ x = y of the own grains, from the last.
#[inline(always)]
fn backward(node: &Supernode, rows: &[u32], panel: &[f64], x: &mut [Vector2<f64>]) {
    let own = node.own.start as usize..node.own.end as usize;
    let height = 2 * (own.len() + rows.len());
    for (grain, at) in own.clone().enumerate().rev() {
        let columns = Columns::new(panel, height, own.len(), grain);
        let mut y = x[at];
        for (x, (left, right)) in x[at + 1..own.end].iter().zip(columns.own.0.iter().zip(columns.own.1)) {
            y -= Vector2::new(left[0], right[0]) * x.x + Vector2::new(left[1], right[1]) * x.y;
        }
        for (row, (left, right)) in rows.iter().zip(columns.others.0.iter().zip(columns.others.1)) {
            let x = x[*row as usize];
            y -= Vector2::new(left[0], right[0]) * x.x + Vector2::new(left[1], right[1]) * x.y;
        }
        let second = y.y * columns.second;
        x[at] = Vector2::new((y.x - columns.between * second) * columns.first, second);
    }
}
