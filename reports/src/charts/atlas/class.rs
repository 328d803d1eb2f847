//! The class of a run, and of a simulation beside the reference of its scene: one rule for every method.

use contact::Measure;
use results::simulation::{Observed, SimulationEnding};

use polars::df;
use polars::prelude::{Column, DataFrame};

use crate::draw::{Cell, ColorScale, INK, RGBColor, WHITE};
use crate::read::{Ending, RunRow, Sample, Simulation, median};
use crate::text::frame;

/// Outcome of a method on a problem, and then of a simulation, each from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Class {
    Converged,
    /// All iterations made, and the measure still falls.
    Slow,
    /// All iterations made, and the measure falls no more.
    Stalled,
    Diverged,
    /// The measure was met far from the solution.
    FalseConvergence,
    /// It was proved that there is no solution.
    Infeasible,
    /// Not begun.
    Skipped,
    /// Any way that this report does not know.
    Failed,
    /// It stays as near to the reference as the others do not.
    Stable,
    /// Grains move that should not, or more than they should.
    Jittering,
    /// It sinks, rises, or its grains pass into each other.
    Creeping,
    /// It was stopped: see the reason.
    Exploded,
    /// Stopped, because the problem of a time step had no solution.
    NoSolution,
    /// Stopped, because the solver diverged.
    SolverDiverged,
    /// Not made, or without a reference.
    Unjudged,
}

/// A run whose measure falls by less than this share while its iterations double is stalled (–).
const STALLED: f64 = 0.01;
/// A velocity error of more than this many times the tolerance is no convergence, as in the loop that stops runs (–).
const FAR: f64 = 100.0;
/// The mean height is off, or the greatest overlap larger than the reference's, by more than this many mean diameters.
pub(super) const CREEP: f64 = 0.05;
/// Kinetic energy is above that of the reference by more than this share of it, and more than grains have at this share of
/// the speed that free fall gives in a time step.
pub(super) const MORE_ENERGY: f64 = 1.0;
pub(super) const SHARE_OF_FALL: f64 = 0.1;

/// Name of a class, its letter and the ground of its cell, the darker the worse, so that it reads in grey.
const LOOKS: [(Class, &str, &str, RGBColor); 15] = [
    (Class::Converged, "converged", "c", RGBColor(222, 240, 232)),
    (Class::Slow, "slow", "S", RGBColor(250, 214, 110)),
    (Class::Stalled, "stalled", "T", RGBColor(224, 132, 44)),
    (Class::Diverged, "diverged", "D", RGBColor(158, 28, 48)),
    (Class::FalseConvergence, "false convergence", "F", RGBColor(62, 26, 98)),
    (Class::Infeasible, "infeasible", "i", RGBColor(200, 222, 242)),
    (Class::Skipped, "skipped", "–", WHITE),
    (Class::Failed, "failed", "?", RGBColor(90, 90, 90)),
    (Class::Stable, "stable", "s", RGBColor(225, 240, 232)),
    (Class::Jittering, "jittering", "j", RGBColor(242, 205, 120)),
    (Class::Creeping, "creeping", "k", RGBColor(205, 110, 50)),
    (Class::Exploded, "exploded", "x", RGBColor(110, 45, 85)),
    (Class::NoSolution, "no solution", "n", RGBColor(70, 20, 60)),
    (Class::SolverDiverged, "solver diverged", "d", RGBColor(30, 8, 30)),
    (Class::Unjudged, "not made, or nothing to judge it by", "–", RGBColor(248, 248, 248)),
];

impl Class {
    pub(super) fn all() -> impl Iterator<Item = Self> {
        LOOKS.into_iter().map(|(class, ..)| class)
    }

    /// Every class with its name.
    pub(super) fn cells() -> Vec<(Cell, String)> {
        Self::all().map(|class| (class.cell(), class.text().to_owned())).collect()
    }

    /// Reports whether it is of a simulation that was judged.
    pub(super) fn is_in_time(self) -> bool {
        (Self::Stable..Self::Unjudged).contains(&self)
    }

    /// The class of a run.
    pub(super) fn of(run: &RunRow) -> Self {
        match run.status {
            Ending::Converged if is_far(run, run.curve.last()) => Self::FalseConvergence,
            Ending::Converged => Self::Converged,
            Ending::IterationLimit if falls(run) => Self::Slow,
            Ending::IterationLimit | Ending::Stalled => Self::Stalled,
            Ending::Diverged => Self::Diverged,
            Ending::Infeasible => Self::Infeasible,
            Ending::FalseConvergence => Self::FalseConvergence,
            Ending::Skipped => Self::Skipped,
            Ending::Failed | Ending::Given => Self::Failed,
        }
    }

    /// The class of a simulation; [`Class::Unjudged`] if it was refused, or where there is no reference to judge it by.
    pub(super) fn in_time(simulation: &Simulation, reference: Option<&Simulation>) -> Self {
        match simulation.status {
            SimulationEnding::Exploded => return Self::Exploded,
            SimulationEnding::NoSolution => return Self::NoSolution,
            SimulationEnding::SolverDiverged => return Self::SolverDiverged,
            SimulationEnding::Completed | SimulationEnding::Skipped => {}
        }
        let Some(drift) = reference.and_then(|reference| Drift::of(simulation, reference)) else {
            return Self::Unjudged;
        };
        let fall = SHARE_OF_FALL * simulation.gravity_m_per_s2 * simulation.time_step_s;
        let noise = 0.5 * simulation.mass_kg * fall * fall;
        let [energy, of_reference] = drift.energies;
        if drift.height.abs() > CREEP || drift.overlap > CREEP {
            Self::Creeping
        } else if energy - of_reference > f64::max(noise, MORE_ENERGY * of_reference) {
            Self::Jittering
        } else {
            Self::Stable
        }
    }

    /// Reports whether the method did well: it found the solution, or proved that there is none.
    pub(super) fn is_good(self) -> bool {
        matches!(self, Self::Converged | Self::Infeasible | Self::Stable)
    }

    pub(super) fn text(self) -> &'static str {
        LOOKS[self as usize].1
    }

    pub(super) fn cell(self) -> Cell {
        let (_, _, letter, fill) = LOOKS[self as usize];
        // What is well stands back.
        let pale = self.is_good() || self == Self::Skipped;
        Cell { fill, letter, ink: if pale { INK } else { ColorScale::ink_on(fill) } }
    }
}

/// Reports whether a point is far from the true velocity; `false` where that is not known.
fn is_far(run: &RunRow, point: Option<&Sample>) -> bool {
    let (Some(tolerance), Some(error)) = (run.tolerance, point.and_then(Sample::velocity_error)) else {
        return false;
    };
    error > FAR * tolerance
}

/// Reports whether ζ first met the tolerance at an iterate far from the solution, or of a problem that has none.
pub(super) fn zeta_is_false(run: &RunRow) -> bool {
    let met = |point: &&Sample| {
        point.get(Measure::Zeta).zip(run.tolerance).is_some_and(|(zeta, tolerance)| zeta <= tolerance)
    };
    let first = run.curve.iter().find(met);
    first.is_some_and(|point| run.status == Ending::Infeasible || is_far(run, Some(point)))
}

/// Reports whether the measure still falls: its least value in the second half of the iterations is more than 1 % below
/// that in the first.
fn falls(run: &RunRow) -> bool {
    let half = run.iterations / 2;
    let least = |late: bool| {
        let points = run.curve.iter().filter(|point| (point.iteration > half) == late);
        points.filter_map(|point| point.get(run.stopped_on())).fold(f64::INFINITY, f64::min)
    };
    least(true) < (1.0 - STALLED) * least(false)
}

/// Differences of a simulation from the reference, over the second half of the common times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    /// Median difference of the mean heights, over the mean diameter.
    pub(super) height: f64,
    /// Median excess of the greatest overlap over that of the reference, over the mean diameter.
    pub(super) overlap: f64,
    /// Median kinetic energies: the simulation's and the reference's (J).
    pub(super) energies: [f64; 2],
}

impl Drift {
    /// Drift over the second half; none if the simulation did not come to the end of the reference.
    pub(super) fn of(simulation: &Simulation, reference: &Simulation) -> Option<Self> {
        let (x, y) = (simulation.series(), reference.series());
        if x.is_empty() || x.len() != y.len() {
            return None;
        }
        let half = x.len() / 2;
        let (x, y) = (&x[half..], &y[half..]);
        let d = reference.mean_diameter_m;
        let difference =
            |of: fn(&Observed) -> f64| median(x.iter().zip(y).map(|(x, y)| of(x) - of(y)).collect());
        let energy = |series: &[Observed]| median(series.iter().map(|row| row.kinetic_energy_j).collect());
        Some(Self {
            height: difference(|row| row.mean_height_m)? / d,
            overlap: difference(|row| row.greatest_overlap_m)? / d,
            energies: [energy(x)?, energy(y)?],
        })
    }
}

/// One row per method: its settings or rules, and how many of its runs have each of `classes`.
pub(super) fn counts(
    methods: &[(String, usize, Vec<Class>)],
    classes: impl Iterator<Item = Class>,
) -> DataFrame {
    let table = frame(df!(
        "method" => methods.iter().map(|(method, ..)| method.as_str()).collect::<Vec<_>>(),
        "settings" => methods.iter().map(|(_, settings, _)| *settings as u64).collect::<Vec<_>>(),
    ));
    let count = |class: Class| {
        let of = |(.., all): &(_, _, Vec<Class>)| all.iter().filter(|other| **other == class).count() as u64;
        Column::new(class.text().replace(' ', "_").into(), methods.iter().map(of).collect::<Vec<_>>())
    };
    frame(table.hstack(&classes.map(count).collect::<Vec<_>>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_tell_all_classes_apart() {
        let letters: Vec<&str> =
            LOOKS.iter().map(|(_, _, letter, _)| *letter).filter(|letter| *letter != "–").collect();
        let apart: std::collections::BTreeSet<&str> = letters.iter().copied().collect();
        assert_eq!(apart.len(), letters.len(), "{letters:?}");
    }
}
