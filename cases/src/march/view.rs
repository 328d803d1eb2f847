//! The state of a scene on its way through time, as others see it.

use super::March;
use crate::bodies::drawn::drawn;
use crate::bodies::driven::{DrivenSegment, PlacedLid};
use crate::detect::extent::reach;
use crate::detect::{OVERLAP, Side};
use crate::observe::bulk::Bulk;
use crate::observe::energy::Energy;
use crate::observe::shape::Shape;
use crate::observe::stress::Stress;
use crate::observe::{Observables, wall_impulses};
use crate::problem::marched::{Marched, translation};
use crate::problem::time_step::TimeStep;
use crate::scene::{Law, too_far};
use contact::{Mass, Place, Vector, greatest, shown};

impl<M: Marched> March<M> {
    /// Returns the unusual values of its scene, each by its key.
    pub fn warnings(&self) -> Vec<String> {
        self.scene.warnings(self.radius.iter().copied().fold(f64::INFINITY, f64::min))
    }

    /// Returns the warnings of the last time step: of a grain that moved by more than its radius, and of a deep overlap.
    pub fn time_step_warnings(&self) -> [Option<String>; 2] {
        [self.moved_too_far(), self.overlapped()]
    }

    fn moved_too_far(&self) -> Option<String> {
        let h = self.scene.time_step_s;
        let moved = (0..self.grain_count()).map(|k| (k, translation::<M>(self.velocity[k]).length() * h));
        let (grain, by) = moved.into_iter().find(|(k, by)| *by > self.radius[*k])?;
        let moves = format!("time step {} moves grain {grain} by {} m", self.done, shown(by));
        Some(too_far(h, &moves, self.radius[grain]))
    }

    fn overlapped(&self) -> Option<String> {
        let (grain, overlap, radius) = self.overlap?;
        let key = match (self.scene.law, self.scene.recovery_per_s) {
            (Law::Iqs, None) => "`scene.recovery_per_s`",
            (Law::Iqs, _) => "a smaller tolerance",
            // These laws leave out a contact that closes only as another grain is pushed.
            _ => "a smaller `scene.time_step_s`",
        };
        Some(format!(
            "time step {} found an overlap of {overlap:.3e} m at grain {grain}, more than {OVERLAP} of its radius, {radius:.3e} m: \
             {key} may reduce it",
            self.done
        ))
    }

    /// Mean diameter of the grains (m).
    pub fn mean_diameter(&self) -> f64 {
        let radius = &self.radius[..self.grain_count()];
        2.0 * radius.iter().sum::<f64>() / radius.len() as f64
    }

    /// Returns the position of another grain, or of its periodic image if that is nearer to a place; `None` for other bodies, which
    /// extend across the scene.
    pub fn beside(&self, place: M::Place, other: u32) -> Option<M::Place> {
        let there = (self.position.get(other as usize)).filter(|_| (other as usize) < self.grain_count())?;
        let period = self.scene.period();
        // To the bit where nothing is periodic.
        Some(period.0.map_or(*there, |_| place - period.nearest(place - *there)))
    }

    /// The grains, and last a lid or driven segments, as they are: radius (m), place (m) and velocity (m/s) of each.
    pub fn grains(&self) -> impl Iterator<Item = (f64, M::Place, M::Place)> {
        self.radius
            .iter()
            .zip(&self.position)
            .zip(&self.velocity)
            .map(|((r, q), v)| (*r, *q, translation::<M>(*v)))
    }

    /// Returns the greatest distance of a grain from where it was when time began, or of its periodic image if that is nearer (m).
    fn greatest_displacement(&self) -> f64 {
        let moved = |(k, from): (u32, &M::Place)| (self.beside(*from, k).unwrap_or(*from) - *from).length();
        (0..).zip(&self.origin[..self.grain_count()]).map(moved).fold(0.0, f64::max)
    }

    /// Mass of each grain (kg), and its moment of inertia (kg m²), if it spins.
    pub fn mass(&self) -> &[M::Mass] {
        &self.mass
    }

    /// Velocity of each grain (m/s), and its spin (rad/s), if it has any.
    pub fn velocity(&self) -> &[M::Velocity] {
        &self.velocity
    }

    /// The walls and other bodies as they stand, to be drawn, by their corners (m): the floor from left to right, the others from their
    /// feet to as high as the highest grain. What is not between walls is as wide as the grains. In the plane each is a segment, in
    /// space of four corners.
    pub fn walls(&self) -> Vec<(Side, Vec<M::Place>)> {
        let reach = |along: M::Place| reach(&self.position, &self.radius, along);
        let mut walls = drawn(&self.scene, self.time(), reach);
        let lid = PlacedLid::of(&self.scene, &self.position, &self.radius);
        walls.extend(lid.and_then(PlacedLid::drawn));
        let driven = DrivenSegment::all(&self.scene, &self.position, |_| M::Place::ZERO);
        walls.extend(driven.iter().flat_map(DrivenSegment::drawn));
        walls
    }

    /// Observables after the time step, with its impulses `r` (N·s) and its energy.
    pub(super) fn observe(&self, time_step: &TimeStep<M>, r: &[f64], energy: Energy) -> Observables {
        let kinetic = self.mass.iter().zip(&self.velocity).map(|(m, v)| 0.5 * m.squared(*v));
        let grains = self.grain_count();
        let mass: Vec<f64> = self.mass[..grains].iter().map(|mass| M::weight(*mass)).collect();
        let moment = mass.iter().zip(&self.position).map(|(m, q)| m * q[1]);
        let height = PlacedLid::of(&self.scene, time_step.frozen.problem.position(), &self.radius);
        let height = height.map(|lid| lid.foot[1]);
        let area = self.scene.period().0.zip(height).map(|(width, height)| width * height);
        let overlaps = || time_step.frozen.gap.iter().map(|gap| f64::max(0.0, -gap));
        let time = self.time();
        Observables {
            time,
            kinetic_energy: kinetic.sum(),
            mean_height: moment.sum::<f64>() / mass.iter().sum::<f64>(),
            greatest_overlap: overlaps().fold(0.0, f64::max),
            mean_overlap: overlaps().sum::<f64>() / grains as f64,
            wall_impulses: wall_impulses(&time_step.sides, &r.iter().step_by(M::Impulse::LEN).copied()),
            contacts: time_step.sides.len(),
            energy,
            stress: Stress::of(time_step, &self.scene, (grains, area), r),
            bulk: Bulk::of(time_step, &self.scene, (grains, time), r),
            shape: Shape::of(time_step, (&self.scene, time), (&mass, &self.position, &self.radius), r),
            greatest_displacement: self.greatest_displacement(),
            greatest_speed: greatest(self.velocity[..grains].iter().map(|v| translation::<M>(*v).length())),
        }
    }
}
