//! A scene: gravity, the box and its motion, the contact law, the time step.

pub(crate) mod bodies;
pub(crate) mod drawn;
pub(crate) mod driven;
pub(crate) mod joints;
pub(crate) mod lid;
pub(crate) mod motion;
pub(crate) mod segments;
pub(crate) mod walls;

use crate::detect::periodic::Period;
use crate::scene::bodies::Drum;
use crate::scene::lid::Lid;
use crate::scene::segments::Segment;
use crate::scene::walls::{Direction, Vibration, Walls};
use contact::{Place, is_not_negative, is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What surrounds the grains, and how time is cut.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Which contacts enter a problem, and with what offset.
    pub law: Law,
    /// Newton's e: the part of its approach with which a contact parts (–), of the law `newton`.
    pub restitution: Option<f64>,
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

/// Coulomb's μ above which something else was meant (–).
const GREAT_FRICTION: f64 = 2.0;

/// The warning of a time step that `moves` a grain of this radius too far (m).
pub(crate) fn too_far(time_step_s: f64, moves: &str, radius: f64) -> String {
    let (h, radius) = (shown(time_step_s), shown(radius));
    format!(
        "`scene.time_step_s` is {h}: {moves}, farther than its radius, {radius} m, so contacts may be missed"
    )
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
    /// Newton's law of impact in Moreau's form: contacts enter as with `predicted-gap`, and c has e v⁻, so that
    /// 0 ≤ v⁺ + e v⁻ ⊥ r ≥ 0, which without friction never gives energy. It needs `scene.restitution`.
    Newton,
}

impl Law {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PredictedGap => "predicted-gap",
            Self::Iqs => "iqs",
            Self::Newton => "newton",
        }
    }
}

impl Scene {
    /// Whether grains feel friction.
    pub fn is_rough(&self) -> bool {
        self.friction.is_some()
            || self.walls.as_ref().is_some_and(|walls| walls.friction.is_some())
            || self.segments.iter().any(|segment| segment.friction.is_some())
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
        } else if walls.depth_closing_speed_m_per_s != 0.0 {
            Err(format!(
                "`scene.box.depth_closing_speed_m_per_s` is {}: discs have no depth, so it must be left out",
                shown(walls.depth_closing_speed_m_per_s)
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
        let closing = self.walls.as_ref().filter(|walls| walls.depth_m.is_none());
        if let Some(walls) = closing.filter(|walls| walls.depth_closing_speed_m_per_s != 0.0) {
            return Err(format!(
                "`scene.box.depth_closing_speed_m_per_s` is {}: it needs `scene.box.depth_m`",
                shown(walls.depth_closing_speed_m_per_s)
            ));
        }
        match self.lid() {
            Some(_) => Err("`scene.box.lid` is for discs, so it must be left out".to_owned()),
            None => Ok(()),
        }
    }

    /// Returns unusual values, for grains of at least this radius (m): key, value and why.
    pub(crate) fn warnings(&self, least_radius: f64) -> Vec<String> {
        let (g, h) = (self.gravity_m_per_s2, self.time_step_s);
        let of_walls = self.walls.as_ref().and_then(|walls| walls.friction);
        let of_segments = (0..)
            .zip(&self.segments)
            .map(|(number, segment)| (format!("segments[{number}].friction"), segment.friction));
        let frictions = [("friction", self.friction), ("box.friction", of_walls)];
        let frictions = frictions.into_iter().map(|(key, mu)| (key.to_owned(), mu)).chain(of_segments);
        let mut warnings: Vec<String> = frictions
            .filter_map(|(key, mu)| Some((key, mu.filter(|mu| *mu > GREAT_FRICTION)?)))
            .map(|(key, mu)| {
                format!("`scene.{key}` is {}: no material has a friction above {GREAT_FRICTION}", shown(mu))
            })
            .collect();
        if self.slope_rad.abs() > std::f64::consts::FRAC_PI_2 {
            let degrees = shown(self.slope_rad.to_degrees().round());
            let slope = shown(self.slope_rad);
            warnings.push(format!(
                "`scene.slope_rad` is {slope}, {degrees} degrees: grains fall off a slope above π/2"
            ));
        }
        if g < 0.0 {
            warnings.push(format!(
                "`scene.gravity_m_per_s2` is {}: it lifts grains, for it points downwards",
                shown(g)
            ));
        }
        let [x, y] = self.thrown_at_m_per_s;
        let fastest = x.hypot(y - self.impact_speed_m_per_s).max(x.hypot(y));
        let moved = h * (fastest + h * g.abs());
        if moved > least_radius {
            warnings.push(too_far(
                h,
                &format!("the first one moves a free grain by {} m", shown(moved)),
                least_radius,
            ));
        }
        warnings
    }

    fn check_segments(&self) -> Result<(), String> {
        for (number, segment) in self.segments.iter().enumerate() {
            segment.check(number, self.time_step_s)?;
        }
        if self.period().0.is_some() && !self.segments.is_empty() {
            return Err("`scene.segments` is for boxes without `periodic` sides".to_owned());
        }
        Ok(())
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
            finite("box.depth_closing_speed_m_per_s", walls.depth_closing_speed_m_per_s);
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
        values.extend(self.restitution.map(|e| {
            let valid = (0.0..=1.0).contains(&e) && self.law == Law::Newton;
            ("restitution", e, valid, "between 0 and 1, with the law `newton`")
        }));
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
        if let Some((key, value, _, expected)) = values.into_iter().find(|(_, _, valid, _)| !valid) {
            return Err(format!("`scene.{key}` is {}: it must be {expected}", shown(value)));
        }
        if self.law == Law::Newton && self.restitution.is_none() {
            return Err(
                "`scene.restitution` is missing: the law `newton` needs it, between 0 and 1".to_owned()
            );
        }
        self.check_segments()?;
        if let Some(vibration) = self.walls.as_ref().and_then(|walls| walls.vibration.as_ref()) {
            vibration.check_resolved("box", self.time_step_s)?;
        }
        self.walls.as_ref().map_or(Ok(()), Walls::check_periodic)
    }
}
