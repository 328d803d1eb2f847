//! Dense kernels: columns of a front are eliminated, and what they leave is taken from the rest.
//!
//! All matrices are stored column by column, and of symmetric ones the lower triangle counts. Whatever the processor's
//! instructions, each entry is made of the same sums in the same order.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use contact::threads;
use pulp::{Arch, Simd, WithSimd};

/// Columns that are eliminated before the columns after them are touched.
pub(crate) const PANEL: usize = 48;

/// The columns of a front to be eliminated, and what is below and right of them.
pub(crate) struct Front<'m> {
    /// `rows`×`own`.
    pub(crate) panel: &'m mut [f64],
    /// (`rows` − `own`)².
    pub(crate) rest: &'m mut [f64],
    pub(crate) own: usize,
    pub(crate) rows: usize,
}

/// Multiply-adds of a product that are worth more than one thread.
const WORTH_THREADS: usize = 4_000_000;

/// Columns of a product that stay together on one thread.
const TOGETHER: usize = 64;

impl Front<'_> {
    /// Eliminates the own columns: the panel becomes L, with the inverses on its diagonal, and the rest loses L Lᵗ of the rows
    /// there. `false` where a pivot is not positive.
    pub(crate) fn eliminate(self) -> bool {
        let Self { panel, rest, own, rows } = self;
        let mut from = 0;
        while from < own {
            let to = own.min(from + PANEL);
            if !Arch::new().dispatch(Columns { panel: &mut *panel, from, to, rows }) {
                return false;
            }
            let (done, ahead) = panel.split_at_mut(to * rows);
            let columns = Entries { of: &done[from * rows..], rows };
            let done = Product { left: columns, right: columns, depth: to - from, rows_from: None };
            done.subtract(ahead, 0, to);
            done.subtract(rest, own, own);
            from = to;
        }
        true
    }
}

/// The columns `from..to` of a panel.
struct Columns<'m> {
    panel: &'m mut [f64],
    from: usize,
    to: usize,
    rows: usize,
}

impl WithSimd for Columns<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        columns(self.panel, self.from, self.to, self.rows)
    }
}

/// Eliminates the columns `from..to` of those `rows`, which those before have already been taken from.
#[inline(always)]
fn columns(panel: &mut [f64], from: usize, to: usize, rows: usize) -> bool {
    for j in from..to {
        let (before, column) = panel.split_at_mut(j * rows);
        let column = &mut column[j..rows];
        for k in from..j {
            let of_k = &before[k * rows + j..(k + 1) * rows];
            let factor = of_k[0];
            for (entry, of_k) in column.iter_mut().zip(of_k) {
                *entry -= factor * of_k;
            }
        }
        let pivot = column[0];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        column[0] = inverse;
        for entry in &mut column[1..] {
            *entry *= inverse;
        }
    }
    true
}

/// Columns with so many `rows` each.
#[derive(Clone, Copy)]
pub(crate) struct Entries<'m> {
    pub(crate) of: &'m [f64],
    pub(crate) rows: usize,
}

/// The product A Bᵗ of A and B with `depth` columns.
#[derive(Clone, Copy)]
pub(crate) struct Product<'m> {
    pub(crate) left: Entries<'m>,
    pub(crate) right: Entries<'m>,
    pub(crate) depth: usize,
    /// First row that counts; none for the lower triangle.
    pub(crate) rows_from: Option<usize>,
}

impl Product<'_> {
    /// Takes it from a `matrix` whose first row is its row `top` and whose first column is its column `first`.
    pub(crate) fn subtract(self, matrix: &mut [f64], top: usize, first: usize) {
        let stride = self.left.rows - top;
        if matrix.len() * self.depth < WORTH_THREADS {
            Arch::new().dispatch(Difference { product: self, matrix, top, first });
        } else {
            let mut columns: Vec<_> = matrix.chunks_mut(TOGETHER * stride).collect();
            threads::each(&mut columns, usize::MAX, &|k, matrix| {
                let first = first + k * TOGETHER;
                Arch::new().dispatch(Difference { product: self, matrix, top, first });
            });
        }
    }
}

/// See [`Product::subtract`].
struct Difference<'m> {
    product: Product<'m>,
    matrix: &'m mut [f64],
    top: usize,
    first: usize,
}

impl WithSimd for Difference<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { product, matrix, top, first } = self;
        let stride = product.left.rows - top;
        let (mut j, end) = (first, first + matrix.len().checked_div(stride).unwrap_or(0));
        while j < end {
            let from = product.rows_from.unwrap_or(j);
            let target = &mut matrix[(j - first) * stride + from - top..];
            if j + 4 <= end {
                product.strip::<4>(target, stride, from, j);
                j += 4;
            } else if j + 2 <= end {
                product.strip::<2>(target, stride, from, j);
                j += 2;
            } else {
                product.strip::<1>(target, stride, from, j);
                j += 1;
            }
        }
    }
}

impl Product<'_> {
    /// C columns from `j` on, and all rows from `from` on.
    #[inline(always)]
    fn strip<const C: usize>(&self, target: &mut [f64], stride: usize, from: usize, j: usize) {
        let mut i = from;
        while i + 8 <= self.left.rows {
            self.tile::<8, C>(&mut target[i - from..], stride, i, j);
            i += 8;
        }
        while i + 2 <= self.left.rows {
            self.tile::<2, C>(&mut target[i - from..], stride, i, j);
            i += 2;
        }
        if i < self.left.rows {
            self.tile::<1, C>(&mut target[i - from..], stride, i, j);
        }
    }

    /// R×C entries from row `i` and column `j` on.
    #[inline(always)]
    fn tile<const R: usize, const C: usize>(&self, target: &mut [f64], stride: usize, i: usize, j: usize) {
        let Self { left, right, .. } = self;
        let mut sums = [[0.0; R]; C];
        for k in 0..self.depth {
            let a = &left.of[k * left.rows + i..k * left.rows + i + R];
            let b = &right.of[k * right.rows + j..k * right.rows + j + C];
            for (sums, b) in sums.iter_mut().zip(b) {
                for (sum, a) in sums.iter_mut().zip(a) {
                    *sum += a * b;
                }
            }
        }
        for (c, sums) in sums.iter().enumerate() {
            for (target, sum) in target[c * stride..c * stride + R].iter_mut().zip(sums) {
                *target -= sum;
            }
        }
    }
}
