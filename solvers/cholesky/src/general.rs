//! Factors L U of any sparse matrix, entry by entry, where no blocks of grains make it up (crate `rsparse`).

use crate::Singular;
use rsparse::data::{Nmrc, Sprs};

/// The order as it is, and one by minimum degree of A + Aᵗ, which needs three rows.
const NATURAL: i8 = -1;
const OF_SYMMETRIC_PATTERN: i8 = 0;

/// A pivot may be this small beside the greatest of its column, if it is on the diagonal (–): rows exchanged for less add entries.
const PIVOT: f64 = 0.1;

/// The factors of a matrix of which entries stand about as often above the diagonal as below it.
pub struct General {
    factors: Nmrc<f64>,
    /// The place of each row among the pivots.
    row: Vec<isize>,
    /// The column of each pivot.
    column: Vec<isize>,
}

impl General {
    /// Factorises a matrix with so many rows and columns, given by the row, the column and the value of its entries; values of one place
    /// are added up.
    ///
    /// # Errors
    /// Where it is singular, or empty.
    pub fn new(size: usize, mut entries: Vec<(usize, usize, f64)>) -> Result<Self, Singular> {
        entries.sort_by_key(|(row, column, _)| (*column, *row));
        entries.dedup_by(|next, kept| {
            let is_same = (next.0, next.1) == (kept.0, kept.1);
            if is_same {
                kept.2 += next.2;
            }
            is_same
        });
        let first = |column: usize| entries.partition_point(|entry| entry.1 < column).cast_signed();
        let matrix = Sprs {
            nzmax: entries.len(),
            m: size,
            n: size,
            p: (0..=size).map(first).collect(),
            i: entries.iter().map(|entry| entry.0).collect(),
            x: entries.iter().map(|entry| entry.2).collect(),
        };
        if entries.is_empty() {
            return Err(Singular::new("a matrix without entries"));
        }
        let order = if size < 3 { NATURAL } else { OF_SYMMETRIC_PATTERN };
        let mut symbolic = rsparse::sqr(&matrix, order, false);
        let mut factors = rsparse::lu(&matrix, &mut symbolic, PIVOT).map_err(Singular::new)?;
        let row = factors.pinv.take().unwrap_or_default();
        let mut column = symbolic.q.unwrap_or_else(|| (0..size.cast_signed()).collect());
        column.truncate(size);
        Ok(Self { factors, row, column })
    }

    /// Returns the number of multiply-adds that made the factors.
    pub fn multiply_adds(&self) -> u64 {
        let Nmrc { l, u, .. } = &self.factors;
        let mut beside = vec![0_u64; l.n];
        u.i.iter().take(u.p[u.n].cast_unsigned()).for_each(|row| beside[*row] += 1);
        let below = l.p.windows(2).map(|ends| (ends[1] - ends[0]).cast_unsigned() as u64);
        // Diagonal entries are in no update.
        below.zip(beside).map(|(below, beside)| below.saturating_sub(1) * beside.saturating_sub(1)).sum()
    }

    /// x ← A⁻¹ x.
    pub fn solve(&self, x: &mut [f64]) {
        let mut y = vec![0.0; x.len()];
        self.row.iter().zip(&*x).for_each(|(place, x)| y[place.cast_unsigned()] = *x);
        rsparse::lsolve(&self.factors.l, &mut y);
        rsparse::usolve(&self.factors.u, &mut y);
        self.column.iter().zip(&y).for_each(|(place, y)| x[place.cast_unsigned()] = *y);
    }

    /// x ← A⁻ᵗ x.
    pub fn solve_transposed(&self, x: &mut [f64]) {
        let mut y: Vec<f64> = self.column.iter().map(|place| x[place.cast_unsigned()]).collect();
        rsparse::utsolve(&self.factors.u, &mut y);
        rsparse::ltsolve(&self.factors.l, &mut y);
        self.row.iter().zip(x).for_each(|(place, x)| *x = y[place.cast_unsigned()]);
    }
}
