//! A scene: gravity, the box and its motion, the contact law, the time step.

pub(crate) mod beside;
pub(crate) mod coordinates;
pub(crate) mod driven;
pub(crate) mod drum;
pub(crate) mod friction;
pub(crate) mod lid;
pub(crate) mod motion;
pub(crate) mod polygon;
pub(crate) mod segments;
pub(crate) mod turning;
pub(crate) mod walls;

use crate::detect::Grain;
use crate::detect::periodic::Period;
use crate::file::values::{check, positive};
use crate::scene::driven::Driven;
use crate::scene::drum::Drum;
use crate::scene::friction::Material;
use crate::scene::lid::Lid;
use crate::scene::motion::Direction;
use crate::scene::segments::Segment;
use crate::scene::walls::{MovingWall, Walls};
use contact::{Place, is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Surroundings of the grains, contact law and time step.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Contact law: the contacts that enter a problem, and their offsets.
    pub law: Law,
    /// Newton's e: the part of its approach with which a contact parts (–), of the law `newton`.
    pub restitution: Option<f64>,
    /// Rate at which contacts recover from an overlap (1/s), at most 1/h, of the law `iqs`: they part at this rate times the overlap.
    /// Without it overlaps stay, and what the tolerance of the solves leaves of approach adds up.
    pub recovery_per_s: Option<f64>,
    /// h (s).
    pub time_step_s: f64,
    /// θ of the θ-scheme (–).
    #[serde(default = "midpoint")]
    pub theta: f64,
    /// Downward acceleration (m/s²).
    pub gravity_m_per_s2: f64,
    /// Angle by which gravity leans towards +x (rad): the floor is then a slope that falls that way.
    #[serde(default)]
    pub slope_rad: f64,
    /// Coulomb's μ between grains, and at walls that have none of their own (–). Where all are 0 or left out there is no friction, and
    /// grains have no spin.
    pub friction: Option<f64>,
    /// Static over dynamic friction (–), at least 1: the factor of every μ at a contact that did not slide in the time step before, or is
    /// new. A contact slides where its impulse lies on its cone. Each time step is then Coulomb's law with a μ of each contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub static_friction_ratio: Option<f64>,
    /// Materials, told apart by the radii of their grains, with the μ of each pair.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    /// True where grains translate and never spin, as blocks too low to tip.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub spinless: bool,
    /// Velocity at which every grain begins (m/s).
    #[serde(default)]
    pub thrown_at_m_per_s: [f64; 2],
    /// Speed at which the highest grain, the first of several, begins downwards; the others are at rest (m/s).
    #[serde(default)]
    pub impact_speed_m_per_s: f64,
    /// Number of copies of each contact in a problem: with more than one, impulses are not unique.
    #[serde(default = "once")]
    pub contact_copies: u32,
    /// The box. Without a box, drum or segments, grains fall freely.
    #[serde(rename = "box")]
    pub walls: Option<Walls>,
    /// A drum around the origin, in place of a box.
    pub drum: Option<Drum>,
    /// Straight walls with ends, and fixed discs; among spheres polygons, rods and hollow cylinders.
    #[serde(default)]
    pub segments: Vec<Segment>,
}

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

/// Contact law: the contacts that enter a problem, and their offsets (§1, §2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// The paper's rule: a contact enters if its gap at q + h(1−θ)V⁻, advanced over h by the free velocity, is not
    /// positive; c has no gap term.
    PredictedGap,
    /// Inelastic quasi-shock: a contact enters if its gap is no more than what the two fastest bodies of the scene could
    /// close within the time step; c has max(0, gap)/h, and where there is an overlap `scene.recovery_per_s` times the gap.
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
    /// Period of the scene along x, if it has one.
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

    /// Returns the acceleration of gravity with its sign reversed, to be subtracted from velocities (m/s²).
    pub(crate) fn gravity<P: Place>(&self) -> P {
        let g = self.gravity_m_per_s2;
        // Nothing leans where there is no slope, to the sign of a zero.
        if self.slope_rad == 0.0 {
            P::of([0.0, g, 0.0])
        } else {
            P::of([-g * libm::sin(self.slope_rad), g * libm::cos(self.slope_rad), 0.0])
        }
    }

    /// Its segments that a force drives, with their numbers, in the order of their bodies.
    pub(crate) fn driven(&self) -> impl Iterator<Item = (u32, &Segment, &Driven)> + Clone {
        let all = (0_u32..).zip(&self.segments);
        all.filter_map(|(number, segment)| Some((number, segment, segment.driven.as_ref()?)))
    }

    /// Returns the mass (kg) of each of the last bodies and the force on it (N), in their order: a lid, or driven segments.
    pub(crate) fn forces<P: Place>(&self) -> Vec<(f64, P)> {
        let of_lid = self.lid().map(|lid| (lid.mass_kg, P::of([0.0, -lid.force_n, 0.0])));
        let of_segments =
            self.driven().map(|(_, _, driven)| (driven.mass_kg, driven.along::<P>() * driven.force_n));
        of_lid.into_iter().chain(of_segments).collect()
    }

    /// Returns the number of bodies after the grains.
    pub(crate) fn body_count(&self) -> usize {
        usize::from(self.lid().is_some()) + self.driven().count()
    }

    /// The bodies after the grains as more of them, which speeds and overlaps judge as the largest, each with its velocity (m/s).
    pub(crate) fn bodies<P: Place>(&self, grains: &[Grain<P>]) -> Vec<(Grain<P>, P)> {
        let radius = grains.iter().map(|grain| grain.radius).fold(0.0, f64::max);
        let of_lid = self.lid().map(|lid| {
            let body = lid.body(grains, radius, self.bump_radius().unwrap_or(0.0));
            (body, P::of([lid.speed_m_per_s, 0.0, 0.0]))
        });
        let of_segments = self.driven().map(|(_, segment, driven)| {
            (Grain { radius, mass: driven.mass_kg, position: segment.middle(), motion: [0.0; 6] }, P::ZERO)
        });
        of_lid.into_iter().chain(of_segments).collect()
    }

    /// Its walls from a `time` (s) on, for a time step.
    pub(crate) fn walls_from<P: Place>(&self, time: f64) -> [Option<MovingWall<P>>; 5] {
        self.walls.as_ref().map_or([None; 5], |walls| walls.over(time, self.time_step_s))
    }

    /// Refuses what is only for spheres, or only for discs.
    pub(crate) fn check_dimensions(&self, in_space: bool) -> Result<(), String> {
        let walls = self.walls.as_ref();
        let depth = walls.and_then(|walls| walls.depth_m);
        let closing = walls.map_or(0.0, |walls| walls.depth_closing_speed_m_per_s);
        let vibration = walls.and_then(|walls| walls.vibration.as_ref());
        let no_depth = |key: &str, value: f64| {
            format!("`scene.box.{key}` is {}: discs have no depth, so it must be left out", shown(value))
        };
        let discs_alone = |key: &str| format!("`scene.{key}` is for discs, so it must be left out");
        Err(match depth {
            Some(depth) if !in_space => no_depth("depth_m", depth),
            None if !in_space && closing != 0.0 => no_depth("depth_closing_speed_m_per_s", closing),
            _ if !in_space && vibration.is_some_and(|vibration| vibration.direction == Direction::Z) => {
                "`scene.box.vibration.direction` is z: it must be x or y, since discs have no depth"
                    .to_owned()
            }
            None if in_space && closing != 0.0 => format!(
                "`scene.box.depth_closing_speed_m_per_s` is {}: it needs `scene.box.depth_m`",
                shown(closing)
            ),
            _ if in_space && self.lid().is_some() => discs_alone("box.lid"),
            _ => {
                let numbered = self.segments.iter().enumerate();
                let mut named =
                    numbered.map(|(number, segment)| (format!("scene.segments[{number}]"), segment));
                return named.try_for_each(|(place, segment)| segment.check_dimensions(&place, in_space));
            }
        })
    }

    /// Returns unusual values, for grains of at least this radius (m): key, value and why.
    pub(crate) fn warnings(&self, least_radius: f64) -> Vec<String> {
        let (g, h) = (self.gravity_m_per_s2, self.time_step_s);
        let mut warnings: Vec<String> = self.friction_warnings().collect();
        if self.slope_rad.abs() > std::f64::consts::FRAC_PI_2 {
            let degrees = shown(self.slope_rad.to_degrees().round());
            let slope = shown(self.slope_rad);
            warnings.push(format!(
                "`scene.slope_rad` is {slope}, {degrees} degrees: grains fall off a slope above π/2"
            ));
        }
        if g < 0.0 {
            warnings.push(format!(
                "`scene.gravity_m_per_s2` is {}: a positive number points downwards, and this one lifts the grains",
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

    /// Refuses values outside the range of the model, with key, value and what would be accepted.
    pub(crate) fn check(&self) -> Result<(), String> {
        let (walls, drum) = (self.walls.as_ref(), self.drum.as_ref());
        let copies = self.contact_copies;
        let mut values = vec![
            positive("time_step_s", self.time_step_s),
            ("theta", self.theta, (0.0..=1.0).contains(&self.theta), "between 0 and 1"),
            ("contact_copies", copies.into(), copies > 0, "at least 1"),
        ];
        let at_least_one = |ratio: f64| ratio >= 1.0 && ratio.is_finite();
        values.extend(
            self.static_friction_ratio
                .map(|ratio| ("static_friction_ratio", ratio, at_least_one(ratio), "at least 1 and finite")),
        );
        values.extend(self.restitution.map(|e| {
            let valid = (0.0..=1.0).contains(&e) && self.law == Law::Newton;
            ("restitution", e, valid, "between 0 and 1, with the law `newton`")
        }));
        values.extend(self.recovery_per_s.map(|rate| {
            let valid = rate >= 0.0 && rate * self.time_step_s <= 1.0 && self.law == Law::Iqs;
            ("recovery_per_s", rate, valid, "not negative and at most 1/h, with the law `iqs`")
        }));
        values.extend(drum.map(|Drum { radius_m, .. }| {
            let expected = "positive and finite, and `scene.box` left out";
            ("drum.radius_m", *radius_m, is_positive(*radius_m) && walls.is_none(), expected)
        }));
        check("scene", values)?;
        self.check_frictions()?;
        if self.law == Law::Newton && self.restitution.is_none() {
            return Err(
                "`scene.restitution` is missing: the law `newton` needs it, between 0 and 1".to_owned()
            );
        }
        for (number, segment) in self.segments.iter().enumerate() {
            segment.check(&format!("scene.segments[{number}]"), self.time_step_s)?;
        }
        if self.period().0.is_some() && !self.segments.is_empty() {
            return Err("`scene.segments` is for boxes without `periodic` sides".to_owned());
        }
        walls.map_or(Ok(()), |walls| walls.check(self.time_step_s))
    }
}
