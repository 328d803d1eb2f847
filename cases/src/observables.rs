//! What a simulation shows of itself after a time step, and when it has exploded.

use crate::detect::Side;
use nalgebra::Vector2;
use std::fmt;

/// What a simulation shows of itself after a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observables {
    /// Time reached (s).
    pub time: f64,
    /// ½ Σ m V² (J).
    pub kinetic_energy: f64,
    /// Mean height of the centres of mass, weighted by mass (m).
    pub mean_height: f64,
    /// Greatest overlap at a contact of the problem just solved (m).
    pub greatest_overlap: f64,
    /// All overlaps of that problem together, per grain (m).
    pub mean_overlap: f64,
    /// Sums of the impulses that the floor, the left and the right wall gave in the time step (N·s).
    pub wall_impulses: [f64; 3],
    /// Contacts of the problem.
    pub contacts: usize,
    /// Greatest speed of a grain (m/s).
    pub greatest_speed: f64,
}

/// A state that no longer says anything of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Explosion {
    /// A velocity is infinite or undefined.
    NotFinite,
    /// An overlap is above half the mean diameter: grains have passed into each other.
    Overlap {
        /// The greatest overlap (m).
        overlap: f64,
        /// Half the mean diameter (m).
        bound: f64,
    },
    /// A grain moves by more than the mean diameter within a time step: it passes others unseen.
    Speed {
        /// The greatest speed (m/s).
        speed: f64,
        /// The mean diameter over the time step (m/s).
        bound: f64,
    },
}

impl Observables {
    /// Whether the scene has exploded, with grains of `mean_diameter` (m) and time steps of `h` (s).
    pub fn explosion(&self, mean_diameter: f64, h: f64) -> Option<Explosion> {
        let Self { greatest_speed: speed, greatest_overlap: overlap, .. } = *self;
        let bounds = (0.5 * mean_diameter, mean_diameter / h);
        if !(speed.is_finite() && self.kinetic_energy.is_finite()) {
            Some(Explosion::NotFinite)
        } else if overlap > bounds.0 {
            Some(Explosion::Overlap { overlap, bound: bounds.0 })
        } else if speed > bounds.1 {
            Some(Explosion::Speed { speed, bound: bounds.1 })
        } else {
            None
        }
    }
}

impl fmt::Display for Explosion {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NotFinite => write!(f, "a velocity is not finite"),
            Self::Overlap { overlap, bound } => {
                write!(f, "an overlap of {overlap:.3e} m is above half the mean diameter, {bound:.3e} m")
            }
            Self::Speed { speed, bound } => write!(
                f,
                "a speed of {speed:.3e} m/s is above a mean diameter per time step, {bound:.3e} m/s"
            ),
        }
    }
}

/// Sums of the impulses `r` (N·s) that the floor, the left and the right wall gave.
pub(crate) fn wall_impulses(sides: &[Side], r: &[f64]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (side, r) in sides.iter().zip(r) {
        match side {
            Side::Floor => sums[0] += r,
            Side::Left => sums[1] += r,
            Side::Right => sums[2] += r,
            Side::Grain(_) => {}
        }
    }
    sums
}

/// The greatest speed (m/s); undefined if one is.
pub(crate) fn greatest_speed(velocity: &[Vector2<f64>]) -> f64 {
    // The greatest of numbers leaves out what is none.
    let greater = |greatest: f64, speed: f64| if speed <= greatest { greatest } else { speed };
    let speeds = velocity.iter().map(Vector2::norm);
    speeds
        .fold(0.0, |greatest: f64, speed| if greatest.is_nan() { greatest } else { greater(greatest, speed) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn observables(greatest_overlap: f64, greatest_speed: f64) -> Observables {
        Observables {
            time: 1.0,
            kinetic_energy: greatest_speed * greatest_speed,
            mean_height: 1.0,
            greatest_overlap,
            mean_overlap: 0.0,
            wall_impulses: [0.0; 3],
            contacts: 1,
            greatest_speed,
        }
    }

    #[test]
    fn explosion_is_told_by_the_bound_that_is_passed() {
        let explosion = |overlap, speed| observables(overlap, speed).explosion(0.1, 0.01);
        assert_eq!(explosion(0.05, 10.0), None);
        assert_eq!(explosion(0.06, 10.0), Some(Explosion::Overlap { overlap: 0.06, bound: 0.05 }));
        assert_eq!(explosion(0.05, 10.1), Some(Explosion::Speed { speed: 10.1, bound: 10.0 }));
        for odd in [f64::NAN, f64::INFINITY] {
            assert_eq!(explosion(0.0, odd), Some(Explosion::NotFinite));
        }
        // The square of a finite speed need not be finite.
        assert_eq!(explosion(0.0, 1e200), Some(Explosion::NotFinite));
    }

    #[test]
    fn speed_that_is_undefined_is_not_passed_over() {
        let speeds = |velocity: [f64; 3]| greatest_speed(&velocity.map(|v| Vector2::new(v, 0.0)));
        assert_eq!(speeds([1.0, -3.0, 2.0]), 3.0);
        assert!(speeds([1.0, f64::NAN, 2.0]).is_nan());
        assert!(speeds([f64::NAN, f64::INFINITY, 2.0]).is_nan());
    }
}
