//! Fixed bodies that are not straight walls: a drum that turns about its axis, and bumps that make a floor rough. In space the drum is
//! a cylinder along z, and bumps are spheres on a square lattice.

use crate::detect::periodic::Period;
use crate::detect::{DetectedContact, Side};
use crate::scene::Scene;
use crate::scene::joints::{Disc, Line};
use crate::scene::walls::{MovingWall, WallMotion};
use contact::Place;
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

    /// How far a grain is from the surface (m); negative outside.
    pub(crate) fn gap<P: Place>(&self, position: P, radius: f64) -> f64 {
        self.radius_m - across(position).length() - radius
    }

    /// The contact of a grain, if it is within `reach` (m). The wall curves towards a grain that slides along it: a
    /// gap of none that only opens or stays as the normal says would become an overlap of (h v)²/2(R − r). So the contact knows the gap
    /// where the free motion along the wall leads.
    fn near<P: Place>(&self, grain: u32, disc: Disc<P>, reach: f64) -> Option<Near<P>> {
        let Disc { place, radius, ahead, .. } = disc;
        let (distance, gap) = (across(place).length(), self.gap(place, radius));
        // At the centre there is no normal, and in a drum of some size no contact.
        let upwards = P::of([0.0, 1.0, 0.0]);
        let normal = if distance > 0.0 { -across(place) / distance } else { upwards };
        let contact = DetectedContact { candidate: grain, antagonist: Side::Drum, normal, gap };
        // The surface at −R n moves at Ω R (n_y, −n_x).
        let tangent = P::of([normal[1], -normal[0], 0.0]);
        let sliding = tangent * (self.spin_rad_per_s * self.radius_m);
        let (room, along) = (self.radius_m - radius, tangent.dot_product(ahead));
        // √(room² − along²) − distance.
        let there = (room * room - along * along).max(0.0).sqrt() - distance;
        (gap <= reach).then_some((contact, WallMotion { opening: 0.0, sliding, ahead: Some(there) }))
    }
}

/// A contact, and how the body moves there.
pub(crate) type Near<P> = (DetectedContact<P>, WallMotion<P>);

/// What of a place is in the plane of x and y.
fn across<P: Place>(place: P) -> P {
    P::of([place[0], place[1], 0.0])
}

/// Discs of radius a with their centres on a line, the floor or a lid, side by side; spheres side by side along x and z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bumps<P> {
    pub(crate) radius: f64,
    /// The first of them (m).
    pub(crate) foot: P,
    /// How the line moves, where that is known beforehand (m/s).
    pub(crate) moving: P,
    /// After which they are the same again.
    pub(crate) period: Period,
    /// What the k-th of a row is.
    pub(crate) side: fn(u32, [i32; 2]) -> Side,
}

impl<P: Place> Bumps<P> {
    /// The contacts of a grain, which rise with the number of the bump; `body` is that of a lid.
    pub(crate) fn near(
        self,
        body: u32,
        grain: u32,
        (position, radius): (P, f64),
        reach: f64,
    ) -> impl Iterator<Item = Near<P>> {
        let Self { radius: a, foot, moving, period, side } = self;
        let (from_foot, touching) = (period.nearest(position - foot), radius + a);
        let far = touching + reach;
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
            let gap = distance - touching;
            let normal = if distance > 0.0 { between / distance } else { P::of([0.0, 1.0, 0.0]) };
            let antagonist = side(body, [count.map_or(k, |count| k.rem_euclid(count)), row]);
            let contact = DetectedContact { candidate: grain, antagonist, normal, gap };
            let motion = WallMotion { opening: -normal.dot_product(moving), sliding: moving, ahead: None };
            (gap <= reach).then_some((contact, motion))
        })
    }
}

/// The contacts of one grain with the bodies of a scene that are within `reach` (m), and how each of these moves.
pub(crate) fn bodies_near<P: Place>(
    (scene, line): (&Scene, &Line<P>),
    floor: Option<MovingWall<P>>,
    grain: u32,
    disc: Disc<P>,
    reach: f64,
) -> impl Iterator<Item = Near<P>> {
    let drum = scene.drum.and_then(|drum| drum.near(grain, disc, reach));
    let bumps = scene.bump_radius().zip(floor).map(|(radius, floor)| Bumps {
        radius,
        foot: floor.now.foot,
        moving: floor.foot_rate(),
        period: scene.period(),
        side: |_, k| Side::Bump(k),
    });
    let Disc { place, radius, .. } = disc;
    drum.into_iter()
        .chain(bumps.into_iter().flat_map(move |bumps| bumps.near(0, grain, (place, radius), reach)))
        .chain(line.near(grain, disc, reach))
}
