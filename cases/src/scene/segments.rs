//! Segments: straight walls with ends that stand, move, turn or are driven, and may be taken away. Among discs they are lines, without
//! length discs; among spheres rods, convex polygons and hollow cylinders.

use crate::file::values::{check, not_negative};
use crate::scene::coordinates::{Point, Row};
use crate::scene::driven::Driven;
use crate::scene::motion::{self, Direction, Vibration};
use crate::scene::polygon::{centroid, check_polygon};
use crate::scene::turning::Turning;
use contact::{Place, is_not_negative, is_positive, shown};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A straight wall with ends, all sides of which grains may touch. A hopper has some that lean and one, its gate, that is taken
/// away; an obstacle has a radius and no length. Among spheres it is a rod from end to end, a convex polygon, or a hollow cylinder without
/// lids. Segments that meet and move alike are one surface to a grain. Its velocities add up; contacts see their mean from one detection to the next, over [t + (1−θ)h, t + (2−θ)h], so that a
/// grain stays on it exactly. With θ = ½ that is the velocity at the end of the time step, where it is linear.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// One end, as [x, y], among spheres [x, y, z], when time begins (m); that of the axis of a rod or a hollow cylinder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_m: Option<Point>,
    /// The other end (m); without it the segment has no length.
    pub to_m: Option<Point>,
    /// Corners of a convex polygon among spheres, one after the other, each as [x, y, z] (m), in place of the ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub corners_m: Vec<Point>,
    /// True of a hollow cylinder among spheres, which are inside or outside.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hollow: bool,
    /// Half its thickness (m): its ends and edges are round. Radius of a hollow cylinder, whose wall has no thickness.
    #[serde(default)]
    pub radius_m: f64,
    /// Velocity (m/s).
    #[serde(default = "at_rest")]
    pub velocity_m_per_s: Point,
    /// More velocity, as rows of [time (s), `v_x`, `v_y` (m/s)], among spheres also `v_z`: linear from row to row, constant before the first and after the last.
    #[serde(default)]
    pub motion: Vec<Row>,
    /// Vibration.
    pub vibration: Option<Vibration>,
    /// Turn about an axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turning: Option<Turning>,
    /// A force that drives it, in place of a given motion; it is one of the last grains of contact problems and frames.
    pub driven: Option<Driven>,
    /// Coulomb's μ on it (–), where it is another than at walls.
    pub friction: Option<f64>,
    /// Time at which it is taken away (s); without it, never.
    pub removed_at_s: Option<f64>,
}

fn at_rest() -> Point {
    Point::ORIGIN
}

/// Shape of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// The line between two ends.
    Line,
    /// A convex polygon.
    Polygon,
    /// The surface of a cylinder between two ends of its axis.
    Hollow,
}

impl Segment {
    /// Its shape.
    pub(crate) fn shape(&self) -> Shape {
        match (self.corners_m.is_empty(), self.hollow) {
            (false, _) => Shape::Polygon,
            (true, true) => Shape::Hollow,
            (true, false) => Shape::Line,
        }
    }

    /// Half its thickness (m); the wall of a hollow cylinder has none.
    pub(crate) fn half_thickness(&self) -> f64 {
        if self.hollow { 0.0 } else { self.radius_m }
    }

    /// Returns its corners, or its two ends, at a `time` (s), if it is there and moves as given.
    pub(crate) fn corners<P: Place>(&self, time: f64) -> Option<Vec<P>> {
        let is_there = self.driven.is_none() && self.removed_at_s.is_none_or(|removed| time < removed);
        is_there.then(|| self.posed(time))
    }

    /// Returns its corners, or its two ends, where its motion leads them by a `time` (s).
    pub(crate) fn posed<P: Place>(&self, time: f64) -> Vec<P> {
        let mut corners = self.corners_at(self.moved(time));
        if let Some(turning) = &self.turning {
            let (moved, angle) = (self.moved(time), turning.angle(time));
            for corner in &mut corners {
                *corner = turning.turned(*corner, moved, angle);
            }
        }
        corners
    }

    /// Returns where a point that is fixed to it `since` a time is at another (s).
    pub(crate) fn carried<P: Place>(&self, point: P, since: f64, time: f64) -> P {
        let moved = self.moved::<P>(time);
        let there = point + (moved - self.moved(since));
        let turned =
            |turning: &Turning| turning.turned(there, moved, turning.angle(time) - turning.angle(since));
        self.turning.as_ref().map_or(there, turned)
    }

    /// Returns its corners, or its two ends, where it has so far moved (m) without turning.
    pub(crate) fn corners_at<P: Place>(&self, moved: P) -> Vec<P> {
        let ends = self.from_m.into_iter().flat_map(|from| [from, self.to_m.unwrap_or(from)]);
        ends.chain(self.corners_m.iter().copied()).map(|corner| P::of(corner.list()) + moved).collect()
    }

    /// Returns its prescribed displacement at a `time` (s), in metres.
    pub(crate) fn moved<P: Place>(&self, time: f64) -> P {
        let moved = self.constant::<P>() * time;
        if !self.is_unsteady() {
            return moved;
        }
        let by_table = P::of(motion::displacement(&self.motion, time));
        let shaken = self.vibration.as_ref().map_or(P::ZERO, |vibration| vibration.displacement(time));
        moved + by_table + shaken
    }

    /// Its velocity over the `span` after a `time` (s), on average and apart from its turn (m/s).
    pub(crate) fn velocity<P: Place>(&self, time: f64, span: f64) -> P {
        // To the bit where it is constant.
        if self.is_unsteady() {
            (self.moved::<P>(time + span) - self.moved(time)) / span
        } else {
            self.constant()
        }
    }

    fn constant<P: Place>(&self) -> P {
        P::of(self.velocity_m_per_s.list())
    }

    fn is_unsteady(&self) -> bool {
        !self.motion.is_empty() || self.vibration.is_some()
    }

    /// Returns an upper bound of its prescribed speed (m/s).
    pub(crate) fn speed(&self) -> f64 {
        let [x, y, z] = self.velocity_m_per_s.list();
        let turned =
            self.turning.as_ref().map_or(0.0, |turning| turning.greatest_rate() * self.farthest(turning));
        x.hypot(y).hypot(z)
            + motion::greatest_speed(&self.motion)
            + self.vibration.as_ref().map_or(0.0, Vibration::greatest_speed)
            + turned
    }

    /// Returns an upper bound of the distance of its surface from the axis of its turn (m).
    fn farthest(&self, turning: &Turning) -> f64 {
        let corners = self.corners_at(Vector3::zeros());
        corners.iter().map(|corner| turning.arm((*corner).into())).fold(0.0, f64::max) + self.radius_m
    }

    /// Checks that both move as given, in one way.
    pub(crate) fn moves_as(&self, other: &Self) -> bool {
        let given = self.driven.is_none() && other.driven.is_none();
        let alike = self.velocity_m_per_s == other.velocity_m_per_s && self.motion == other.motion;
        given && alike && self.vibration == other.vibration && self.turning == other.turning
    }

    /// Its middle when time begins (m).
    pub(crate) fn middle<P: Place>(&self) -> P {
        let corners = self.corners_at::<P>(P::ZERO);
        match corners[..] {
            [from, to] => (from + to) * 0.5,
            _ => centroid(&corners),
        }
    }

    /// Refuses values without meaning, of the segment that stands at `place` in the file.
    pub(crate) fn check(&self, place: &str, time_step_s: f64) -> Result<(), String> {
        self.check_shape(place)?;
        let is_point = self.corners_m.is_empty() && (self.to_m.is_none() || self.to_m == self.from_m);
        let is_thick = is_not_negative(self.radius_m) && !(self.radius_m == 0.0 && is_point);
        let expected = "positive for a segment without length, and not negative for any";
        let radius = [("radius_m", self.radius_m, is_thick, expected)];
        let removed = self.removed_at_s.map(|removed| not_negative("removed_at_s", removed));
        check(place, radius.into_iter().chain(removed))?;
        if let Some(vibration) = &self.vibration {
            vibration.check_resolved(place, time_step_s)?;
        }
        motion::check(self.motion.iter().map(Row::given), &format!("{place}.motion"))?;
        if let Some(turning) = &self.turning {
            turning.check(place)?;
        }
        let Some(driven) = &self.driven else { return Ok(()) };
        driven.check(place)?;
        let given = [
            ("velocity_m_per_s", self.velocity_m_per_s.list() != [0.0; 3]),
            ("motion", !self.motion.is_empty()),
            ("vibration", self.vibration.is_some()),
            ("turning", self.turning.is_some()),
            ("removed_at_s", self.removed_at_s.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((key, _)) => Err(format!(
                "`{place}.{key}` is given beside `driven`: a force moves the segment, so it must be left out"
            )),
            None => Ok(()),
        }
    }

    /// Refuses ends beside corners, a polygon that is not convex, and a hollow cylinder without length.
    fn check_shape(&self, place: &str) -> Result<(), String> {
        match (self.from_m, self.corners_m.is_empty()) {
            (None, true) => {
                return Err(format!("missing key `{place}.from_m`, or `{place}.corners_m` of a polygon"));
            }
            (Some(_), false) => {
                return Err(format!(
                    "`{place}.corners_m` is given beside `from_m`: a polygon has corners alone"
                ));
            }
            (None, false) if self.to_m.is_some() || self.hollow => {
                let key = if self.hollow { "hollow" } else { "to_m" };
                return Err(format!(
                    "`{place}.{key}` is given beside `corners_m`: it must be left out of a polygon"
                ));
            }
            (None, false) => return check_polygon(&self.corners_at(Vector3::zeros()), place),
            (Some(_), true) => {}
        }
        if self.hollow && (self.to_m.is_none() || self.to_m == self.from_m) {
            return Err(format!("`{place}.hollow` is true: it needs `to_m`, the other end of its axis"));
        }
        if self.hollow && !is_positive(self.radius_m) {
            let radius = shown(self.radius_m);
            return Err(format!("`{place}.radius_m` is {radius}: of a hollow cylinder it must be positive"));
        }
        Ok(())
    }

    /// Refuses what is only for spheres, or only for discs, and numbers of other dimensions.
    pub(crate) fn check_dimensions(&self, place: &str, in_space: bool) -> Result<(), String> {
        let of_spheres = [("corners_m", !self.corners_m.is_empty()), ("hollow", self.hollow)];
        if let Some((key, _)) = of_spheres.into_iter().find(|(_, given)| *given && !in_space) {
            return Err(format!("`{place}.{key}` is for spheres, so it must be left out"));
        }
        if !in_space && self.vibration.as_ref().is_some_and(|vibration| vibration.direction == Direction::Z) {
            return Err(format!("`{place}.vibration.direction` is z: it must be x or y"));
        }
        let named = |key: &str| format!("{place}.{key}");
        let points =
            [("from_m", self.from_m), ("to_m", self.to_m), ("velocity_m_per_s", Some(self.velocity_m_per_s))];
        let driven = self.driven.map(|driven| ("driven.direction", Some(driven.direction)));
        for (key, point) in points.into_iter().chain(driven) {
            point.map_or(Ok(()), |point| point.check(&named(key), in_space))?;
        }
        for (k, corner) in self.corners_m.iter().enumerate() {
            corner.check(&format!("{place}.corners_m[{k}]"), in_space)?;
        }
        for (k, row) in self.motion.iter().enumerate() {
            row.check(&format!("{place}.motion[{k}]"), in_space)?;
        }
        self.turning.as_ref().map_or(Ok(()), |turning| turning.check_dimensions(place, in_space))
    }
}
