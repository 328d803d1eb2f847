//! The heights of the columns of a box, of which the lowest is at hand.

use std::collections::BTreeSet;

/// Heights by column (m), none negative.
#[derive(Clone)]
pub(super) struct Heights {
    height: Vec<f64>,
    /// Bits of each height, which rise with it, and its column.
    rising: BTreeSet<(u64, usize)>,
}

impl Heights {
    /// Creates the heights of a number of columns, 0 each.
    pub(super) fn new(columns: usize) -> Self {
        let rising = (0..columns).map(|column| (0.0_f64.to_bits(), column));
        Self { height: vec![0.0; columns], rising: rising.collect() }
    }

    /// Replaces the height of a column.
    pub(super) fn set(&mut self, column: usize, height: f64) {
        let before = std::mem::replace(&mut self.height[column], height);
        self.rising.remove(&(before.to_bits(), column));
        self.rising.insert((height.to_bits(), column));
    }

    /// Replaces the height of a column if it is lower.
    pub(super) fn raise(&mut self, column: usize, height: f64) {
        if height > self.height[column] {
            self.set(column, height);
        }
    }

    /// The first of the lowest columns, and its height.
    pub(super) fn lowest(&self) -> Option<(usize, f64)> {
        self.rising.first().map(|&(bits, column)| (column, f64::from_bits(bits)))
    }
}
