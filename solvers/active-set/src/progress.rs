//! Progress of the iterations of a method that leads to the neighbourhood of a solution.

/// Iterations so far; and what was left when it was last halved (√J), and at which of them.
pub(crate) struct Progress {
    pub(crate) iterations: u64,
    halved: (f64, u64),
}

impl Progress {
    /// None so far, with so much left (√J).
    pub(crate) fn from(left: f64) -> Self {
        Self { iterations: 0, halved: (left, 0) }
    }

    /// Reports whether the residual `left` (√J) after these iterations is no progress in the last `patience`.
    pub(crate) fn is_in_vain(&mut self, left: f64, patience: u64) -> bool {
        if left <= 0.5 * self.halved.0 {
            self.halved = (left, self.iterations);
        }
        self.iterations >= self.halved.1 + patience || !left.is_finite()
    }
}
