//! Bumps that make a floor or a lid rough: discs side by side, in space spheres on a square lattice.

use super::seeker::{Near, Seeker};
use crate::detect::Side;
use crate::detect::periodic::Period;
use crate::scene::Scene;
use crate::scene::walls::{MovingWall, WallMotion};
use contact::Place;

/// Discs of radius a with their centres on a line, the floor or a lid, side by side; spheres side by side along x and z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bumps<P> {
    radius: f64,
    /// The first of them (m).
    foot: P,
    /// Velocity of the line (m/s); none of a lid, which is a body itself.
    moving: Option<P>,
    /// Period after which they are the same again.
    period: Period,
    /// Index of the lid among the bodies.
    lid: u32,
}

impl<P: Place> Bumps<P> {
    /// The bumps of a scene's floor, if it has any.
    pub(crate) fn of_floor(scene: &Scene, floor: MovingWall<P>) -> Option<Self> {
        let (foot, moving) = (floor.now.foot, Some(floor.foot_rate()));
        Some(Self { radius: scene.bump_radius()?, foot, moving, period: scene.period(), lid: 0 })
    }

    /// The bumps of a scene's lid, if it has any.
    pub(crate) fn of_lid(scene: &Scene, lid: u32, foot: P) -> Option<Self> {
        Some(Self { radius: scene.bump_radius()?, foot, moving: None, period: scene.period(), lid })
    }

    /// The contacts of a grain, which rise with the number of the bump.
    pub(crate) fn near(self, seeker: &Seeker<P>) -> impl Iterator<Item = Near<P>> {
        let Self { radius: a, foot, moving, period, lid } = self;
        let (from_foot, touching) = (period.nearest(seeker.place - foot), seeker.radius + a);
        let far = touching + seeker.reach;
        let count = period.0.map(|width| (width / (2.0 * a)).round() as i32);
        let number = |x: f64| x / (2.0 * a);
        // None where the grain is too high.
        let wide = if from_foot[1].abs() > far { -1.0 } else { far };
        let (low, high) =
            (number(from_foot[0] - wide).ceil() as i32, number(from_foot[0] + wide).floor() as i32);
        let high = high.max(low - 1);
        // Where numbers begin anew within the range, those from 0 on come first.
        let turn = count.map_or(low, |count| (low.div_euclid(count) + 1) * count).clamp(low, high + 1);
        let z = if P::LEN > 2 { from_foot[2] } else { 0.0 };
        let rows = number(z - wide).ceil() as i32..=number(z + wide).floor() as i32;
        let rows = if P::LEN > 2 { rows } else { 0..=0 };
        let numbers = (turn..=high).chain(low..turn).flat_map(move |k| rows.clone().map(move |row| [k, row]));
        numbers.filter_map(move |[k, row]| {
            let between = from_foot - P::of([k, 0, row].map(|k| 2.0 * a * f64::from(k)));
            let distance = between.length();
            let normal = if distance > 0.0 { between / distance } else { P::of([0.0, 1.0, 0.0]) };
            let k = count.map_or(k, |count| k.rem_euclid(count));
            let antagonist = if moving.is_some() { Side::Bump([k, row]) } else { Side::Lid(lid, k) };
            seeker.meets(antagonist, (normal, distance - touching), || {
                moving.map_or(WallMotion::NONE, |moving| WallMotion::sliding(moving, normal))
            })
        })
    }
}
