//! Segments: straight walls with two ends that stand, move or are driven, and may be taken away; without length they are discs.

use crate::file::values::{check, not_negative};
use crate::scene::driven::Driven;
use crate::scene::motion::{self, Direction, Row, Vibration};
use contact::{Place, is_not_negative};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A straight wall with two ends, both sides of which discs may touch. A hopper has two that lean and one, its gate, that is taken
/// away; an obstacle has a radius and no length. Segments that meet and move alike are one line to a disc. Its velocities add up; contacts see their mean from one detection to the next, over [t + (1−θ)h, t + (2−θ)h], so that a
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
    /// Time at which it is taken away (s); without it, never.
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

    /// Returns its prescribed displacement at a `time` (s), in metres.
    pub(crate) fn moved<P: Place>(&self, time: f64) -> P {
        let moved = self.constant::<P>() * time;
        if !self.is_unsteady() {
            return moved;
        }
        let [x, y] = motion::displacement(&self.motion, time);
        let shaken = self.vibration.as_ref().map_or(P::ZERO, |vibration| vibration.displacement(time));
        moved + P::of([x, y, 0.0]) + shaken
    }

    /// Its velocity over the `span` after a `time` (s), on average (m/s).
    pub(crate) fn velocity<P: Place>(&self, time: f64, span: f64) -> P {
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

    /// Returns an upper bound of its prescribed speed (m/s).
    pub(crate) fn speed(&self) -> f64 {
        let constant = self.velocity_m_per_s[0].hypot(self.velocity_m_per_s[1]);
        constant
            + motion::greatest_speed(&self.motion)
            + self.vibration.as_ref().map_or(0.0, Vibration::greatest_speed)
    }

    /// Checks that both move as given, in one way.
    pub(crate) fn moves_as(&self, other: &Self) -> bool {
        let given = self.driven.is_none() && other.driven.is_none();
        let alike = self.velocity_m_per_s == other.velocity_m_per_s && self.motion == other.motion;
        given && alike && self.vibration == other.vibration
    }

    /// Locates a disc beside the segment between these ends, if their surfaces are within `reach` (m). Seen from the segment the
    /// disc `came` this way since contacts were detected last (m).
    pub(crate) fn beside<P: Place>(
        &self,
        [from, to]: [P; 2],
        came: P,
        (position, radius): (P, f64),
        reach: f64,
    ) -> Option<Beside<P>> {
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
        let end = if share <= 0.0 { Some(0) } else { (share >= 1.0).then_some(1) };
        let line = (squared > 0.0).then(|| {
            let length = squared.sqrt();
            let upwards = P::of([-along[1], along[0], 0.0]) / length;
            let height = upwards.dot_product(position - from);
            let before = height - upwards.dot_product(came);
            let room = PASSED * touching / length;
            let passed = is_within(room, share - came.dot_product(along) / squared, share, before, height);
            let above = if passed && before != 0.0 { before > 0.0 } else { (height >= 0.0) != passed };
            (if above { upwards } else { -upwards }, passed)
        });
        let (normal, passed) = line.unwrap_or((P::ZERO, false));
        let gap = if passed { -distance } else { distance } - touching;
        (gap <= reach).then_some(Beside {
            end: end.filter(|_| !passed),
            between,
            distance,
            normal,
            touching,
            gap,
        })
    }

    /// Its middle when time begins (m).
    pub(crate) fn middle<P: Place>(&self) -> P {
        let [from, to] = self.ends_at::<P>(P::ZERO);
        (from + to) * 0.5
    }

    /// Refuses values without meaning, of the segment that stands at `place` in the file.
    pub(crate) fn check(&self, place: &str, time_step_s: f64) -> Result<(), String> {
        let is_point = self.to_m.is_none_or(|to| to == self.from_m);
        let is_thick = is_not_negative(self.radius_m) && !(self.radius_m == 0.0 && is_point);
        let expected = "positive for a segment without length, and not negative for any";
        let radius = [("radius_m", self.radius_m, is_thick, expected)];
        let removed = self.removed_at_s.map(|removed| not_negative("removed_at_s", removed));
        let friction = self.friction.map(|friction| not_negative("friction", friction));
        check(place, radius.into_iter().chain(removed).chain(friction))?;
        if let Some(vibration) = &self.vibration {
            if matches!(vibration.direction, Direction::Z) {
                return Err(format!("`{place}.vibration.direction` is z: it must be x or y"));
            }
            vibration.check_resolved(place, time_step_s)?;
        }
        motion::check(&self.motion, &format!("{place}.motion"))?;
        let Some(driven) = &self.driven else { return Ok(()) };
        driven.check(place)?;
        let given = [
            ("velocity_m_per_s", self.velocity_m_per_s != [0.0; 2]),
            ("motion", !self.motion.is_empty()),
            ("vibration", self.vibration.is_some()),
            ("removed_at_s", self.removed_at_s.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((key, _)) => Err(format!(
                "`{place}.{key}` is given beside `driven`: a force moves the segment, so it must be left out"
            )),
            None => Ok(()),
        }
    }
}

/// Share of the touching distance within which a centre that crosses the line beyond an end has passed the segment (–): a disc that goes
/// round an end crosses it at the whole of that. An end without thickness would never be overlapped by more than a radius.
const PASSED: f64 = 0.5;

/// Checks whether a centre that moved from a height `before` above a line to `after` crossed it between 0 and 1 of its length, or within a
/// `room` of its ends; it was at the share `from` of it and is at `to`.
fn is_within(room: f64, from: f64, to: f64, before: f64, after: f64) -> bool {
    let crossed = before * after <= 0.0 && before != after;
    crossed && (-room..=1.0 + room).contains(&(from + (to - from) * before / (before - after)))
}

/// A disc beside a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beside<P> {
    /// The end that is the nearest point, if it is one; none where the disc has passed through.
    pub(crate) end: Option<usize>,
    /// Vector from the nearest point to the centre (m).
    pub(crate) between: P,
    /// Its length (m).
    distance: f64,
    /// Unit normal of the segment towards the side from which the disc came (–); 0 of a segment without length.
    pub(crate) normal: P,
    /// Distance of centre and line where the surfaces touch (m).
    pub(crate) touching: f64,
    /// Distance of the surfaces; where the centre has passed through, less than minus the radius (m).
    pub(crate) gap: f64,
}

impl<P: Place> Beside<P> {
    /// Unit normal of the contact (–).
    pub(crate) fn towards(&self) -> P {
        match self.end {
            None => self.normal,
            Some(_) if self.distance > 0.0 => self.between / self.distance,
            // A centre on an end has no side; any will push it off.
            Some(_) => P::of([0.0, 1.0, 0.0]),
        }
    }
}
