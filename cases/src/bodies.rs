//! Fixed bodies that are not straight walls: a drum that turns about its axis, and bumps that make a floor rough.

use crate::detect::{DetectedContact, Side};
use crate::scene::{MovingWall, Scene};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A hollow cylinder around the origin, in which the grains lie.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drum {
    /// Its inner radius (m).
    pub radius_m: f64,
    /// Rate at which it turns, anticlockwise (rad/s). Only friction feels it.
    #[serde(default)]
    pub spin_rad_per_s: f64,
}

impl Drum {
    /// Side of the square inside the drum (m).
    pub(crate) fn square(&self) -> f64 {
        std::f64::consts::SQRT_2 * self.radius_m
    }

    fn near(
        &self,
        grain: u32,
        position: Vector2<f64>,
        radius: f64,
        reach: f64,
    ) -> Option<(DetectedContact, [f64; 2])> {
        let distance = position.norm();
        let gap = self.radius_m - distance - radius;
        // At the centre there is no normal, and in a drum of some size no contact.
        let normal = if distance > 0.0 { -position / distance } else { Vector2::y() };
        let contact = DetectedContact { candidate: grain, antagonist: Side::Drum, normal, gap };
        // The surface at −R n moves at −Ω R t, t = (−n_y, n_x).
        (gap <= reach).then_some((contact, [0.0, self.spin_rad_per_s * self.radius_m]))
    }
}

/// Discs of radius a with their centres on the floor, side by side.
#[derive(Clone, Copy, Debug)]
struct Bumps {
    radius: f64,
    floor: MovingWall,
}

impl Bumps {
    fn near(
        self,
        grain: u32,
        position: Vector2<f64>,
        radius: f64,
        reach: f64,
    ) -> impl Iterator<Item = (DetectedContact, [f64; 2])> {
        let Self { radius: a, floor } = self;
        let (from_foot, touching) = (position - floor.now.foot, radius + a);
        let far = touching + reach;
        let number = |x: f64| x / (2.0 * a);
        // None where the disc is too high.
        let wide = if from_foot.y > far { -1.0 } else { far };
        let range = number(from_foot.x - wide).ceil() as i32..=number(from_foot.x + wide).floor() as i32;
        let velocity = floor.foot_rate();
        range.filter_map(move |k| {
            let between = from_foot - Vector2::new(2.0 * a * f64::from(k), 0.0);
            let distance = between.norm();
            let gap = distance - touching;
            let normal = if distance > 0.0 { between / distance } else { Vector2::y() };
            let contact = DetectedContact { candidate: grain, antagonist: Side::Bump(k), normal, gap };
            let tangent = Vector2::new(-normal.y, normal.x);
            (gap <= reach).then(|| (contact, [-normal.dot(&velocity), -tangent.dot(&velocity)]))
        })
    }
}

/// The contacts of one disc with the fixed bodies of a scene that are within `reach` (m), and what the motion of each adds to the
/// normal and tangential relative velocity (m/s).
pub(crate) fn bodies_near(
    scene: &Scene,
    floor: Option<MovingWall>,
    grain: u32,
    (position, radius): (Vector2<f64>, f64),
    reach: f64,
) -> impl Iterator<Item = (DetectedContact, [f64; 2])> {
    let drum = scene.drum.and_then(|drum| drum.near(grain, position, radius, reach));
    let bump_radius = scene.walls.as_ref().and_then(|walls| walls.bump_radius_m);
    let bumps = bump_radius.zip(floor).map(|(radius, floor)| Bumps { radius, floor });
    drum.into_iter()
        .chain(bumps.into_iter().flat_map(move |bumps| bumps.near(grain, position, radius, reach)))
}

/// Sides of the polygon that stands for a circle where it is drawn.
const SIDES: u32 = 72;

/// The drum, and the bumps on a floor between two places, to be drawn: each a line of segments from end to end (m).
pub(crate) fn outlines(scene: &Scene, [from, to]: [Vector2<f64>; 2]) -> Vec<(Side, [Vector2<f64>; 2])> {
    let circle = |side: Side, centre: Vector2<f64>, radius: f64, sides: u32| {
        let at = move |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(SIDES);
            centre + radius * Vector2::new(libm::cos(angle), libm::sin(angle))
        };
        (0..sides).map(move |k| (side, [at(k), at(k + 1)]))
    };
    let drum =
        scene.drum.into_iter().flat_map(|drum| circle(Side::Drum, Vector2::zeros(), drum.radius_m, SIDES));
    let bump_radius = scene.walls.as_ref().and_then(|walls| walls.bump_radius_m);
    let bumps = bump_radius.into_iter().flat_map(|a| {
        let last = ((to.x - from.x) / (2.0 * a)).ceil() as i32;
        (0..=last).flat_map(move |k| {
            circle(Side::Bump(k), from + Vector2::new(2.0 * a * f64::from(k), 0.0), a, SIDES / 2)
        })
    });
    drum.chain(bumps).collect()
}
