//! Walls and other fixed bodies as they are drawn.

use crate::detect::{Side, WALLS};
use crate::scene::Scene;
use crate::scene::segments::{Segment, Shape};
use crate::scene::walls::Wall;
use contact::{Place, frame};
use nalgebra::Vector3;

/// The walls and bodies of a scene at a `time` (s), by their corners (m); grains reach so far along a direction.
pub(crate) fn drawn<P: Place>(scene: &Scene, time: f64, reach: impl Fn(P) -> f64) -> Vec<(Side, Vec<P>)> {
    let walls = scene.walls.as_ref().map_or([None; 5], |walls| walls.at::<P>(time));
    // From wall to wall along an axis, or as far as the grains reach.
    let between = |axis: [f64; 3], low: usize, high: usize| {
        let (axis, feet) = (P::of(axis), walls[low].zip(walls[high]));
        let periodic = scene.period().0.filter(|_| low == 1).map(|width| [0.0, width]);
        feet.map_or_else(
            || periodic.unwrap_or_else(|| [-reach(-axis), reach(axis)]),
            |(low, high)| [low.foot.dot_product(axis), high.foot.dot_product(axis)],
        )
    };
    let [x, z] = [between([1.0, 0.0, 0.0], 1, 2), between([0.0, 0.0, 1.0], 3, 4)];
    let corners = |side: Side, wall: Wall<P>| {
        let [foot_x, foot_y, foot_z] = wall.foot.space();
        let [from, to] = match side {
            Side::Floor => x.map(|x| [x, foot_y, z[0]]),
            Side::Left | Side::Right => z.map(|z| [foot_x, foot_y, z]),
            _ => x.map(|x| [x, foot_y, foot_z]),
        }
        .map(P::of);
        let across = if side == Side::Floor {
            P::of([0.0, 0.0, z[1] - z[0]])
        } else {
            let up = upwards(wall.normal);
            up * (reach(up) - up.dot_product(wall.foot)).max(0.0)
        };
        match P::LEN {
            2 if side == Side::Floor => vec![from, to],
            2 => vec![from, from + across],
            _ => vec![from, to, to + across, from + across],
        }
    };
    let some = WALLS.into_iter().zip(walls).filter_map(|(side, wall)| Some((side, wall?)));
    let floor = walls[0].map_or([0.0; 3], |floor| [x[0], floor.foot[1], 0.0]);
    some.map(|(side, wall)| (side, corners(side, wall)))
        .chain(outlines(scene, time, (floor, x[1]), z))
        .collect()
}

/// Direction up a wall with this normal, which stands on an edge along z or along x.
fn upwards<P: Place>(normal: P) -> P {
    let [n_x, n_y, n_z] = normal.space();
    P::of(if n_z == 0.0 { [-n_y * n_x.signum(), n_x * n_x.signum(), 0.0] } else { [0.0, 1.0, 0.0] })
}

/// Sides of the polygon that stands for a circle where it is drawn.
const SIDES: u32 = 72;

/// The upper half of a sphere, in faces of four corners (m).
fn dome([x, y, z]: [f64; 3], radius: f64) -> impl Iterator<Item = [[f64; 3]; 4]> {
    const AROUND: u32 = 8;
    const UP: u32 = 3;
    let at = move |k: u32, l: u32| {
        let turned = std::f64::consts::TAU * f64::from(k) / f64::from(AROUND);
        let raised = std::f64::consts::FRAC_PI_2 * f64::from(l) / f64::from(UP);
        let across = radius * libm::cos(raised);
        [x + across * libm::cos(turned), y + radius * libm::sin(raised), z + across * libm::sin(turned)]
    };
    let faces = (0..AROUND).flat_map(|k| (0..UP).map(move |l| (k, l)));
    faces.map(move |(k, l)| [at(k, l), at(k + 1, l), at(k + 1, l + 1), at(k, l + 1)])
}

/// The drum, the bumps on a floor from a place on to some x, and the segments at a `time` (s), to be drawn by their corners (m): lines
/// in the plane, and in space what they sweep between two z.
fn outlines<P: Place>(
    scene: &Scene,
    time: f64,
    (from, to_x): ([f64; 3], f64),
    z: [f64; 2],
) -> Vec<(Side, Vec<P>)> {
    let drum = scene.drum.into_iter().flat_map(|drum| arc(Side::Drum, [0.0; 2], drum.radius_m, SIDES, z));
    let bump_radius = scene.bump_radius();
    let bumps = bump_radius.into_iter().flat_map(|a| {
        let last = ((to_x - from[0]) / (2.0 * a)).ceil() as i32;
        let along = move |k: i32| from[0] + 2.0 * a * f64::from(k);
        // In space those whose centres are between the two z.
        let [low, high] =
            if P::LEN > 2 { [(z[0] / (2.0 * a)).ceil(), (z[1] / (2.0 * a)).floor()] } else { [0.0; 2] };
        let numbers = (0..=last).flat_map(move |k| (low as i32..=high as i32).map(move |row| [k, row]));
        numbers.flat_map(move |[k, row]| -> Vec<(Side, Vec<P>)> {
            let side = Side::Bump([k, row]);
            if P::LEN > 2 {
                let centre = [along(k), from[1], 2.0 * a * f64::from(row)];
                dome(centre, a).map(|corners| (side, corners.map(P::of).to_vec())).collect()
            } else {
                arc(side, [along(k), from[1]], a, SIDES / 2, z).collect()
            }
        })
    });
    let segments = (0..).zip(&scene.segments).flat_map(|(number, segment)| {
        let corners = segment.corners::<P>(time);
        corners.map_or_else(Vec::new, |corners| outline(segment, Side::Segment(number), &corners))
    });
    drum.chain(bumps).chain(segments).collect()
}

/// Draws a segment with these corners or ends (m): a line, or two with circles at their ends; in 3D by faces of four corners.
pub(crate) fn outline<P: Place>(segment: &Segment, side: Side, corners: &[P]) -> Vec<(Side, Vec<P>)> {
    match segment.shape() {
        // A fan from the first corner; where corners are odd the last face has one of them twice.
        Shape::Polygon => (1..corners.len() - 1)
            .step_by(2)
            .map(|k| (side, [0, k, k + 1, (k + 2).min(corners.len() - 1)].map(|k| corners[k]).to_vec()))
            .collect(),
        Shape::Line | Shape::Hollow if P::LEN > 2 => tube(side, [corners[0], corners[1]], segment.radius_m),
        Shape::Line | Shape::Hollow => line(segment, side, [corners[0], corners[1]]),
    }
}

/// The surface of a cylinder between the ends of its axis; of one without length a sphere (m).
fn tube<P: Place>(side: Side, [from, to]: [P; 2], radius: f64) -> Vec<(Side, Vec<P>)> {
    let along = Vector3::from((to - from).space());
    if along.length() == 0.0 {
        let [x, y, z] = from.space();
        let faces =
            dome([x, y, z], radius).flat_map(|face| [face, face.map(|[a, b, c]| [a, 2.0 * y - b, c])]);
        return faces.map(|face| (side, face.map(P::of).to_vec())).collect();
    }
    let [first, second] = frame(&along.normalize());
    let at = |end: P, k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(SIDES);
        end + P::of(((first * libm::cos(angle) + second * libm::sin(angle)) * radius).into())
    };
    (0..SIDES).map(|k| (side, vec![at(from, k), at(to, k), at(to, k + 1), at(from, k + 1)])).collect()
}

/// Draws a segment between these ends (m): a line, or two with circles at their ends.
fn line<P: Place>(segment: &Segment, side: Side, [from, to]: [P; 2]) -> Vec<(Side, Vec<P>)> {
    let (along, radius) = (to - from, segment.radius_m);
    let length = along.length();
    let aside = P::of([-along[1], along[0], 0.0]) * if length > 0.0 { radius / length } else { 0.0 };
    let ends = if radius > 0.0 { vec![from, to] } else { Vec::new() };
    let round = ends.into_iter().flat_map(|end| arc(side, [end[0], end[1]], radius, SIDES, [0.0; 2]));
    let flat = if length == 0.0 {
        Vec::new()
    } else if radius > 0.0 {
        vec![(side, vec![from + aside, to + aside]), (side, vec![from - aside, to - aside])]
    } else {
        vec![(side, vec![from, to])]
    };
    flat.into_iter().chain(round).collect()
}

/// The first of the sides that stand for a circle (m), and in space what they sweep between two z.
fn arc<P: Place>(
    side: Side,
    [x, y]: [f64; 2],
    radius: f64,
    sides: u32,
    z: [f64; 2],
) -> impl Iterator<Item = (Side, Vec<P>)> {
    let at = move |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(SIDES);
        [x + radius * libm::cos(angle), y + radius * libm::sin(angle)]
    };
    (0..sides).map(move |k| {
        let ([x0, y0], [x1, y1]) = (at(k), at(k + 1));
        let corners = [[x0, y0, z[0]], [x1, y1, z[0]], [x1, y1, z[1]], [x0, y0, z[1]]];
        (side, corners.into_iter().take(if P::LEN > 2 { 4 } else { 2 }).map(P::of).collect())
    })
}
