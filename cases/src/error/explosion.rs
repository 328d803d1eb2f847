//! Explosions of simulations, and the solves that they go back to.

use crate::detect::OVERLAP;
use contact::Place;
use runner::Status;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use thiserror::Error;

/// A time step that did not come to its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Missed {
    /// The time step, counted from 1.
    pub time_step: u64,
    /// Status with which its solve ended.
    pub status: Status,
}

impl Missed {
    /// Reports whether the solve failed: its impulses have no meaning, and no other time step may start from them.
    pub fn failed(self) -> bool {
        matches!(self.status, Status::Diverged | Status::Infeasible)
    }
}

impl fmt::Display for Missed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { time_step, status } = self;
        match status {
            Status::Diverged => write!(f, "the solver diverged in time step {time_step}"),
            Status::Infeasible => write!(f, "the problem of time step {time_step} has no solution"),
            status => write!(f, "the solver ended time step {time_step} with {}", status.name()),
        }
    }
}

/// A state that no longer says anything of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Explosion {
    /// A velocity is infinite or undefined.
    #[error("a velocity is not finite")]
    NotFinite,
    /// The centre of a grain has passed into another grain, or behind a wall.
    #[error("an overlap of {overlap:.3e} m is above the radius of grain {grain}, {bound:.3e} m")]
    Overlap {
        /// The grain, the smaller one of its contact.
        grain: u32,
        /// The overlap (m).
        overlap: f64,
        /// Its radius (m).
        bound: f64,
    },
    /// A grain moves by more than its diameter within a time step: it passes others unseen.
    #[error(
        "the speed of grain {grain}, {speed:.3e} m/s, is above its diameter per time step, {bound:.3e} m/s"
    )]
    Speed {
        /// The grain.
        grain: u32,
        /// Its speed (m/s).
        speed: f64,
        /// Its diameter over the time step (m/s).
        bound: f64,
    },
}

/// Detects an explosion of grains of these radii (m), from the deepest overlap of the problem just solved or the velocities (m/s)
/// found for it, over a time step of `h` (s). Each grain is judged by its own size: a bound from the mean diameter would notice too late
/// that a small grain is inside a large one.
pub(crate) fn explosion<P: Place>(
    deepest: Option<(u32, f64, f64)>,
    radius: &[f64],
    velocity: &[P],
    h: f64,
) -> Option<Explosion> {
    // Speeds are squared wherever energies are summed.
    if !velocity.iter().all(|v| v.dot_product(*v).is_finite()) {
        return Some(Explosion::NotFinite);
    }
    let speeds =
        (0_u32..).zip(velocity).map(|(grain, v)| (grain, v.length(), 2.0 * radius[grain as usize] / h));
    let overlap = |(grain, overlap, bound)| Explosion::Overlap { grain, overlap, bound };
    let deepest = deepest.filter(|(_, overlap, radius)| overlap > radius);
    let speed = |(grain, speed, bound)| Explosion::Speed { grain, speed, bound };
    deepest.map(overlap).or_else(|| worst(speeds).map(speed))
}

/// Returns the grain with the greatest overlap over its radius, if that is more than grains may begin with: the grain, the overlap
/// and the radius (m). Of the two grains of a contact the smaller one counts.
pub(crate) fn deepest(
    contacts: impl Iterator<Item = (u32, Option<u32>)>,
    gap: &[f64],
    radius: &[f64],
) -> Option<(u32, f64, f64)> {
    let size = |grain: u32| radius[grain as usize];
    let smaller = |(candidate, antagonist): (u32, Option<u32>)| {
        antagonist.filter(|j| size(*j) < size(candidate)).unwrap_or(candidate)
    };
    let overlaps = contacts.zip(gap).map(|(contact, gap)| (smaller(contact), -gap));
    let deepest = worst(overlaps.map(|(grain, overlap)| (grain, overlap, OVERLAP * size(grain))));
    deepest.map(|(grain, overlap, _)| (grain, overlap, size(grain)))
}

/// Returns the grain whose value exceeds its bound by the greatest factor; of equal ones the first.
fn worst(values: impl Iterator<Item = (u32, f64, f64)>) -> Option<(u32, f64, f64)> {
    let beyond = values.filter(|(_, value, bound)| value > bound);
    beyond.reduce(|worst, next| if next.1 / next.2 > worst.1 / worst.2 { next } else { worst })
}

#[cfg(test)]
mod tests;
