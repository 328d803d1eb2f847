//! A scene: gravity, the box and its motion, the contact law, the time step.

use crate::bodies::Drum;
use crate::lid::Lid;
use crate::periodic::Period;
use crate::segments::Segment;
use contact::{Place, is_not_negative, is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What surrounds the grains, and how time is cut.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Which contacts enter a problem, and with what offset.
    pub law: Law,
    /// h (s).
    pub time_step_s: f64,
    /// θ of the θ-scheme (–).
    #[serde(default = "midpoint")]
    pub theta: f64,
    /// Downward acceleration (m/s²).
    pub gravity_m_per_s2: f64,
    /// By how much gravity leans towards +x (rad): the floor is then a slope that falls that way.
    #[serde(default)]
    pub slope_rad: f64,
    /// Coulomb's μ between grains, and at walls that have none of their own (–). Without the key there is no friction, and grains
    /// have no spin.
    pub friction: Option<f64>,
    /// Velocity at which every grain begins (m/s).
    #[serde(default)]
    pub thrown_at_m_per_s: [f64; 2],
    /// Speed at which the highest grain, the first of several, begins downwards; the others are at rest (m/s).
    #[serde(default)]
    pub impact_speed_m_per_s: f64,
    /// How often each contact enters a problem: more than once, and impulses are not unique.
    #[serde(default = "once")]
    pub contact_copies: u32,
    /// The box. Without it, a drum or segments, grains fall for ever.
    #[serde(rename = "box")]
    pub walls: Option<Walls>,
    /// A drum around the origin, in place of a box.
    pub drum: Option<Drum>,
    /// Straight walls with two ends, and fixed discs.
    #[serde(default)]
    pub segments: Vec<Segment>,
}

fn midpoint() -> f64 {
    0.5
}

fn once() -> u32 {
    1
}

/// Which contacts enter a problem, and with what offset (§1, §2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// The paper's rule: a contact enters if its gap at q + h(1−θ)V⁻, advanced over h by the free velocity, is not
    /// positive; c has no gap term.
    PredictedGap,
    /// Inelastic quasi-shock: a contact enters if its gap is no more than what the two fastest bodies of the scene could
    /// close within the time step; c has max(0, gap)/h.
    Iqs,
}

/// A floor at y = 0; with a width, two side walls with their feet at x = 0 and x = width; and, where grains are spheres, with a
/// depth a wall behind, at z = 0, and one before, at z = depth.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walls {
    /// Distance between the feet of the side walls (m); without it there is a floor only.
    pub width_m: Option<f64>,
    /// Distance between the walls behind and before spheres (m); without it there are none.
    pub depth_m: Option<f64>,
    /// In place of side walls: what leaves the box at one side comes in at the other. For discs.
    #[serde(default)]
    pub periodic: bool,
    /// A lid on the grains of a periodic box; it is the last grain of contact problems and frames.
    pub lid: Option<Lid>,
    /// Rate at which the side walls tilt about their feet, towards +x (rad/s).
    #[serde(default)]
    pub tilt_rate_rad_per_s: f64,
    /// When they begin to tilt (s).
    #[serde(default)]
    pub tilt_start_s: f64,
    /// Speed at which each side wall moves towards the other (m/s).
    #[serde(default)]
    pub closing_speed_m_per_s: f64,
    /// Speed at which the floor slides along itself, as a belt, towards +x (m/s). Only friction feels it.
    #[serde(default)]
    pub belt_speed_m_per_s: f64,
    /// Coulomb's μ at the walls (–), where it is another than between grains.
    pub friction: Option<f64>,
    /// Radius of bumps that make the floor, and a lid, rough: discs fixed side by side, with their centres on it (m). Deposited
    /// grains begin above them.
    pub bump_radius_m: Option<f64>,
    /// Vibration of the whole box.
    pub vibration: Option<Vibration>,
}

/// The box moves by A (sin(2π f (t − start) + φ) − sin φ) from `start_s` on. It begins at its full speed with φ = 0, at
/// rest with φ = −π/2. Its greatest acceleration is Γ = A (2π f)²/g times that of gravity.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vibration {
    /// A (m).
    pub amplitude_m: f64,
    /// f (Hz).
    pub frequency_hz: f64,
    /// Along x, y or, for spheres, z.
    pub direction: Direction,
    /// φ (rad).
    #[serde(default)]
    pub phase_rad: f64,
    /// When it begins (s).
    #[serde(default)]
    pub start_s: f64,
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Horizontal.
    X,
    /// Vertical.
    Y,
    /// Horizontal, towards who looks.
    Z,
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
        let back = |_| wall([0.0, 0.0, 1.0], [0.0; 3]);
        let front = |depth| wall([0.0, 0.0, -1.0], [0.0, 0.0, depth]);
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

/// How a wall moves where a grain is, on average over a span of time.
#[derive(Clone, Copy, Debug)]
pub struct WallMotion<P> {
    /// Rate at which it opens the gap of a grain at rest (m/s).
    pub opening: f64,
    /// Velocity of its surface (m/s), of which the part along it counts.
    pub sliding: P,
}

impl<P: Place> WallMotion<P> {
    /// None.
    pub(crate) const NONE: Self = Self { opening: 0.0, sliding: P::ZERO };
}

impl<P: Place> MovingWall<P> {
    /// Rate at which the wall opens the gap of a grain at rest, on average over the span (m/s).
    pub(crate) fn opening_rate(&self, position: P) -> f64 {
        (self.next.gap(position, 0.0) - self.now.gap(position, 0.0)) / self.span
    }

    /// How it moves: its surface as its foot, about which it turns, and as a belt.
    pub(crate) fn motion(&self, position: P) -> WallMotion<P> {
        WallMotion { opening: self.opening_rate(position), sliding: self.foot_rate() + self.belt }
    }

    /// Velocity of the foot, on average over the span (m/s).
    pub(crate) fn foot_rate(&self) -> P {
        (self.next.foot - self.now.foot) / self.span
    }
}

impl Vibration {
    fn displacement<P: Place>(&self, time: f64) -> P {
        let turned = std::f64::consts::TAU * self.frequency_hz * (time - self.start_s).max(0.0);
        let value = self.amplitude_m * (libm::sin(turned + self.phase_rad) - libm::sin(self.phase_rad));
        match self.direction {
            Direction::X => P::of([value, 0.0, 0.0]),
            Direction::Y => P::of([0.0, value, 0.0]),
            Direction::Z => P::of([0.0, 0.0, value]),
        }
    }
}

impl Scene {
    /// Whether grains feel friction.
    pub fn is_rough(&self) -> bool {
        self.friction.is_some() || self.walls.as_ref().is_some_and(|walls| walls.friction.is_some())
    }

    /// After which width it repeats itself.
    pub(crate) fn period(&self) -> Period {
        Period(self.walls.as_ref().filter(|walls| walls.periodic).and_then(|walls| walls.width_m))
    }

    /// Radius of the bumps of its floor and its lid (m).
    pub(crate) fn bump_radius(&self) -> Option<f64> {
        self.walls.as_ref().and_then(|walls| walls.bump_radius_m)
    }

    /// Its lid.
    pub(crate) fn lid(&self) -> Option<&Lid> {
        self.walls.as_ref().and_then(|walls| walls.lid.as_ref())
    }

    /// Speed of its fastest segment (m/s).
    pub(crate) fn fastest_segment(&self) -> f64 {
        self.segments.iter().map(Segment::speed).fold(0.0, f64::max)
    }

    /// What gravity takes from velocities (m/s²).
    pub(crate) fn gravity<P: Place>(&self) -> P {
        let g = self.gravity_m_per_s2;
        // Nothing leans where there is no slope, to the sign of a zero.
        if self.slope_rad == 0.0 {
            P::of([0.0, g, 0.0])
        } else {
            P::of([-g * libm::sin(self.slope_rad), g * libm::cos(self.slope_rad), 0.0])
        }
    }

    /// What has no meaning for discs, which lie in the plane of x and y.
    pub(crate) fn check_in_plane(&self) -> Result<(), String> {
        let Some(walls) = &self.walls else { return Ok(()) };
        let along_z = |vibration: &Vibration| matches!(vibration.direction, Direction::Z);
        if let Some(depth) = walls.depth_m {
            Err(format!(
                "`scene.box.depth_m` is {}: discs have no depth, so it must be left out",
                shown(depth)
            ))
        } else if walls.vibration.as_ref().is_some_and(along_z) {
            Err("`scene.box.vibration.direction` is z: it must be x or y, since discs have no depth"
                .to_owned())
        } else {
            Ok(())
        }
    }

    /// What has no meaning for spheres.
    pub(crate) fn check_in_space(&self) -> Result<(), String> {
        if !self.segments.is_empty() {
            return Err("`scene.segments` is for discs, so it must be left out".to_owned());
        }
        match self.period() {
            Period(None) => Ok(()),
            _ => Err("`scene.box.periodic` is true: periodic sides are for discs, so it must be left out"
                .to_owned()),
        }
    }

    fn check_segments(&self) -> Result<(), String> {
        for (number, segment) in self.segments.iter().enumerate() {
            segment.check(number)?;
        }
        if self.period().0.is_some() && !self.segments.is_empty() {
            return Err("`scene.segments` is for boxes without `periodic` sides".to_owned());
        }
        self.walls.as_ref().map_or(Ok(()), Walls::check_periodic)
    }

    /// What is outside the model's meaning, as key, value and what would be accepted.
    pub(crate) fn check(&self) -> Result<(), String> {
        let mut values = vec![
            ("time_step_s", self.time_step_s, is_positive(self.time_step_s), "positive and finite"),
            ("theta", self.theta, (0.0..=1.0).contains(&self.theta), "between 0 and 1"),
            ("contact_copies", f64::from(self.contact_copies), self.contact_copies > 0, "at least 1"),
        ];
        let mut finite = |key, value: f64| values.push((key, value, value.is_finite(), "finite"));
        finite("gravity_m_per_s2", self.gravity_m_per_s2);
        finite("impact_speed_m_per_s", self.impact_speed_m_per_s);
        finite("slope_rad", self.slope_rad);
        finite("thrown_at_m_per_s", self.thrown_at_m_per_s[0]);
        finite("thrown_at_m_per_s", self.thrown_at_m_per_s[1]);
        if let Some(walls) = &self.walls {
            finite("box.tilt_rate_rad_per_s", walls.tilt_rate_rad_per_s);
            finite("box.tilt_start_s", walls.tilt_start_s);
            finite("box.closing_speed_m_per_s", walls.closing_speed_m_per_s);
            finite("box.belt_speed_m_per_s", walls.belt_speed_m_per_s);
            if let Some(vibration) = &walls.vibration {
                finite("box.vibration.amplitude_m", vibration.amplitude_m);
                finite("box.vibration.frequency_hz", vibration.frequency_hz);
                finite("box.vibration.phase_rad", vibration.phase_rad);
                finite("box.vibration.start_s", vibration.start_s);
            }
            for (key, length) in [("box.width_m", walls.width_m), ("box.depth_m", walls.depth_m)] {
                values.extend(length.map(|length| (key, length, is_positive(length), "positive and finite")));
            }
        }
        if let Some(drum) = &self.drum {
            let (radius, spin) = (drum.radius_m, drum.spin_rad_per_s);
            let expected = "positive and finite, and `scene.box` left out";
            values.push(("drum.radius_m", radius, is_positive(radius) && self.walls.is_none(), expected));
            values.push(("drum.spin_rad_per_s", spin, spin.is_finite(), "finite"));
        }
        if let Some(walls) = &self.walls
            && let Some(bumps) = walls.bump_radius_m
        {
            let (expected, is_still) =
                ("positive and finite, on a floor that is no belt", walls.belt_speed_m_per_s == 0.0);
            values.push(("box.bump_radius_m", bumps, is_positive(bumps) && is_still, expected));
        }
        let of_walls = self.walls.as_ref().and_then(|walls| walls.friction);
        for (key, friction) in [("friction", self.friction), ("box.friction", of_walls)] {
            values.extend(friction.map(|mu| (key, mu, is_not_negative(mu), "finite and not negative")));
        }
        match values.into_iter().find(|(_, _, valid, _)| !valid) {
            Some((key, value, _, expected)) => {
                Err(format!("`scene.{key}` is {}: it must be {expected}", shown(value)))
            }
            None => self.check_segments(),
        }
    }
}

#[cfg(test)]
mod tests;
