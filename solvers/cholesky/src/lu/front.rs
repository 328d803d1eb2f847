//! A front of a matrix that is not symmetric: how it is put together, and its own columns eliminated.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use crate::front::{Entries, PANEL, Product};
use nalgebra::SMatrix;
use pulp::{Arch, Simd, WithSimd};

/// A front: `own` columns of all its rows, the rows of these to the right, and the rest.
pub(super) struct Front<'m> {
    /// Column by column.
    pub(super) lower: &'m mut [f64],
    /// Row by row.
    pub(super) upper: &'m mut [f64],
    /// Column by column.
    pub(super) rest: &'m mut [f64],
    pub(super) exchanged: &'m mut [u32],
    pub(super) own: usize,
    pub(super) below: usize,
}

impl Front<'_> {
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.lower.fill(0.0);
        self.upper.fill(0.0);
    }

    /// Adds a block at a grain's rows and another's columns, given by their indices in the front.
    #[inline(always)]
    pub(super) fn add<const D: usize>(&mut self, row: u32, column: u32, block: &SMatrix<f64, D, D>) {
        for (c, block) in block.column_iter().enumerate() {
            self.add_column(D * row as usize, D * column as usize + c, block.as_slice());
        }
    }

    /// Adds entries of a column, which follow one another from a row on.
    #[inline(always)]
    fn add_column(&mut self, row: usize, column: usize, entries: &[f64]) {
        let (own, below) = (self.own, self.below);
        if column < own {
            let at = column * (own + below) + row;
            self.lower[at..at + entries.len()].iter_mut().zip(entries).for_each(|(to, entry)| *to += entry);
        } else if row < own {
            let to = self.upper[row * below + column - own..].iter_mut().step_by(below);
            to.zip(entries).for_each(|(to, entry)| *to += entry);
        } else {
            let at = (column - own) * below + row - own;
            self.rest[at..at + entries.len()].iter_mut().zip(entries).for_each(|(to, entry)| *to += entry);
        }
    }

    /// Adds what a child left, whose rows have these indices.
    #[inline(always)]
    pub(super) fn extend_add<const D: usize>(&mut self, left: &[f64], rows: &[u32]) {
        for (column, left) in left.chunks_exact(D * rows.len()).enumerate() {
            let column = D * rows[column / D] as usize + column % D;
            for (row, left) in rows.iter().zip(left.as_chunks::<D>().0) {
                self.add_column(D * *row as usize, column, left);
            }
        }
    }

    /// Eliminates the own columns; `false` where one has no pivot.
    pub(super) fn eliminate(&mut self) -> bool {
        let (own, below) = (self.own, self.below);
        let rows = own + below;
        let mut ahead_of_panel = Vec::new();
        for from in (0..own).step_by(PANEL) {
            let to = own.min(from + PANEL);
            if !Arch::new().dispatch(Panel { front: self, from, to }) {
                return false;
            }
            let depth = to - from;
            let (done, ahead) = self.lower.split_at_mut(to * rows);
            let left = Entries { of: &done[from * rows..], rows };
            // Rows of U in the own columns, entries of which lie a column apart.
            ahead_of_panel.clear();
            for row in from..to {
                ahead_of_panel.extend(ahead.chunks_exact(rows).map(|column| column[row]));
            }
            let right = Entries { of: &ahead_of_panel, rows: own - to };
            Product { left, right, depth, rows_from: Some(to) }.subtract(ahead, 0, 0);
            if below > 0 {
                let (done, under) = self.upper.split_at_mut(to * below);
                let right = Entries { of: &done[from * below..], rows: below };
                Product { left: right, right: left, depth, rows_from: Some(0) }.subtract(under, 0, to);
                Product { left, right, depth, rows_from: Some(own) }.subtract(self.rest, own, 0);
            }
        }
        true
    }

    /// Finds the pivot of column `j`, the greatest entry of its own rows from `j` on, and takes its row to row `j`; `false` where there is none.
    #[inline(always)]
    fn exchange(&mut self, j: usize) -> bool {
        let (own, below) = (self.own, self.below);
        let rows = own + below;
        let column = &self.lower[j * rows + j..j * rows + own];
        let (mut pivot, mut at) = (column[0], 0);
        for (k, entry) in column.iter().enumerate() {
            if entry.abs() > pivot.abs() {
                (pivot, at) = (*entry, k);
            }
        }
        if !(pivot != 0.0 && pivot.is_finite()) {
            return false;
        }
        self.exchanged[j] = at as u32;
        if at > 0 {
            self.lower.chunks_exact_mut(rows).for_each(|column| column.swap(j, j + at));
            if below > 0 {
                let (first, second) = self.upper.split_at_mut((j + at) * below);
                first[j * below..(j + 1) * below].swap_with_slice(&mut second[..below]);
            }
        }
        true
    }
}

/// The columns `from..to` of a front, and the rows of U to the right of them.
struct Panel<'f, 'm> {
    front: &'f mut Front<'m>,
    from: usize,
    to: usize,
}

impl WithSimd for Panel<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { front, from, to } = self;
        let (own, below) = (front.own, front.below);
        let rows = own + below;
        for j in from..to {
            if !front.exchange(j) {
                return false;
            }
            let (done, ahead) = front.lower[..to * rows].split_at_mut((j + 1) * rows);
            let column = &mut done[j * rows + j..];
            let inverse = 1.0 / column[0];
            column[0] = inverse;
            column[1..].iter_mut().for_each(|entry| *entry *= inverse);
            for other in ahead.chunks_exact_mut(rows) {
                subtract(&mut other[j..], column);
            }
        }
        let (done, ahead) = front.lower.split_at_mut(to * rows);
        let of_l = |j: usize| &done[j * rows + j..j * rows + to];
        for column in ahead.chunks_exact_mut(rows) {
            for j in from..to {
                subtract(&mut column[j..to], of_l(j));
            }
        }
        for j in from..to {
            let (above, under) = front.upper[..to * below].split_at_mut((j + 1) * below);
            let of_j = &above[j * below..];
            for (row, factor) in under.chunks_exact_mut(below.max(1)).zip(&of_l(j)[1..]) {
                row.iter_mut().zip(of_j).for_each(|(entry, of_j)| *entry -= factor * of_j);
            }
        }
        true
    }
}

/// Takes a column of L, whose first entry belongs to U, times the first entry of another column from that below it.
#[inline(always)]
fn subtract(column: &mut [f64], of_l: &[f64]) {
    let factor = column[0];
    column[1..].iter_mut().zip(&of_l[1..]).for_each(|(entry, of_l)| *entry -= factor * of_l);
}
