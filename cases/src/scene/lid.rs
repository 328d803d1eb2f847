//! A lid on the grains of a periodic box: a body that a given force presses down, and that its guides move along x.
//!
//! It is the last grain of the contact problem. Contacts with it are those of grains with a body, on which its bumps act too. Two
//! frictionless guides, at its left and at its right, let it move along y alone and hold it at its speed along x: they are contacts of
//! the problem as well. A moment of inertia beyond all others keeps it from turning.

use crate::detect::{DetectedContact, Grain, Side};
use crate::scene::Scene;
use crate::scene::bodies::Bumps;
use crate::scene::walls::WallMotion;
use contact::{Place, is_not_negative, is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A lid. Without bumps it is flat; it has those of the floor.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lid {
    /// Its mass (kg).
    pub mass_kg: f64,
    /// Force that presses it down, its weight apart (N).
    pub force_n: f64,
    /// Speed at which its guides move it towards +x (m/s).
    #[serde(default)]
    pub speed_m_per_s: f64,
}

impl Lid {
    /// Itself as one more grain, on top of the `grains`, which its bumps of this radius just touch at most (m).
    pub(crate) fn body<P: Place>(&self, grains: &[Grain<P>], bumps: f64) -> Grain<P> {
        let radius = grains.iter().map(|grain| grain.radius).fold(0.0, f64::max);
        let tops = grains.iter().map(|grain| grain.position[1] + grain.radius);
        let surface = tops.fold(f64::NEG_INFINITY, f64::max) + bumps;
        Grain { radius, mass: self.mass_kg, position: P::of([0.0, surface + radius, 0.0]) }
    }

    /// What has no meaning.
    pub(crate) fn check(&self) -> Result<(), String> {
        let Self { mass_kg, force_n, speed_m_per_s } = *self;
        let values = [
            ("mass_kg", mass_kg, is_positive(mass_kg), "positive and finite"),
            ("force_n", force_n, is_not_negative(force_n), "finite and not negative"),
            ("speed_m_per_s", speed_m_per_s, speed_m_per_s.is_finite(), "finite"),
        ];
        match values.into_iter().find(|(_, _, valid, _)| !valid) {
            Some((key, value, _, expected)) => {
                Err(format!("`scene.box.lid.{key}` is {}: it must be {expected}", shown(value)))
            }
            None => Ok(()),
        }
    }
}

/// The lid of a scene where contacts are sought.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'s, P> {
    pub(crate) scene: &'s Scene,
    /// Its index among the bodies.
    pub(crate) body: u32,
    /// Where its surface begins (m).
    pub(crate) foot: P,
}

impl<P: Place> Placed<'_, P> {
    /// Its contacts with one grain that are within `reach` (m).
    pub(crate) fn near(
        self,
        grain: u32,
        (position, radius): (P, f64),
        reach: f64,
    ) -> impl Iterator<Item = DetectedContact<P>> {
        let Self { scene, body, foot } = self;
        let flat = DetectedContact {
            candidate: grain,
            antagonist: Side::Lid(body, -1),
            normal: P::of([0.0, -1.0, 0.0]),
            gap: (foot - position)[1] - radius,
        };
        let bumps = scene.bump_radius().map(|radius| Bumps {
            radius,
            foot,
            moving: P::ZERO,
            period: scene.period(),
            side: |body, [k, _]| Side::Lid(body, k),
        });
        let bumps =
            bumps.into_iter().flat_map(move |bumps| bumps.near(body, grain, (position, radius), reach));
        (flat.gap <= reach).then_some(flat).into_iter().chain(bumps.map(|(contact, _)| contact))
    }

    /// As a segment from one side to the other.
    pub(crate) fn drawn(self) -> Option<(Side, Vec<P>)> {
        let along = |x: f64| P::of([x, self.foot[1], 0.0]);
        self.scene.period().0.map(|width| (Side::Lid(self.body, -1), vec![along(0.0), along(width)]))
    }

    /// Its contacts with its guides, which move at `speed` (m/s).
    pub(crate) fn guides(self, speed: f64) -> [(DetectedContact<P>, WallMotion<P>); 2] {
        [(Side::Left, 1.0), (Side::Right, -1.0)].map(|(antagonist, sign)| {
            let normal = P::of([sign, 0.0, 0.0]);
            let contact = DetectedContact { candidate: self.body, antagonist, normal, gap: 0.0 };
            (contact, WallMotion { opening: -sign * speed, ..WallMotion::NONE })
        })
    }
}
