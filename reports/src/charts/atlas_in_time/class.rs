//! Class of a simulation, judged by its series beside that of the reference of its scene.

use crate::draw::{Cell, ColorScale, RGBColor};
use results::simulation::Observed;

use crate::read::{Simulation, median};

/// Outcome of a simulation, from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
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
}

/// The mean height is off, or the greatest overlap larger than the reference's, by more than this many mean diameters.
pub(crate) const CREEP: f64 = 0.05;
/// Kinetic energy is above that of the reference by more than this share of it, and more than grains have at this share of
/// the speed that free fall gives in a time step.
pub(crate) const MORE_ENERGY: f64 = 1.0;
pub(crate) const SHARE_OF_FALL: f64 = 0.1;

/// Differences of a simulation from the reference, over the second half of the common times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drift {
    /// Median difference of the mean heights, over the mean diameter.
    pub(crate) height: f64,
    /// Median excess of the greatest overlap over that of the reference, over the mean diameter.
    pub(crate) overlap: f64,
    /// Median kinetic energies: the simulation's and the reference's (J).
    pub(crate) energies: [f64; 2],
}

impl Class {
    /// In the order of badness, each with its name, the ground of its cell, whose lightness falls with the badness, so that it
    /// reads in grey, and its letter.
    pub(crate) const ALL: [(Self, &'static str, RGBColor, &'static str); 6] = [
        (Self::Stable, "stable", RGBColor(225, 240, 232), "s"),
        (Self::Jittering, "jittering", RGBColor(242, 205, 120), "j"),
        (Self::Creeping, "creeping", RGBColor(205, 110, 50), "c"),
        (Self::Exploded, "exploded", RGBColor(110, 45, 85), "x"),
        (Self::NoSolution, "no solution", RGBColor(70, 20, 60), "n"),
        (Self::SolverDiverged, "solver diverged", RGBColor(30, 8, 30), "d"),
    ];

    pub(crate) fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    pub(crate) fn cell(class: Option<Self>) -> Cell {
        let known = class.map(|class| Self::ALL[class as usize]);
        let (fill, letter) =
            known.map_or((RGBColor(248, 248, 248), "–"), |(.., fill, letter)| (fill, letter));
        Cell { fill, letter, ink: ColorScale::ink_on(fill) }
    }
}

/// Drift over the second half; none if the simulation did not come to the end of the reference.
pub(crate) fn drift(simulation: &Simulation, reference: &Simulation) -> Option<Drift> {
    let (x, y) = (simulation.series(), reference.series());
    if x.is_empty() || x.len() != y.len() {
        return None;
    }
    let half = x.len() / 2;
    let (x, y) = (&x[half..], &y[half..]);
    let d = reference.mean_diameter_m;
    let difference = |of: fn(&Observed) -> f64| median(x.iter().zip(y).map(|(x, y)| of(x) - of(y)).collect());
    let energy = |series: &[Observed]| median(series.iter().map(|row| row.kinetic_energy_j).collect());
    Some(Drift {
        height: difference(|row| row.mean_height_m)? / d,
        overlap: difference(|row| row.greatest_overlap_m)? / d,
        energies: [energy(x)?, energy(y)?],
    })
}

/// The class; none of a simulation that was refused, or where there is no reference to judge it by.
pub(crate) fn class(simulation: &Simulation, reference: Option<&Simulation>) -> Option<Class> {
    match &*simulation.status {
        "exploded" => return Some(Class::Exploded),
        "no-solution" => return Some(Class::NoSolution),
        "solver-diverged" => return Some(Class::SolverDiverged),
        _ => {}
    }
    let drift = drift(simulation, reference?)?;
    let fall = SHARE_OF_FALL * simulation.gravity_m_per_s2 * simulation.time_step_s;
    let noise = 0.5 * simulation.mass_kg * fall * fall;
    let [energy, of_reference] = drift.energies;
    Some(if drift.height.abs() > CREEP || drift.overlap > CREEP {
        Class::Creeping
    } else if energy - of_reference > f64::max(noise, MORE_ENERGY * of_reference) {
        Class::Jittering
    } else {
        Class::Stable
    })
}
