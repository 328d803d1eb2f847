//! Love-Weber stress of a time step, and number of contacts per grain.
//!
//! σ = 1/A Σ f ⊗ l over all contacts, f the force on the candidate and l the branch to its centre: from the centre of the other grain,
//! or of a bump, or from the foot of its perpendicular on a wall. Pressure is positive. A is the width of a periodic box times the
//! height of its lid over its floor: under a lid at rest `σ_yy` is then its force over its width, exactly, where grains have no weight.
//! In a box that a driven segment closes A is the rectangle around the grains: with four walls and no weight, force over length too.
//!
//! F. Radjai, V. Richefeu, "Contact dynamics as a nonsmooth discrete element method", Mech. Mater. 41 (2009).

use crate::detect::Side;
use crate::detect::extent::room;
use crate::problem::marched::{Marched, to_candidate};
use crate::problem::time_step::TimeStep;
use crate::scene::Scene;
use contact::{Touch, number};
use serde::{Deserialize, Serialize};

/// Stress (N/m) and coordination of a time step, or their means over several, with their columns in results. Pressure is positive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Stress {
    /// `σ_xx` (N/m); 0 without a lid and without a driven segment, as below.
    #[serde(rename = "stress_xx_n_per_m", with = "number")]
    pub xx: f64,
    /// `σ_xy`: what acts along x across y (N/m).
    #[serde(rename = "stress_xy_n_per_m", with = "number")]
    pub xy: f64,
    /// `σ_yy` (N/m).
    #[serde(rename = "stress_yy_n_per_m", with = "number")]
    pub yy: f64,
    /// Contacts that push, per grain: one between two grains counts for both (–).
    #[serde(with = "number")]
    pub coordination: f64,
}

impl Stress {
    /// The mean of so many time steps with this one and one more with another.
    #[must_use]
    pub fn and_then(self, time_steps: u64, next: Self) -> Self {
        let mean = |before: f64, next: f64| before + (next - before) / (time_steps + 1) as f64;
        Self {
            xx: mean(self.xx, next.xx),
            xy: mean(self.xy, next.xy),
            yy: mean(self.yy, next.yy),
            coordination: mean(self.coordination, next.coordination),
        }
    }

    /// Size of the shear stress over the normal stress (–), where something presses.
    pub fn ratio(self) -> Option<f64> {
        (self.yy > 0.0).then(|| (self.xy / self.yy).abs())
    }

    /// Computes stress and coordination from the impulses `r` (N·s) of a time step, over an area (m²); without one, the stress of a
    /// scene with a driven segment is over the rectangle around the grains.
    pub(crate) fn of<M: Marched>(
        time_step: &TimeStep<M>,
        scene: &Scene,
        (grains, area): (usize, Option<f64>),
        r: &[f64],
    ) -> Self {
        let radius = &time_step.frozen.radius;
        let position = &time_step.frozen.problem.position()[..grains];
        let area = area.or_else(|| scene.driven().next().map(|_| room(position, radius)));
        let bumps = scene.bump_radius().unwrap_or(0.0);
        let (mut stress, mut touched) = (Self::default(), 0_u32);
        for (contact, side, gap, r) in time_step.pushing(grains, r) {
            let beyond = match side {
                Side::Grain(j) => radius[j as usize],
                Side::Bump(_) | Side::Lid(_, 0..) => bumps,
                _ => 0.0,
            };
            touched += if matches!(side, Side::Grain(_)) { 2 } else { 1 };
            if let Some(area) = area {
                let branch = contact.normal() * (radius[contact.ends().0 as usize] + beyond + gap);
                let force = to_candidate::<M>(contact, r) / (scene.time_step_s * area);
                stress.xx += force[0] * branch[0];
                stress.xy += force[0] * branch[1];
                stress.yy += force[1] * branch[1];
            }
        }
        stress.coordination = f64::from(touched) / grains as f64;
        stress
    }
}
