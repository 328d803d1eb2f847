//! A scene: gravity, the box and its motion, the contact law, the time step.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// What surrounds the grains, and how time is cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// The box. Without it grains fall for ever.
    #[serde(rename = "box")]
    pub walls: Option<Walls>,
}

fn midpoint() -> f64 {
    0.5
}

/// Which contacts enter a problem, and with what offset (§1, §2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// The paper's rule: a contact enters if its gap at q + h(1−θ)V⁻, advanced over h by the free velocity, is not
    /// positive; c has no gap term.
    PredictedGap,
    /// Inelastic quasi-shock: a contact enters if its gap could close within the time step; c has max(0, gap)/h.
    Iqs,
}

/// A floor at y = 0 and, with a width, two side walls with their feet at x = 0 and x = width.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walls {
    /// Distance between the feet of the side walls (m); without it there is a floor only.
    pub width_m: Option<f64>,
    /// Rate at which the side walls tilt about their feet, towards +x (rad/s).
    #[serde(default)]
    pub tilt_rate_rad_per_s: f64,
    /// When they begin to tilt (s).
    #[serde(default)]
    pub tilt_start_s: f64,
    /// Vibration of the whole box.
    pub vibration: Option<Vibration>,
}

/// The box moves by A sin(2π f (t − start)) from `start_s` on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vibration {
    /// A (m).
    pub amplitude_m: f64,
    /// f (Hz).
    pub frequency_hz: f64,
    /// Along x or y.
    pub direction: Direction,
    /// When it begins (s).
    #[serde(default)]
    pub start_s: f64,
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Horizontal.
    X,
    /// Vertical.
    Y,
}

/// A wall at one instant: a straight line that turns about its foot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    /// Unit normal into the box (–).
    pub(crate) normal: Vector2<f64>,
    /// A fixed point of the wall: its foot (m).
    pub(crate) foot: Vector2<f64>,
    /// Velocity of the foot (m/s).
    pub(crate) foot_velocity: Vector2<f64>,
    /// Velocity along the normal gained per metre above the foot along the wall (1/s).
    pub(crate) turning: f64,
}

impl Walls {
    /// Floor, left and right wall as they stand at `time` and move at `moving` (s).
    pub(crate) fn at(&self, time: f64, moving: f64) -> [Option<Wall>; 3] {
        let (shift, foot_velocity) =
            self.vibration.as_ref().map_or((Vector2::zeros(), Vector2::zeros()), |vibration| {
                (vibration.displacement(time), vibration.velocity(moving))
            });
        let angle = self.tilt_rate_rad_per_s * (time - self.tilt_start_s).max(0.0);
        let rate = if moving > self.tilt_start_s { self.tilt_rate_rad_per_s } else { 0.0 };
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let floor = Wall { normal: Vector2::new(0.0, 1.0), foot: shift, foot_velocity, turning: 0.0 };
        let left = Wall { normal: Vector2::new(cos, -sin), turning: rate, ..floor };
        let right = |width: f64| Wall {
            normal: Vector2::new(-cos, sin),
            foot: shift + Vector2::new(width, 0.0),
            turning: -rate,
            foot_velocity,
        };
        [Some(floor), self.width_m.map(|_| left), self.width_m.map(right)]
    }
}

impl Wall {
    /// Gap between the wall and a disc (m).
    pub(crate) fn gap(&self, position: Vector2<f64>, radius: f64) -> f64 {
        self.normal.dot(&(position - self.foot)) - radius
    }

    /// Normal velocity of the wall where it faces `position` (m/s).
    pub(crate) fn normal_velocity(&self, position: Vector2<f64>) -> f64 {
        let above_foot = (position - self.foot).perp(&self.normal).abs();
        self.normal.dot(&self.foot_velocity) + self.turning * above_foot
    }
}

impl Vibration {
    fn phase(&self, time: f64) -> Option<f64> {
        let since = time - self.start_s;
        (since >= 0.0).then_some(std::f64::consts::TAU * self.frequency_hz * since)
    }

    fn along(&self, value: f64) -> Vector2<f64> {
        match self.direction {
            Direction::X => Vector2::new(value, 0.0),
            Direction::Y => Vector2::new(0.0, value),
        }
    }

    fn displacement(&self, time: f64) -> Vector2<f64> {
        self.along(self.phase(time).map_or(0.0, |phase| self.amplitude_m * libm::sin(phase)))
    }

    fn velocity(&self, time: f64) -> Vector2<f64> {
        let pulsation = std::f64::consts::TAU * self.frequency_hz;
        self.along(self.phase(time).map_or(0.0, |phase| self.amplitude_m * pulsation * libm::cos(phase)))
    }
}

impl Scene {
    /// What is outside the model's meaning, as key, value and what would be accepted.
    pub(crate) fn check(&self) -> Result<(), String> {
        let wrong = |key: &str, value: f64, expected: &str| {
            Err(format!("`scene.{key}` is {value}: it must be {expected}"))
        };
        if !(self.time_step_s > 0.0 && self.time_step_s.is_finite()) {
            return wrong("time_step_s", self.time_step_s, "positive and finite");
        }
        if !(0.0..=1.0).contains(&self.theta) {
            return wrong("theta", self.theta, "between 0 and 1");
        }
        if !self.gravity_m_per_s2.is_finite() {
            return wrong("gravity_m_per_s2", self.gravity_m_per_s2, "finite");
        }
        let Some(walls) = &self.walls else { return Ok(()) };
        if let Some(width) = walls.width_m.filter(|width| !(*width > 0.0 && width.is_finite())) {
            return wrong("box.width_m", width, "positive and finite");
        }
        let finite = [
            ("box.tilt_rate_rad_per_s", walls.tilt_rate_rad_per_s),
            ("box.tilt_start_s", walls.tilt_start_s),
        ];
        let vibration = walls.vibration.iter().flat_map(|vibration| {
            [
                ("box.vibration.amplitude_m", vibration.amplitude_m),
                ("box.vibration.frequency_hz", vibration.frequency_hz),
                ("box.vibration.start_s", vibration.start_s),
            ]
        });
        match finite.into_iter().chain(vibration).find(|(_, value)| !value.is_finite()) {
            Some((key, value)) => wrong(key, value, "finite"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_move_as_their_positions_say() {
        let walls = Walls {
            width_m: Some(3.0),
            tilt_rate_rad_per_s: 0.2,
            tilt_start_s: 0.5,
            vibration: Some(Vibration {
                amplitude_m: 0.1,
                frequency_hz: 2.0,
                direction: Direction::Y,
                start_s: 0.0,
            }),
        };
        let disc = Vector2::new(1.0, 1.5);
        let (time, half) = (1.3, 1e-5);
        let before = walls.at(time - half, time);
        let after = walls.at(time + half, time);
        let now = walls.at(time, time);
        for side in 0..3 {
            let [before, now, after] = [before, now, after].map(|walls| walls[side].unwrap());
            let difference = (after.gap(disc, 0.1) - before.gap(disc, 0.1)) / (2.0 * half);
            // A disc at rest sees its gap change by minus the wall's normal velocity; central differences are
            // exact to half² times the third derivative, about 2e3 (m/s³) here.
            assert!((difference + now.normal_velocity(disc)).abs() < 1e-6, "{side}: {difference}");
        }
    }
}
