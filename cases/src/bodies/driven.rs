//! Bodies that a given force drives: a lid on the grains of a periodic box, and segments.
//!
//! They are the last grains of the contact problem, and contacts with them are those of grains with a body; on the bumps of a lid too.
//! Two frictionless guides each, of a segment among spheres four, hold them on the one direction along which they move, and a lid at its speed along x: they are
//! contacts of the problem as well. A moment of inertia beyond all others keeps them from turning.

use super::bumps::Bumps;
use super::drawn::outline;
use super::seeker::{Near, Seeker};
use crate::detect::{DetectedContact, Side};
use crate::scene::Scene;
use crate::scene::beside::Approach;
use crate::scene::driven::Driven;
use crate::scene::segments::Segment;
use crate::scene::walls::WallMotion;
use contact::{Place, frame};
use nalgebra::Vector3;

/// The contacts of a body with its two guides, each with its normal and the rate at which it opens (m/s).
fn guides<P: Place>(body: u32, guides: impl IntoIterator<Item = (Side, P, f64)>) -> Vec<Near<P>> {
    let guide = |(antagonist, normal, opening)| {
        let contact = DetectedContact { candidate: body, antagonist, normal, gap: 0.0 };
        (contact, WallMotion { opening, ..WallMotion::NONE })
    };
    guides.into_iter().map(guide).collect()
}

/// The lid of a scene where contacts are sought.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedLid<'s, P> {
    scene: &'s Scene,
    /// Its index among the bodies.
    body: u32,
    /// Point of its surface, at the first bump (m).
    pub(crate) foot: P,
    /// Speed of its guides towards +x (m/s).
    speed: f64,
}

impl<'s, P: Place> PlacedLid<'s, P> {
    /// The lid of a scene with its bodies at these positions (m), of which it is the last.
    pub(crate) fn of(scene: &'s Scene, position: &[P], radius: &[f64]) -> Option<Self> {
        let speed = scene.lid()?.speed_m_per_s;
        let body = position.len() - scene.body_count();
        let foot = position[body] - P::of([0.0, radius[body], 0.0]);
        Some(Self { scene, body: body as u32, foot, speed })
    }

    /// Its contacts with a grain.
    pub(crate) fn near(&self, seeker: &Seeker<P>) -> impl Iterator<Item = Near<P>> {
        let gap = (self.foot - seeker.place)[1] - seeker.radius;
        let normal = P::of([0.0, -1.0, 0.0]);
        let flat = seeker.meets(Side::Lid(self.body, -1), (normal, gap), || WallMotion::NONE);
        let bumps = Bumps::of_lid(self.scene, self.body, self.foot);
        flat.into_iter().chain(bumps.into_iter().flat_map(move |bumps| bumps.near(seeker)))
    }

    /// Its contacts with its guides.
    pub(crate) fn guides(&self) -> Vec<Near<P>> {
        let guide = |side, sign: f64| (side, P::of([sign, 0.0, 0.0]), -sign * self.speed);
        guides(self.body, [guide(Side::Left, 1.0), guide(Side::Right, -1.0)])
    }

    /// Draws it as a segment from one side to the other.
    pub(crate) fn drawn(self) -> Option<(Side, Vec<P>)> {
        let along = |x: f64| P::of([x, self.foot[1], 0.0]);
        self.scene.period().0.map(|width| (Side::Lid(self.body, -1), vec![along(0.0), along(width)]))
    }
}

/// A driven segment where contacts are sought.
#[derive(Clone, Debug)]
pub(crate) struct DrivenSegment<'s, P> {
    segment: &'s Segment,
    side: Side,
    /// Its index among the bodies.
    body: u32,
    /// Unit vector along which it moves (–).
    along: P,
    /// Its corners, or its two ends (m).
    corners: Vec<P>,
    /// Displacement since contacts were sought last, or since time began (m).
    came: P,
}

impl<'s, P: Place> DrivenSegment<'s, P> {
    /// The driven segments of a scene at the positions of their bodies, the last of `bodies`; `came` gives the displacement of each
    /// since contacts were detected last (m).
    pub(crate) fn all(scene: &'s Scene, bodies: &[P], came: impl Fn(u32) -> P) -> Vec<Self> {
        let first = bodies.len() - scene.driven().count();
        let placed = |((number, segment, driven), body): ((u32, &'s Segment, &Driven), u32)| {
            let along = driven.along::<P>();
            let moved = along * along.dot_product(bodies[body as usize] - segment.middle());
            let came = along * along.dot_product(came(body));
            let corners = segment.corners_at(moved);
            Self { segment, side: Side::Driven(body, number), body, along, corners, came }
        };
        scene.driven().zip(first as u32..).map(placed).collect()
    }

    /// Its contact with a grain.
    pub(crate) fn near(&self, seeker: &Seeker<P>) -> Option<Near<P>> {
        let Seeker { place, radius, reach, .. } = *seeker;
        let grain = Approach { place, radius, came: seeker.came - self.came, reach };
        let beside = self.segment.beside(&self.corners, grain)?;
        seeker.meets(self.side, (beside.towards(), beside.gap), || WallMotion::NONE)
    }

    /// Its contacts with its guides.
    pub(crate) fn guides(&self) -> Vec<Near<P>> {
        let across = if P::LEN > 2 {
            frame(&Vector3::from(self.along.space())).map(|across| P::of(across.into())).to_vec()
        } else {
            vec![P::of([-self.along[1], self.along[0], 0.0])]
        };
        let both = across.into_iter().flat_map(|across| [across, -across]);
        guides(self.body, (0..).zip(both).map(|(number, across)| (Side::Guide(number), across, 0.0)))
    }

    /// Draws it.
    pub(crate) fn drawn(&self) -> Vec<(Side, Vec<P>)> {
        outline(self.segment, self.side, &self.corners)
    }
}
