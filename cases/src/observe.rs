//! Observables of a simulation after a time step.

pub(crate) mod bulk;
pub(crate) mod energy;
pub(crate) mod homogenised;
pub(crate) mod shape;
pub(crate) mod stress;

use crate::detect::Side;
use bulk::Bulk;
use energy::Energy;
use shape::Shape;
use stress::Stress;

/// Observables of a simulation after a time step.
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
    /// Sum of the overlaps of that problem, per grain (m).
    pub mean_overlap: f64,
    /// Sums of the normal impulses that the floor with its bumps, or the drum, and all segments that no force drives gave in the time
    /// step, then the walls left and right, and in space those behind and before (N·s). Where there is a lid, left and right are its guides.
    pub wall_impulses: [f64; 5],
    /// Contacts of the problem.
    pub contacts: usize,
    /// Greatest distance of a grain from where it was when time began (m).
    pub greatest_displacement: f64,
    /// Greatest speed of a grain (m/s).
    pub greatest_speed: f64,
    /// Energy balance of the time step.
    pub energy: Energy,
    /// Stress and coordination of the contacts.
    pub stress: Stress,
    /// Properties of the packing away from its walls and its surface.
    pub bulk: Bulk,
    /// Shape of the packing, and what has left it.
    pub shape: Shape,
}

/// Sums of the normal impulses `r` (N·s): of the floor with its bumps, or the drum, and all segments, then of each other wall.
pub(crate) fn wall_impulses(sides: &[Side], r: &(impl Iterator<Item = f64> + Clone)) -> [f64; 5] {
    let mut sums = [0.0; 5];
    for (side, r) in sides.iter().zip(r.clone()) {
        match side {
            Side::Floor | Side::Drum | Side::Bump(_) | Side::Segment(_) => sums[0] += r,
            Side::Left => sums[1] += r,
            Side::Right => sums[2] += r,
            Side::Back => sums[3] += r,
            Side::Front => sums[4] += r,
            Side::Grain(_) | Side::Lid(..) | Side::Driven(..) | Side::Guide(_) => {}
        }
    }
    sums
}
