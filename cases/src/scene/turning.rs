//! Turn of a segment about an axis.

use crate::file::values::check;
use crate::scene::coordinates::Point;
use crate::scene::motion;
use contact::{Place, is_positive};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Turn about an axis, which moves with the other motion of the segment: a paddle, a mill, a drum. Contacts see where it turns to by the next
/// detection of contacts, so that what it carries is neither left behind nor pushed into.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turning {
    /// A point of the axis when time begins, as [x, y] or [x, y, z] (m).
    pub about_m: Point,
    /// Direction of the axis among spheres, as [x, y, z] of any length but 0 (–); among discs it is z, towards the viewer.
    pub axis: Option<[f64; 3]>,
    /// Rate (rad/s): anticlockwise where the axis points to the viewer.
    #[serde(default)]
    pub rate_rad_per_s: f64,
    /// More rate, as rows of [time (s), rate (rad/s)]: linear from row to row, constant before the first and after the last.
    #[serde(default)]
    pub motion: Vec<[f64; 2]>,
}

impl Turning {
    /// Returns the angle through which it has turned at a `time` (rad).
    pub(crate) fn angle(&self, time: f64) -> f64 {
        let row = |k: usize| (self.motion[k][0], [self.motion[k][1]]);
        let [more] = motion::displacement_of(self.motion.len(), row, time);
        self.rate_rad_per_s * time + more
    }

    /// Returns an upper bound of the rate (rad/s).
    pub(crate) fn greatest_rate(&self) -> f64 {
        self.rate_rad_per_s.abs() + self.motion.iter().map(|[_, rate]| rate.abs()).fold(0.0, f64::max)
    }

    /// Returns a point of the segment, where it is without the turn, turned by an angle (rad) about the axis there.
    pub(crate) fn turned<P: Place>(&self, point: P, moved: P, angle: f64) -> P {
        let axis = Vector3::from(self.axis.unwrap_or([0.0, 0.0, 1.0])).normalize();
        let about = P::of(self.about_m.list()) + moved;
        let arm = Vector3::from((point - about).space());
        // Rodrigues: a cos φ + (k × a) sin φ + k (k · a)(1 − cos φ).
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let turned = arm * cosine + axis.cross(&arm) * sine + axis * (axis.dot(&arm) * (1.0 - cosine));
        about + P::of(turned.into())
    }

    /// Returns the distance of a point from the axis when time begins (m).
    pub(crate) fn arm(&self, point: [f64; 3]) -> f64 {
        let axis = Vector3::from(self.axis.unwrap_or([0.0, 0.0, 1.0])).normalize();
        (Vector3::from(point) - Vector3::from(self.about_m.list())).cross(&axis).length()
    }

    /// Refuses values without meaning, of the segment that stands at `place` in the file.
    pub(crate) fn check(&self, place: &str) -> Result<(), String> {
        if let Some(axis) = self.axis {
            let length = Vector3::from(axis).length();
            let axis = ("axis", length, is_positive(length), "of finite length, and not of none");
            check(&format!("{place}.turning"), [axis])?;
        }
        motion::check(self.motion.iter().map(|row| &row[..]), &format!("{place}.turning.motion"))
    }

    /// Refuses an axis of discs, and none of spheres.
    pub(crate) fn check_dimensions(&self, place: &str, in_space: bool) -> Result<(), String> {
        self.about_m.check(&format!("{place}.turning.about_m"), in_space)?;
        match (self.axis, in_space) {
            (Some(_), false) => {
                Err(format!("`{place}.turning.axis` is given: discs turn about z, so it must be left out"))
            }
            (None, true) => {
                Err(format!("`{place}.turning.axis` is missing: spheres need the direction of the axis"))
            }
            _ => Ok(()),
        }
    }
}
