//! Shape of a packing, and what has left it: measures of slumps, drums, hoppers and chains of forces.

use crate::detect::extent::reach;
use crate::problem::marched::Marched;
use crate::problem::time_step::TimeStep;
use crate::scene::Scene;
use contact::{Place, Vector, number};
use serde::{Deserialize, Serialize};

/// Shape of a packing, with its columns in results; NaN is what is not defined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Shape {
    /// Extent along x of all grains (m).
    #[serde(rename = "width_m", with = "number")]
    pub width: f64,
    /// Angle of the bed in a drum, or in a hollow cylinder along z (rad): of the line from the axis to the centre of mass, from straight
    /// down, anticlockwise. That is the slope of a surface that is plane.
    #[serde(rename = "bed_angle_rad", with = "number")]
    pub bed_angle: f64,
    /// Mass of the grains whose centres are below all segments that no force drives (kg).
    #[serde(rename = "passed_mass_kg", with = "number")]
    pub passed_mass: f64,
    /// Share of the contacts that push whose normal impulse is below the mean of all (–).
    #[serde(with = "number")]
    pub weak_contacts: f64,
}

/// Nothing is known, as in journals older than these columns.
impl Default for Shape {
    fn default() -> Self {
        Self { width: f64::NAN, bed_angle: f64::NAN, passed_mass: f64::NAN, weak_contacts: f64::NAN }
    }
}

impl Shape {
    /// Measures grains at a time (s) by their masses (kg), places and radii (m), after a time step with its impulses `r` (N·s).
    pub(crate) fn of<M: Marched>(
        time_step: &TimeStep<M>,
        (scene, time): (&Scene, f64),
        (mass, position, radius): (&[f64], &[M::Place], &[f64]),
        r: &[f64],
    ) -> Self {
        let grains = mass.len();
        let (position, radius) = (&position[..grains], &radius[..grains]);
        let sum = |of: &dyn Fn(usize) -> f64| (0..grains).map(of).sum::<f64>();
        let normal: Vec<f64> = time_step.pushing(grains, r).map(|(.., r)| r.first()).collect();
        let mean = normal.iter().sum::<f64>() / normal.len() as f64;
        let weak = normal.iter().filter(|r| **r < mean).count() as f64;
        let along = |x: f64| M::Place::of([x, 0.0, 0.0]);
        let lowest = lowest::<M::Place>(scene, time);
        Self {
            width: reach(position, radius, along(1.0)) + reach(position, radius, along(-1.0)),
            bed_angle: axis(scene).map_or(f64::NAN, |[x, y]| {
                let away = |axis: usize, from: f64| sum(&|k| mass[k] * (position[k][axis] - from));
                libm::atan2(away(0, x), -away(1, y))
            }),
            passed_mass: lowest
                .map_or(f64::NAN, |lowest| sum(&|k| if position[k][1] < lowest { mass[k] } else { 0.0 })),
            weak_contacts: weak / normal.len() as f64,
        }
    }
}

/// Returns the place [x, y] of the axis of the drum, or of the first hollow cylinder along z where it begins (m).
fn axis(scene: &Scene) -> Option<[f64; 2]> {
    let of_segments = || {
        scene.segments.iter().filter(|segment| segment.hollow).find_map(|segment| {
            let [from, to] = [segment.from_m?.list(), segment.to_m?.list()];
            (from[..2] == to[..2]).then_some([from[0], from[1]])
        })
    };
    scene.drum.map(|_| [0.0, 0.0]).or_else(of_segments)
}

/// Returns the height of the lowest point of all segments that no force drives, at a `time` (s), of those taken away where they would
/// be (m).
fn lowest<P: Place>(scene: &Scene, time: f64) -> Option<f64> {
    let given = scene.segments.iter().filter(|segment| segment.driven.is_none());
    let heights = given.flat_map(|segment| {
        let below = segment.half_thickness();
        segment.posed::<P>(time).into_iter().map(move |corner| corner[1] - below)
    });
    heights.min_by(f64::total_cmp)
}
