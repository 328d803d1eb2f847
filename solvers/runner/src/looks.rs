//! Which iterates are measured wholly, and what is looked for at powers of two.

use crate::judge::Judge;
use contact::{Measures, law};

/// Which iterates are measured wholly and shown with their measures, beside the first, the last, those of the iterations
/// 1, 2, 4, …, and all of which it is not proved that the run goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// Every one.
    Every,
    /// Every one of the first 200 iterations, then one in each two-hundredth of all: what a curve is drawn with.
    Grid,
    /// No others: nobody looks at them.
    Needed,
    /// One in so many, and nothing is proved of those between: a run ends late by as many iterations at most. Where ranks must wait
    /// for each other to prove anything, and to measure costs more than to iterate.
    OneIn(u64),
}

/// Up to this iteration all are on the grid, from there on one in so many-th of the iterations.
const ALL_UP_TO: u64 = 200;

/// The iterations that are measured whatever they are.
pub(crate) struct Grid {
    measured: Measured,
    next: u64,
}

impl Grid {
    pub(crate) fn new(measured: Measured) -> Self {
        Self { measured, next: 0 }
    }

    /// Reports whether iterates off the grid go on unseen.
    pub(crate) fn skips(&self) -> bool {
        matches!(self.measured, Measured::OneIn(_))
    }

    /// Reports whether the grid has this iteration; asked of each in its turn.
    pub(crate) fn has(&mut self, iteration: u64) -> bool {
        let due = match self.measured {
            Measured::Every => true,
            Measured::Grid => iteration >= self.next,
            Measured::Needed => false,
            Measured::OneIn(many) => iteration.is_multiple_of(many),
        };
        if due {
            self.next = iteration + (iteration / ALL_UP_TO).max(1);
        }
        due || iteration.is_power_of_two()
    }
}

/// Iteration of the first search for a proof that there is no solution; others follow at every power of two (iterations): rarely, so that
/// it costs little, and late, so that a curve shows what the measures say meanwhile. A power of two.
const FIRST_LOOK: u64 = 1024;

/// Ratio of the natural map to that of an earlier check, below which no proof is searched for (–): on a problem without solution
/// the natural map stays away from 0.
const CONVERGES: f64 = 0.9;

/// r and natural map at the last two powers of two.
pub(crate) struct Looks {
    last: (Vec<f64>, f64),
    before_last: (Vec<f64>, f64),
    /// True where the last check has proved that there is no solution.
    pub(crate) endless: bool,
}

/// No iterate, and no natural map.
impl Default for Looks {
    fn default() -> Self {
        let none = || (Vec::new(), f64::NAN);
        Self { last: none(), before_last: none(), endless: false }
    }
}

impl Looks {
    /// Looks at the iterate r, which comes after `before`, if its turn has come.
    pub(crate) fn look(
        &mut self,
        iteration: u64,
        judge: &mut impl Judge,
        measures: &Measures,
        (before, r): (&[f64], &[f64]),
    ) {
        if iteration.is_power_of_two() {
            std::mem::swap(&mut self.last, &mut self.before_last);
            self.last.0.clear();
            self.last.0.extend_from_slice(r);
            self.last.1 = measures.natural_map;
            // The impulses, and their growth in one iteration and in half of all: what is constant in them is not in it.
            self.endless = iteration >= FIRST_LOOK
                && self.stays(measures)
                && judge.any_proves_infeasible(&[
                    r.to_vec(),
                    growth(before, r),
                    growth(&self.before_last.0, r),
                ]);
        }
    }

    /// Reports whether the natural map has hardly fallen since the last check but one.
    pub(crate) fn stays(&self, measures: &Measures) -> bool {
        !(measures.natural_map < CONVERGES * self.before_last.1)
    }

    /// The impulses, and their growth since the last look but one.
    pub(crate) fn rays(&self, r: &[f64]) -> Vec<Vec<f64>> {
        vec![r.to_vec(), growth(&self.before_last.0, r)]
    }

    /// The impulses, and their growth since the last look.
    pub(crate) fn rays_of_half(&self, r: &[f64]) -> Vec<Vec<f64>> {
        vec![r.to_vec(), growth(&self.last.0, r)]
    }
}

fn growth(before: &[f64], r: &[f64]) -> Vec<f64> {
    r.iter().zip(before).map(|(r, before)| law::non_negative(r - before)).collect()
}
