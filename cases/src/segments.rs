//! Segments: straight walls with two ends that stand or move, and may be taken away; without length they are fixed discs.

use crate::bodies::Near;
use crate::detect::{DetectedContact, Side};
use crate::walls::WallMotion;
use contact::{Place, is_not_negative, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A straight wall with two ends, both sides of which discs may touch. A hopper has two that lean and one, its gate, that is taken
/// away; an obstacle has a radius and no length. Its friction is that of walls. Where segments meet, a disc on the corner touches both:
/// the two impulses are not unique.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// One end, as [x, y], when time begins (m).
    pub from_m: [f64; 2],
    /// The other end (m); without it the segment has no length.
    pub to_m: Option<[f64; 2]>,
    /// Half its thickness (m): its ends are round.
    #[serde(default)]
    pub radius_m: f64,
    /// Velocity (m/s).
    #[serde(default)]
    pub velocity_m_per_s: [f64; 2],
    /// When it is taken away (s); without it, never.
    pub removed_at_s: Option<f64>,
}

impl Segment {
    /// Its ends at a `time` (s), if it is there.
    pub(crate) fn ends<P: Place>(&self, time: f64) -> Option<[P; 2]> {
        let is_there = self.removed_at_s.is_none_or(|removed| time < removed);
        let moved = self.velocity::<P>() * time;
        let end = |[x, y]: [f64; 2]| P::of([x, y, 0.0]) + moved;
        is_there.then(|| [end(self.from_m), end(self.to_m.unwrap_or(self.from_m))])
    }

    fn velocity<P: Place>(&self) -> P {
        let [x, y] = self.velocity_m_per_s;
        P::of([x, y, 0.0])
    }

    /// How fast it is (m/s).
    pub(crate) fn speed(&self) -> f64 {
        self.velocity_m_per_s[0].hypot(self.velocity_m_per_s[1])
    }

    /// The contact of a grain with the segment of this `number` at a `time` (s), if it is within `reach` (m): with the nearest of its
    /// points.
    pub(crate) fn near<P: Place>(
        &self,
        (number, time): (u32, f64),
        grain: u32,
        (position, radius): (P, f64),
        reach: f64,
    ) -> Option<Near<P>> {
        let [from, to] = self.ends::<P>(time)?;
        let along = to - from;
        let squared = along.dot_product(along);
        let share = if squared > 0.0 { (position - from).dot_product(along) / squared } else { 0.0 };
        let between = position - (from + along * share.clamp(0.0, 1.0));
        let touching = radius + self.radius_m;
        // Most are too far: no square root for them.
        if between.dot_product(between) > (touching + reach) * (touching + reach) {
            return None;
        }
        let distance = between.length();
        let gap = distance - touching;
        // A centre on the segment has no side; any will push it off.
        let normal = if distance > 0.0 { between / distance } else { P::of([0.0, 1.0, 0.0]) };
        let contact = DetectedContact { candidate: grain, antagonist: Side::Segment(number), normal, gap };
        let sliding = self.velocity::<P>();
        (gap <= reach).then(|| (contact, WallMotion { opening: -normal.dot_product(sliding), sliding }))
    }

    /// What has no meaning, if anything has.
    pub(crate) fn check(&self, number: usize) -> Result<(), String> {
        let wrong = |key: &str, value: f64, expected: &str| {
            Err(format!("`scene.segments[{number}].{key}` is {}: it must be {expected}", shown(value)))
        };
        let pairs = [
            ("from_m", self.from_m),
            ("to_m", self.to_m.unwrap_or(self.from_m)),
            ("velocity_m_per_s", self.velocity_m_per_s),
        ];
        for (key, pair) in pairs {
            if let Some(value) = pair.into_iter().find(|value| !value.is_finite()) {
                return wrong(key, value, "finite");
            }
        }
        let is_point = self.to_m.is_none_or(|to| to == self.from_m);
        if !is_not_negative(self.radius_m) || self.radius_m == 0.0 && is_point {
            let expected = "positive for a segment without length, and not negative for any";
            return wrong("radius_m", self.radius_m, expected);
        }
        match self.removed_at_s.filter(|time| !is_not_negative(*time)) {
            Some(time) => wrong("removed_at_s", time, "finite and not negative"),
            None => Ok(()),
        }
    }
}
