//! Properties of a packing away from its walls and its surface: solid fraction, coordination number and share of rattlers.
//!
//! The bulk is the box that is two mean diameters from the floor, from upright walls and from the surface, which is twice as high as the
//! mean height. Solid fraction: what of the grains is in that box, cut by its faces, over its volume (in the plane its area). The
//! contacts are those that push. A rattler is a grain with fewer of them than can hold it: d + 1 without friction, d where it has weight,
//! and 2 with friction. Its contacts go, others may then have too few, and so on until all that are left are held. A grain in a cage
//! that has weight rests on d others and is none.
//!
//! I. Agnolin, J.-N. Roux, "Internal states of model isotropic granular packings. I", Phys. Rev. E 76 (2007): frictionless spheres have
//! 6 contacts at a solid fraction of 0.64.

use crate::detect::Side;
use crate::problem::marched::Marched;
use crate::problem::time_step::TimeStep;
use crate::scene::Scene;
use contact::{Place, Touch, Vector, number};
use serde::{Deserialize, Serialize};

/// The bulk of a packing, with its columns in results; NaN is what is not defined, as where there is no bulk or no grain's centre is in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Bulk {
    /// Volume of grains over volume (–).
    #[serde(rename = "bulk_solid_fraction", with = "number")]
    pub solid_fraction: f64,
    /// Contacts per grain that is no rattler (–).
    #[serde(rename = "bulk_coordination", with = "number")]
    pub coordination: f64,
    /// Share of grains that are rattlers (–).
    #[serde(rename = "bulk_rattlers", with = "number")]
    pub rattlers: f64,
}

/// Distance of the bulk from walls and surface, over a mean diameter (–).
const MARGIN: f64 = 2.0;

impl Bulk {
    /// The mean of so many time steps with this one and one more with another.
    #[must_use]
    pub fn and_then(self, time_steps: u64, next: Self) -> Self {
        let mean = |before: f64, next: f64| before + (next - before) / (time_steps + 1) as f64;
        Self {
            solid_fraction: mean(self.solid_fraction, next.solid_fraction),
            coordination: mean(self.coordination, next.coordination),
            rattlers: mean(self.rattlers, next.rattlers),
        }
    }

    /// Computes the properties of the bulk from the impulses `r` (N·s) of a time step, for the first `grains` of its bodies, at
    /// `time` (s).
    pub(crate) fn of<M: Marched>(
        time_step: &TimeStep<M>,
        scene: &Scene,
        (grains, time): (usize, f64),
        r: &[f64],
    ) -> Self {
        let (problem, radius) = (&time_step.frozen.problem, &time_step.frozen.radius[..grains]);
        let position = &problem.position()[..grains];
        let Some([low, high]) = inside::<M::Place>(scene, time, position, radius) else {
            return Self { solid_fraction: f64::NAN, coordination: f64::NAN, rattlers: f64::NAN };
        };
        let period = scene.period().0;
        let solid_fraction = solid_fraction(position, radius, [low, high], period.is_some());
        let pair = |(contact, side, ..): (&M::Contact, Side, _, _)| {
            (contact.ends().0, if let Side::Grain(j) = side { Some(j) } else { None })
        };
        let pushing: Vec<(u32, Option<u32>)> = time_step.pushing(grains, r).map(pair).collect();
        let needed = needed::<M::Place>(scene);
        let held = held_contacts(grains, &pushing, needed);
        let within =
            |x: &M::Place| (0..M::Place::LEN).all(|axis| low[axis] <= x[axis] && x[axis] <= high[axis]);
        let of_bulk: Vec<u32> =
            position.iter().zip(held).filter(|(x, _)| within(x)).map(|(_, held)| held).collect();
        let rattlers = of_bulk.iter().filter(|held| **held == 0).count();
        let left = of_bulk.len() - rattlers;
        // Of none, NaN.
        let over = |sum: f64, count: usize| sum / count as f64;
        Self {
            solid_fraction,
            coordination: over(of_bulk.iter().map(|held| f64::from(*held)).sum(), left),
            rattlers: over(rattlers as f64, of_bulk.len()),
        }
    }
}

/// Returns the bulk's least and greatest corner (m), if it has one: the scene's walls are upright, nothing else stands between the
/// grains, and the bed is nowhere too narrow.
fn inside<P: Place>(scene: &Scene, time: f64, position: &[P], radius: &[f64]) -> Option<[[f64; 3]; 2]> {
    if !scene.segments.is_empty() {
        return None;
    }
    let walls = scene.walls.as_ref()?.at::<P>(time);
    let count = position.len() as f64;
    let margin = MARGIN * 2.0 * radius.iter().sum::<f64>() / count;
    let foot = walls[0]?.foot;
    // A bed that has not come down lies higher than the floor.
    let lowest = position.iter().zip(radius).map(|(x, radius)| x[1] - radius).fold(f64::INFINITY, f64::min);
    let ground = if lowest > foot[1] + margin { lowest } else { foot[1] };
    let bed = 2.0 * (position.iter().map(|x| x[1]).sum::<f64>() / count - ground);
    let mut low = [f64::NEG_INFINITY, ground + margin, f64::NEG_INFINITY];
    let mut high = [f64::INFINITY, ground + bed - margin, f64::INFINITY];
    for (axis, sides) in [(0, [walls[1], walls[2]]), (2, [walls[3], walls[4]])] {
        if axis >= P::LEN {
            (low[axis], high[axis]) = (0.0, 0.0);
        } else if let (0, Some(width)) = (axis, scene.period().0) {
            (low[axis], high[axis]) = (0.0, width);
        } else {
            let [near, far] = sides.map(|wall| wall.filter(|wall| wall.normal[axis].abs() == 1.0));
            (low[axis], high[axis]) = (near?.foot[axis] + margin, far?.foot[axis] - margin);
        }
    }
    (0..P::LEN).all(|axis| low[axis] < high[axis]).then_some([low, high])
}

/// The fewest contacts that hold a grain: against any load d + 1, and where its weight is one of the loads d; 2 with friction.
fn needed<P: Place>(scene: &Scene) -> u32 {
    if scene.has_rough_grains() {
        2
    } else if scene.gravity_m_per_s2 != 0.0 {
        P::LEN as u32
    } else {
        P::LEN as u32 + 1
    }
}

/// Contacts of each grain with others that are held, and with walls; none of rattlers, which have fewer than `needed`.
fn held_contacts(grains: usize, pushing: &[(u32, Option<u32>)], needed: u32) -> Vec<u32> {
    let mut held = vec![0; grains];
    let mut of_grain = vec![Vec::new(); grains];
    for (i, j) in pushing {
        for grain in [Some(*i), *j].into_iter().flatten() {
            held[grain as usize] += 1;
        }
        if let Some(j) = j {
            of_grain[*i as usize].push(*j);
            of_grain[*j as usize].push(*i);
        }
    }
    let mut gone = vec![false; grains];
    let mut falling: Vec<u32> = (0..grains as u32).filter(|grain| held[*grain as usize] < needed).collect();
    while let Some(grain) = falling.pop() {
        if std::mem::replace(&mut gone[grain as usize], true) {
            continue;
        }
        held[grain as usize] = 0;
        for other in &of_grain[grain as usize] {
            let other_held = &mut held[*other as usize];
            if !gone[*other as usize] {
                *other_held -= 1;
                if *other_held < needed {
                    falling.push(*other);
                }
            }
        }
    }
    held
}

/// Volume, or area, of grains inside a box over that of the box (–). Where the box is periodic, nothing is cut along x.
fn solid_fraction<P: Place>(
    position: &[P],
    radius: &[f64],
    [low, high]: [[f64; 3]; 2],
    periodic: bool,
) -> f64 {
    let filled = position.iter().zip(radius).map(|(x, radius)| {
        let x = x.space();
        let mut cut: [[f64; 2]; 3] =
            std::array::from_fn(|axis| [(low[axis] - x[axis]) / radius, (high[axis] - x[axis]) / radius]);
        if periodic {
            cut[0] = [-1.0, 1.0];
        }
        let square = radius * radius;
        if P::LEN > 2 { ball_in(cut) * square * radius } else { disc_in([cut[0], cut[1]], 1.0) * square }
    });
    filled.sum::<f64>() / (0..P::LEN).map(|axis| high[axis] - low[axis]).product::<f64>()
}

/// Volume of the unit ball between two planes across each axis: areas of its sections across y, by Gauss's rule of four points over
/// parts of its height. Exact where planes pass the ball or halve it, to 1e-3 where they cut its edges.
fn ball_in([x, y, z]: [[f64; 2]; 3]) -> f64 {
    const PARTS: u32 = 8;
    const NODES: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_26, 0.652_145_154_862_546_2),
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_2),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let [low, high] = y.map(|y| y.clamp(-1.0, 1.0));
    let half = 0.5 * (high - low) / f64::from(PARTS);
    if half <= 0.0 || [x, z].iter().any(|[low, high]| *low >= 1.0 || *high <= -1.0) {
        return 0.0;
    }
    let section = |height: f64| disc_in([x, z], (1.0 - height * height).max(0.0).sqrt());
    let part = |k: u32| {
        let middle = low + half * f64::from(2 * k + 1);
        half * NODES.iter().map(|(at, weight)| weight * section(middle + half * at)).sum::<f64>()
    };
    (0..PARTS).map(part).sum()
}

/// Area of a disc around the origin between two lines across each axis.
fn disc_in([x, y]: [[f64; 2]; 2], radius: f64) -> f64 {
    if radius <= 0.0 {
        return 0.0;
    }
    let below = |k: usize, l: usize| quadrant(x[k] / radius, y[l] / radius);
    radius * radius * (below(1, 1) - below(0, 1) - below(1, 0) + below(0, 0))
}

/// Area of what of the unit disc has x < a and y < b.
fn quadrant(a: f64, b: f64) -> f64 {
    let (a, b) = (a.clamp(-1.0, 1.0), b.clamp(-1.0, 1.0));
    // ∫ √(1 − x²) dx from 0.
    let half = |x: f64| 0.5 * (x * (1.0 - x * x).max(0.0).sqrt() + libm::asin(x));
    // Where the line y = b crosses the circle.
    let c = (1.0 - b * b).sqrt();
    let (from, to) = (-c, a.clamp(-c, c));
    let between = b * (to - from) + half(to) - half(from);
    let beside = |from: f64, to: f64| 2.0 * (half(to) - half(from));
    let aside = if b > 0.0 { beside(-1.0, a.min(-c)) + beside(c, a.max(c)) } else { 0.0 };
    between + aside
}

#[cfg(test)]
mod tests;
