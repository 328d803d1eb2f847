//! The box: a floor and walls that tilt, close, slide or vibrate, and how each moves where a grain is.

use crate::file::values::{check, positive};
use crate::scene::lid::Lid;
use crate::scene::motion::Vibration;
use contact::{Place, is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A floor at y = 0; with a width, two side walls with their feet at x = 0 and x = width; and, where grains are spheres, with a
/// depth a wall behind, at z = 0, and one before, at z = depth.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walls {
    /// Distance between the feet of the side walls (m); without it there is a floor only.
    pub width_m: Option<f64>,
    /// Distance between the walls behind and before spheres (m); without it there are none.
    pub depth_m: Option<f64>,
    /// Periodic sides in place of side walls: what leaves the box at one side comes in at the other.
    #[serde(default)]
    pub periodic: bool,
    /// A lid on the discs of a periodic box; it is the last grain of contact problems and frames.
    pub lid: Option<Lid>,
    /// Rate at which the side walls tilt about their feet, towards +x (rad/s).
    #[serde(default)]
    pub tilt_rate_rad_per_s: f64,
    /// Time at which they begin to tilt (s).
    #[serde(default)]
    pub tilt_start_s: f64,
    /// Speed at which each side wall moves towards the other (m/s).
    #[serde(default)]
    pub closing_speed_m_per_s: f64,
    /// Speed at which each of the walls behind and before spheres moves towards the other (m/s).
    #[serde(default)]
    pub depth_closing_speed_m_per_s: f64,
    /// Speed at which the floor slides along itself, as a belt, towards +x (m/s). Only friction feels it.
    #[serde(default)]
    pub belt_speed_m_per_s: f64,
    /// Coulomb's μ at the walls (–), where it is another than between grains.
    pub friction: Option<f64>,
    /// Radius of bumps that make the floor, and a lid, rough: discs fixed side by side, with their centres on it (m); in space
    /// spheres on a square lattice. Deposited grains begin above them.
    pub bump_radius_m: Option<f64>,
    /// Vibration of the whole box.
    pub vibration: Option<Vibration>,
}

/// A wall at one instant: a straight line, or a plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall<P> {
    /// Unit normal into the box (–).
    pub(crate) normal: P,
    /// A point of the wall: its foot (m).
    pub(crate) foot: P,
}

impl Walls {
    /// The walls from `time` to `time` + `span` (s), in the order of [`WALLS`](crate::detect::WALLS).
    pub(crate) fn over<P: Place>(&self, time: f64, span: f64) -> [Option<MovingWall<P>>; 5] {
        let (now, next) = (self.at(time), self.at(time + span));
        let still = P::of([0.0; 3]);
        let belt = [P::of([self.belt_speed_m_per_s, 0.0, 0.0]), still, still, still, still];
        std::array::from_fn(|side| {
            Some(MovingWall { now: now[side]?, next: next[side]?, span, belt: belt[side] })
        })
    }

    /// The walls as they stand at `time` (s), in the order of [`WALLS`](crate::detect::WALLS).
    pub(crate) fn at<P: Place>(&self, time: f64) -> [Option<Wall<P>>; 5] {
        let foot = self.vibration.as_ref().map_or(P::ZERO, |vibration| vibration.displacement(time));
        let angle = self.tilt_rate_rad_per_s * (time - self.tilt_start_s).max(0.0);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let closed = self.closing_speed_m_per_s * time;
        let wall = |normal: [f64; 3], at: [f64; 3]| Wall { normal: P::of(normal), foot: foot + P::of(at) };
        let floor = Wall { normal: P::of([0.0, 1.0, 0.0]), foot };
        let left = |_| wall([cos, -sin, 0.0], [closed, 0.0, 0.0]);
        let right = |width| wall([-cos, sin, 0.0], [width - closed, 0.0, 0.0]);
        let nearer = self.depth_closing_speed_m_per_s * time;
        let back = |_| wall([0.0, 0.0, 1.0], [0.0, 0.0, nearer]);
        let front = |depth| wall([0.0, 0.0, -1.0], [0.0, 0.0, depth - nearer]);
        let depth = self.depth_m.filter(|_| P::LEN > 2);
        let width = self.width_m.filter(|_| !self.periodic);
        [Some(floor), width.map(left), width.map(right), depth.map(back), depth.map(front)]
    }
}

impl<P: Place> Wall<P> {
    /// Gap between the wall and a grain (m).
    pub(crate) fn gap(&self, position: P, radius: f64) -> f64 {
        self.normal.dot_product(position - self.foot) - radius
    }
}

/// A wall as it stands at the beginning and at the end of a span of time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingWall<P> {
    pub(crate) now: Wall<P>,
    next: Wall<P>,
    span: f64,
    /// Velocity of a surface that slides (m/s).
    belt: P,
}

/// Motion of a wall at the place of a grain, on average over a span of time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallMotion<P> {
    /// Rate at which it opens the gap of a grain at rest (m/s).
    pub opening: f64,
    /// Velocity of its surface (m/s), of which the part along it counts.
    pub sliding: P,
    /// Gap of a curved wall where the grain's free motion along it leads, its distance kept (m).
    pub ahead: Option<f64>,
}

impl<P: Place> WallMotion<P> {
    /// None.
    pub(crate) const NONE: Self = Self { opening: 0.0, sliding: P::ZERO, ahead: None };

    /// Returns the motion of a body with this velocity (m/s), where it has this normal (–).
    pub(crate) fn sliding(velocity: P, normal: P) -> Self {
        Self { opening: -normal.dot_product(velocity), sliding: velocity, ahead: None }
    }
}

impl<P: Place> MovingWall<P> {
    /// Rate at which the wall opens the gap of a grain at rest, on average over the span (m/s).
    pub(crate) fn opening_rate(&self, position: P) -> f64 {
        (self.next.gap(position, 0.0) - self.now.gap(position, 0.0)) / self.span
    }

    /// Returns its motion: its surface moves as its foot, about which it turns, and as a belt.
    pub(crate) fn motion(&self, position: P) -> WallMotion<P> {
        let sliding = self.foot_rate() + self.belt;
        WallMotion { opening: self.opening_rate(position), sliding, ahead: None }
    }

    /// Velocity of the foot, on average over the span (m/s).
    pub(crate) fn foot_rate(&self) -> P {
        (self.next.foot - self.now.foot) / self.span
    }
}

impl Walls {
    /// Refuses values outside the range of the model, and those that contradict periodic sides or need them.
    pub(crate) fn check(&self, time_step_s: f64) -> Result<(), String> {
        let lengths = [("width_m", self.width_m), ("depth_m", self.depth_m)];
        let lengths = lengths.into_iter().filter_map(|(key, length)| Some(positive(key, length?)));
        let bumps = self.bump_radius_m.map(|bumps| {
            let valid = is_positive(bumps) && self.belt_speed_m_per_s == 0.0;
            ("bump_radius_m", bumps, valid, "positive and finite, on a floor that is no belt")
        });
        check("scene.box", lengths.chain(bumps))?;
        if let Some(vibration) = &self.vibration {
            vibration.check_resolved("scene.box", time_step_s)?;
        }
        if !self.periodic {
            return match self.lid {
                Some(_) => Err("`scene.box.lid` asks for `scene.box.periodic` = true".to_owned()),
                None => Ok(()),
            };
        }
        let Some(width) = self.width_m else {
            return Err("`scene.box.periodic` is true: it needs `scene.box.width_m`".to_owned());
        };
        let of_sides = [
            ("tilt_rate_rad_per_s", self.tilt_rate_rad_per_s),
            ("closing_speed_m_per_s", self.closing_speed_m_per_s),
        ];
        if let Some((key, value)) = of_sides.iter().find(|(_, value)| *value != 0.0) {
            return Err(format!(
                "`scene.box.{key}` is {}: periodic sides are no walls, so it must be 0",
                shown(*value)
            ));
        }
        if let Some(bumps) = self.bump_radius_m {
            let count = width / (2.0 * bumps);
            if (count - count.round()).abs() > 1e-9 * count {
                return Err(format!(
                    "`scene.box.bump_radius_m` is {}: the width of a periodic box, {}, must be a multiple of twice that",
                    shown(bumps),
                    shown(width)
                ));
            }
        }
        self.lid.map_or(Ok(()), |lid| lid.check())
    }
}

#[cfg(test)]
mod tests;
