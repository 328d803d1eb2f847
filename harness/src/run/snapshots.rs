//! The iterates of a run that a page shows, spaced like a geometric sequence.

use results::schema::Snapshot;
use runner::{Outcome, Progress};

/// Keeps the beginning of a run, iterations in a ratio of about 1.4, and its end: some thirty iterates of a hundred thousand.
pub(crate) struct Snapshots {
    snapshots: Vec<Snapshot>,
    /// The next iteration to be kept.
    next: u64,
}

impl Snapshots {
    pub(crate) fn new() -> Self {
        Self { snapshots: Vec::new(), next: 0 }
    }

    /// Sees every iterate.
    pub(crate) fn observe(&mut self, progress: &Progress) {
        if progress.iteration == self.next {
            self.snapshots.push(kept(self.next, progress.measures.natural_map, progress.impulses));
            self.next += (2 * self.next).div_ceil(5).max(1);
        }
    }

    /// The iterates; the last one is that of the outcome.
    pub(crate) fn finish(mut self, outcome: &Outcome) -> Vec<Snapshot> {
        if self.snapshots.last().is_none_or(|last| last.iteration != outcome.iterations) {
            self.snapshots.push(kept(outcome.iterations, outcome.measures.natural_map, &outcome.impulses));
        }
        self.snapshots
    }
}

fn kept(iteration: u64, natural_map: f64, impulses: &[f64]) -> Snapshot {
    Snapshot { iteration, natural_map, impulses_n_s: impulses.iter().copied().map(rounded).collect() }
}

/// To three significant digits: it is for the eye.
fn rounded(r: f64) -> f64 {
    format!("{r:.2e}").parse().ok().filter(|rounded: &f64| rounded.is_finite()).unwrap_or(f64::NAN)
}
