//! The heights of the columns of a box, of which the lowest is at hand.

/// Heights (m) by column, in a tournament.
#[derive(Clone)]
pub(super) struct Heights {
    /// The lower of what is at 2 k and 2 k + 1 is at k, so that the lowest is at 1; the columns are last.
    lower: Vec<f64>,
    /// How many of these were looked at.
    pub(super) steps: u64,
}

impl Heights {
    /// Of so many columns, 0 each.
    pub(super) fn new(columns: usize) -> Self {
        let mut heights = Self { lower: vec![f64::INFINITY; 2 * columns.next_power_of_two()], steps: 0 };
        (0..columns).for_each(|column| heights.set(column, 0.0));
        heights
    }

    /// Where the columns begin.
    fn first(&self) -> usize {
        self.lower.len() / 2
    }

    /// Replaces the height of a column.
    pub(super) fn set(&mut self, column: usize, height: f64) {
        let mut at = self.first() + column;
        self.lower[at] = height;
        while at > 1 {
            at /= 2;
            self.steps += 1;
            let lower = self.lower[2 * at].min(self.lower[2 * at + 1]);
            if self.lower[at] == lower {
                break;
            }
            self.lower[at] = lower;
        }
    }

    /// Replaces the height of a column if it is lower.
    pub(super) fn raise(&mut self, column: usize, height: f64) {
        if height > self.lower[self.first() + column] {
            self.set(column, height);
        }
    }

    /// The first of the lowest columns, and its height.
    pub(super) fn lowest(&mut self) -> (usize, f64) {
        let (lowest, mut at) = (self.lower[1], 1);
        while at < self.first() {
            self.steps += 1;
            at = 2 * at + usize::from(self.lower[2 * at] != lowest);
        }
        (at - self.first(), lowest)
    }
}
