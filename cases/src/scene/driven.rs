//! Segments that a given force drives: bodies with a mass that their guides let move along one direction alone.
//!
//! They are the last grains of the contact problem, as a lid is. Contacts with them are those of grains with a body. Two frictionless
//! guides each, across their direction, hold them on it: they are contacts of the problem as well. A moment of inertia beyond all
//! others keeps them from turning.

use crate::detect::{DetectedContact, Grain, Side};
use crate::scene::Scene;
use crate::scene::joints::Disc;
use crate::scene::segments::Segment;
use contact::{Place, is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What drives a segment: it begins at rest, and gravity acts on it too. Other segments and walls do not stop it.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Driven {
    /// Its mass (kg).
    pub mass_kg: f64,
    /// Force along its direction, its weight apart (N).
    pub force_n: f64,
    /// The direction along which alone it moves, as [x, y] of any length but 0 (–).
    pub direction: [f64; 2],
}

impl Driven {
    /// Unit vector along which it moves (–).
    pub(crate) fn along<P: Place>(&self) -> P {
        let [x, y] = self.direction;
        let length = x.hypot(y);
        P::of([x / length, y / length, 0.0])
    }

    /// What has no meaning, as key, value and what would be accepted.
    pub(crate) fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        let length = self.direction[0].hypot(self.direction[1]);
        let values = [
            ("driven.mass_kg", self.mass_kg, is_positive(self.mass_kg), "positive and finite"),
            ("driven.force_n", self.force_n, self.force_n.is_finite(), "finite"),
            ("driven.direction", length, is_positive(length), "of finite length, and not of none"),
        ];
        let wrong = values.into_iter().find(|(_, _, valid, _)| !valid);
        wrong.map(|(key, value, _, expected)| (key, value, expected))
    }
}

impl Scene {
    /// Its segments that a force drives, with their numbers, in the order of their bodies.
    pub(crate) fn driven(&self) -> impl Iterator<Item = (u32, &Segment, &Driven)> + Clone {
        let all = (0_u32..).zip(&self.segments);
        all.filter_map(|(number, segment)| Some((number, segment, segment.driven.as_ref()?)))
    }

    /// What the forces on its last bodies give them, in their order: of a lid, or of driven segments (N).
    pub(crate) fn forces<P: Place>(&self) -> Vec<(f64, P)> {
        let of_lid = self.lid().map(|lid| (lid.mass_kg, P::of([0.0, -lid.force_n, 0.0])));
        let of_segments =
            self.driven().map(|(_, _, driven)| (driven.mass_kg, driven.along::<P>() * driven.force_n));
        of_lid.into_iter().chain(of_segments).collect()
    }

    /// How many bodies follow the grains.
    pub(crate) fn body_count(&self) -> usize {
        usize::from(self.lid().is_some()) + self.driven().count()
    }

    /// Its driven segments as more grains.
    pub(crate) fn driven_bodies<P: Place>(&self, grains: &[Grain<P>]) -> Vec<Grain<P>> {
        let radius = grains.iter().map(|grain| grain.radius).fold(0.0, f64::max);
        let body = |(_, segment, driven): (u32, &Segment, &Driven)| Grain {
            // Speeds and overlaps are judged by that of the largest disc.
            radius,
            mass: driven.mass_kg,
            position: middle(segment),
        };
        self.driven().map(body).collect()
    }

    /// Where driven segments are, by the places of their `bodies`, the last of them all, and how far these came since contacts were
    /// sought last (m).
    pub(crate) fn driven_at<P: Place>(&self, bodies: &[P], came: impl Fn(u32) -> P) -> Vec<Placed<'_, P>> {
        let first = bodies.len() - self.driven().count();
        let placed = |((number, segment, driven), body): ((u32, _, &Driven), u32)| {
            let along = driven.along::<P>();
            let moved = along * along.dot_product(bodies[body as usize] - middle(segment));
            let came = along * along.dot_product(came(body));
            Placed { segment, side: Side::Driven(body, number), body, along, moved, came }
        };
        self.driven().zip(first as u32..).map(placed).collect()
    }
}

/// The middle of a segment when time begins (m).
fn middle<P: Place>(segment: &Segment) -> P {
    let [from, to] = segment.ends_at::<P>(P::ZERO);
    (from + to) * 0.5
}

/// A driven segment where contacts are sought.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'s, P> {
    segment: &'s Segment,
    side: Side,
    /// Its index among the bodies.
    body: u32,
    /// Unit vector along which it moves (–).
    along: P,
    /// How far it has (m).
    moved: P,
    /// Part of this since contacts were sought last, or since time began (m).
    came: P,
}

impl<P: Place> Placed<'_, P> {
    /// Its contact with one grain, if that is within `reach` (m).
    pub(crate) fn near(&self, grain: u32, disc: Disc<P>, reach: f64) -> Option<DetectedContact<P>> {
        let came = disc.came - self.came;
        let ends = self.segment.ends_at(self.moved);
        let beside = self.segment.beside(ends, came, (disc.place, disc.radius), reach)?;
        let (normal, gap) = (beside.towards(), beside.gap);
        Some(DetectedContact { candidate: grain, antagonist: self.side, normal, gap })
    }

    /// Its contacts with its guides.
    pub(crate) fn guides(&self) -> [DetectedContact<P>; 2] {
        let across = P::of([-self.along[1], self.along[0], 0.0]);
        [(0, across), (1, -across)].map(|(guide, normal)| DetectedContact {
            candidate: self.body,
            antagonist: Side::Guide(guide),
            normal,
            gap: 0.0,
        })
    }

    /// As it is drawn.
    pub(crate) fn drawn(&self) -> Vec<(Side, Vec<P>)> {
        self.segment.outline(self.side, self.segment.ends_at(self.moved))
    }
}

/// Says which key of a driven segment does not go with its force.
pub(crate) fn check(segment: &Segment, number: usize) -> Result<(), String> {
    let Some(driven) = &segment.driven else { return Ok(()) };
    if let Some((key, value, expected)) = driven.fault() {
        return Err(format!("`scene.segments[{number}].{key}` is {}: it must be {expected}", shown(value)));
    }
    let given = [
        ("velocity_m_per_s", segment.velocity_m_per_s != [0.0; 2]),
        ("motion", !segment.motion.is_empty()),
        ("vibration", segment.vibration.is_some()),
        ("removed_at_s", segment.removed_at_s.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(format!(
            "`scene.segments[{number}].{key}` is given beside `driven`: a force moves the segment, so it must be left out"
        )),
        None => Ok(()),
    }
}
