//! Segments: straight walls with two ends that stand, move or are driven, and may be taken away; without length they are discs.

use crate::bodies::Near;
use crate::detect::{DetectedContact, Side};
use crate::drawn::circle;
use crate::driven::{self, Driven};
use crate::motion::{self, Row};
use crate::walls::{Direction, Vibration, WallMotion};
use contact::{Place, is_not_negative, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A straight wall with two ends, both sides of which discs may touch. A hopper has two that lean and one, its gate, that is taken
/// away; an obstacle has a radius and no length. Where segments meet, a disc on the corner touches both: the two impulses are not
/// unique. Its velocities add up; contacts see their mean from one detection to the next, over [t + (1−θ)h, t + (2−θ)h], so that a
/// disc stays on it exactly. With θ = ½ that is the velocity at the end of the time step, where it is linear.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
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
    /// More velocity, as rows of [time (s), `v_x`, `v_y` (m/s)]: linear from row to row, constant before the first and after the last.
    #[serde(default)]
    pub motion: Vec<Row>,
    /// Vibration.
    pub vibration: Option<Vibration>,
    /// A force that drives it, in place of a given motion; it is one of the last grains of contact problems and frames.
    pub driven: Option<Driven>,
    /// Coulomb's μ on it (–), where it is another than at walls.
    pub friction: Option<f64>,
    /// When it is taken away (s); without it, never.
    pub removed_at_s: Option<f64>,
}

impl Segment {
    /// Its ends at a `time` (s), if it is there and moves as given.
    pub(crate) fn ends<P: Place>(&self, time: f64) -> Option<[P; 2]> {
        let is_there = self.driven.is_none() && self.removed_at_s.is_none_or(|removed| time < removed);
        is_there.then(|| self.ends_at(self.moved(time)))
    }

    /// Its ends where it has so far moved (m).
    pub(crate) fn ends_at<P: Place>(&self, moved: P) -> [P; 2] {
        [self.from_m, self.to_m.unwrap_or(self.from_m)].map(|[x, y]| P::of([x, y, 0.0]) + moved)
    }

    /// How far it has moved at a `time` (s), as given (m).
    fn moved<P: Place>(&self, time: f64) -> P {
        let moved = self.constant::<P>() * time;
        if !self.is_unsteady() {
            return moved;
        }
        let [x, y] = motion::displacement(&self.motion, time);
        let shaken = self.vibration.as_ref().map_or(P::ZERO, |vibration| vibration.displacement(time));
        moved + P::of([x, y, 0.0]) + shaken
    }

    /// Its velocity over the `span` after a `time` (s), on average (m/s).
    fn velocity<P: Place>(&self, time: f64, span: f64) -> P {
        // To the bit where it is constant.
        if self.is_unsteady() {
            (self.moved::<P>(time + span) - self.moved(time)) / span
        } else {
            self.constant()
        }
    }

    fn constant<P: Place>(&self) -> P {
        let [x, y] = self.velocity_m_per_s;
        P::of([x, y, 0.0])
    }

    fn is_unsteady(&self) -> bool {
        !self.motion.is_empty() || self.vibration.is_some()
    }

    /// How fast it is at most, as given (m/s).
    pub(crate) fn speed(&self) -> f64 {
        let constant = self.velocity_m_per_s[0].hypot(self.velocity_m_per_s[1]);
        constant
            + motion::greatest_speed(&self.motion)
            + self.vibration.as_ref().map_or(0.0, Vibration::greatest_speed)
    }

    /// The contact of a grain with the segment of this `number` over the `span` after a `time` (s), if it is within `reach` (m).
    pub(crate) fn near<P: Place>(
        &self,
        (number, time, span): (u32, f64, f64),
        grain: u32,
        disc: (P, f64),
        reach: f64,
    ) -> Option<Near<P>> {
        let (normal, gap) = self.nearest(self.ends::<P>(time)?, disc, reach)?;
        let contact = DetectedContact { candidate: grain, antagonist: Side::Segment(number), normal, gap };
        let sliding = self.velocity::<P>(time, span);
        Some((contact, WallMotion { opening: -normal.dot_product(sliding), sliding }))
    }

    /// Normal (–) and gap (m) between a disc and the nearest point of the segment between these ends, if that is within `reach` (m).
    pub(crate) fn nearest<P: Place>(
        &self,
        [from, to]: [P; 2],
        (position, radius): (P, f64),
        reach: f64,
    ) -> Option<(P, f64)> {
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
        (gap <= reach).then_some((normal, gap))
    }

    /// As it is drawn between these ends (m): a line, or two with circles at their ends.
    pub(crate) fn outline<P: Place>(&self, side: Side, [from, to]: [P; 2]) -> Vec<(Side, Vec<P>)> {
        let (along, radius) = (to - from, self.radius_m);
        let length = along.length();
        let aside = P::of([-along[1], along[0], 0.0]) * if length > 0.0 { radius / length } else { 0.0 };
        let ends = if radius > 0.0 { vec![from, to] } else { Vec::new() };
        let round = ends.into_iter().flat_map(|end| circle(side, [end[0], end[1]], radius));
        let flat = if length == 0.0 {
            Vec::new()
        } else if radius > 0.0 {
            vec![(side, vec![from + aside, to + aside]), (side, vec![from - aside, to - aside])]
        } else {
            vec![(side, vec![from, to])]
        };
        flat.into_iter().chain(round).collect()
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
        let values = [("removed_at_s", self.removed_at_s), ("friction", self.friction)];
        for (key, value) in values {
            if let Some(value) = value.filter(|value| !is_not_negative(*value)) {
                return wrong(key, value, "finite and not negative");
            }
        }
        if let Some(vibration) = &self.vibration {
            if let Some((key, value)) = vibration.not_finite() {
                return wrong(&format!("vibration.{key}"), value, "finite");
            }
            if matches!(vibration.direction, Direction::Z) {
                return Err(format!(
                    "`scene.segments[{number}].vibration.direction` is z: it must be x or y"
                ));
            }
        }
        motion::check(&self.motion, &format!("scene.segments[{number}].motion"))?;
        driven::check(self, number)
    }
}
