//! Segments that meet: a disc touches them as the one line that they are.
//!
//! A joint is an end of a segment that lies on another one, or on a wall of the box, which moves alike. There a disc touches the end
//! only if it is the nearest point of both, so that the normal is in the cone between theirs; of several segments that end there the
//! thickest has the contact, the first of equal ones. Where the other is nearer, the end is hidden. If the line turns towards the disc
//! beyond the hidden end, the disc may reach that side within the time step: it has a contact with the line of that side as well.

use crate::bodies::Near;
use crate::detect::{DetectedContact, Side};
use crate::scene::Scene;
use crate::segments::{Beside, Segment};
use crate::walls::{MovingWall, WallMotion, Walls};
use contact::Place;
use nalgebra::Vector2;

/// What an end lies on.
#[derive(Clone, Copy, Debug)]
enum Other {
    /// A segment, by its place in the scene's list, and the end of it that is there, if one is.
    Segment(u32, Option<usize>),
    /// A wall, by its place among those of the box.
    Wall(usize),
}

/// The joints at the ends of each segment.
#[derive(Clone, Debug, Default)]
pub(crate) struct Joints(Vec<[Vec<Other>; 2]>);

/// How near is together, over the length of a segment, or its radius if it has none (–): coordinates may have six digits.
const TOGETHER: f64 = 1e-6;

/// The sine of an angle by which a line turns (–); by less it is straight.
const TURNS: f64 = 1e-6;

impl Joints {
    /// Those of a scene.
    pub(crate) fn of(scene: &Scene) -> Self {
        Self(scene.segments.iter().map(|segment| [0, 1].map(|end| ends_on(scene, segment, end))).collect())
    }
}

/// What the `end` of a segment lies on.
fn ends_on(scene: &Scene, segment: &Segment, end: usize) -> Vec<Other> {
    let [point, far] = at_begin(segment, end);
    let others = (0..).zip(&scene.segments).filter(|(_, other)| !std::ptr::eq(*other, segment));
    let on_others = others.filter(|(_, other)| segment.moves_as(other)).filter_map(|(number, other)| {
        let room = TOGETHER * size(segment).min(size(other));
        let ends = other.ends_at::<Vector2<f64>>(Vector2::zeros());
        let is_on = other.beside(ends, Vector2::zeros(), (point, -other.radius_m), room).is_some();
        let at = ends.iter().position(|end| (end - point).norm() <= room);
        is_on.then_some(Other::Segment(number, at))
    });
    let walls = scene.walls.as_ref().filter(|walls| stands_in(segment, walls) && segment.radius_m == 0.0);
    let walls = walls.map_or([None; 5], |walls| walls.at::<Vector2<f64>>(0.0));
    let room = TOGETHER * (far - point).norm();
    let on_walls =
        (0..).zip(walls).filter(|(_, wall)| wall.is_some_and(|wall| wall.gap(point, 0.0).abs() <= room));
    on_others.chain(on_walls.map(|(side, _)| Other::Wall(side))).collect()
}

/// An end of a segment when time begins, and the other one (m).
fn at_begin(segment: &Segment, end: usize) -> [Vector2<f64>; 2] {
    let ends = segment.ends_at(Vector2::zeros());
    [ends[end], ends[1 - end]]
}

/// Its length, or its radius if it has none (m).
fn size(segment: &Segment) -> f64 {
    let [from, to] = at_begin(segment, 0);
    if from == to { segment.radius_m } else { (to - from).norm() }
}

/// Whether a segment moves as the walls of the box, which keep their angles and distances.
fn stands_in(segment: &Segment, walls: &Walls) -> bool {
    let still = segment.velocity_m_per_s == [0.0; 2] && segment.motion.is_empty() && segment.driven.is_none();
    let stand = walls.tilt_rate_rad_per_s == 0.0 && walls.closing_speed_m_per_s == 0.0;
    still && stand && segment.vibration == walls.vibration
}

/// The segments that move as given, and the box, where contacts are sought.
pub(crate) struct Line<'s, P> {
    joints: &'s Joints,
    /// In the order of the scene's list; none of those that are driven or taken away.
    placed: Vec<Option<Placed<'s, P>>>,
    walls: [Option<MovingWall<P>>; 5],
}

/// A segment where contacts are sought.
struct Placed<'s, P> {
    segment: &'s Segment,
    ends: [P; 2],
    /// How far it came since they were sought last, or since time began (m).
    came: P,
    /// Its velocity until they are sought again, on average (m/s).
    velocity: P,
}

/// A disc where contacts are sought.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc<P> {
    pub(crate) place: P,
    pub(crate) radius: f64,
    /// How far it came since they were sought last, or since time began (m).
    pub(crate) came: P,
    /// How far its free velocity would lead it until they are sought again (m).
    pub(crate) ahead: P,
}

impl<'s, P: Place> Line<'s, P> {
    /// Those of a scene at a `time` (s), some time `since` contacts were sought last.
    pub(crate) fn at(
        (scene, joints): (&'s Scene, &'s Joints),
        walls: [Option<MovingWall<P>>; 5],
        (time, since): (f64, f64),
    ) -> Self {
        let place = |segment: &'s Segment| {
            let ends = segment.ends(time)?;
            let came = segment.moved::<P>(time) - segment.moved(time - since);
            Some(Placed { segment, ends, came, velocity: segment.velocity(time, scene.time_step_s) })
        };
        Self { joints, placed: scene.segments.iter().map(place).collect(), walls }
    }

    /// The contacts of a grain that are within `reach` (m), at most one with each segment, and how each of these moves.
    pub(crate) fn near(
        &self,
        grain: u32,
        disc: Disc<P>,
        (span, reach): (f64, f64),
    ) -> impl Iterator<Item = Near<P>> {
        (0..).zip(&self.placed).filter_map(move |(number, placed)| {
            let placed = placed.as_ref()?;
            let beside = placed.beside(disc, reach)?;
            let hidden = beside.end.map_or(Hidden::No, |end| self.hides((number, end), &disc));
            let (normal, gap) = match hidden {
                Hidden::No => (beside.towards(), beside.gap),
                Hidden::Ended => return None,
                Hidden::By(other) => placed.face(
                    beside.end?,
                    &beside,
                    &other,
                    disc.ahead - placed.velocity * span,
                    disc.place,
                )?,
            };
            let contact =
                DetectedContact { candidate: grain, antagonist: Side::Segment(number), normal, gap };
            let motion = WallMotion {
                opening: -normal.dot_product(placed.velocity),
                sliding: placed.velocity,
                ahead: None,
            };
            (gap <= reach).then_some((contact, motion))
        })
    }

    /// What hides the end of a segment, where it is the nearest point of that, from a disc.
    fn hides(&self, (number, end): (u32, usize), disc: &Disc<P>) -> Hidden<P> {
        let Some(own) = &self.placed[number as usize] else { return Hidden::No };
        let mut nearest: Option<Nearer<P>> = None;
        for other in &self.joints.0[number as usize][end] {
            let nearer = match *other {
                Other::Segment(other, at) => {
                    let Some(placed) = &self.placed[other as usize] else { continue };
                    let [radius, own] = [placed.segment.radius_m, own.segment.radius_m];
                    let Some(beside) = placed.beside(*disc, f64::INFINITY).filter(|_| radius >= own) else {
                        continue;
                    };
                    if beside.end.is_some() && beside.end == at {
                        if radius > own || other < number {
                            return Hidden::Ended;
                        }
                        continue;
                    }
                    Nearer {
                        distance: beside.between.length(),
                        place: disc.place - beside.between,
                        normal: beside.towards(),
                        is_face: beside.end.is_none(),
                    }
                }
                Other::Wall(side) => {
                    let Some(wall) = &self.walls[side] else { continue };
                    let distance = wall.now.gap(disc.place, 0.0);
                    let normal = wall.now.normal;
                    Nearer { distance, place: disc.place - normal * distance, normal, is_face: true }
                }
            };
            if nearest.as_ref().is_none_or(|nearest| nearer.distance < nearest.distance) {
                nearest = Some(nearer);
            }
        }
        nearest.map_or(Hidden::No, Hidden::By)
    }
}

/// How the end of a segment is hidden from a disc.
enum Hidden<P> {
    /// It is not: a contact with it is one with a corner.
    No,
    /// Another segment that ends there has the contact.
    Ended,
    /// By something that is nearer.
    By(Nearer<P>),
}

/// What is nearer to a disc than an end that lies on it.
struct Nearer<P> {
    /// From the centre (m).
    distance: f64,
    /// Its nearest point (m).
    place: P,
    /// Unit normal from there to the centre (–).
    normal: P,
    /// Whether the disc is beside it, not beyond one of its ends.
    is_face: bool,
}

impl<P: Place> Placed<'_, P> {
    fn beside(&self, disc: Disc<P>, reach: f64) -> Option<Beside<P>> {
        self.segment.beside(self.ends, disc.came - self.came, (disc.place, disc.radius), reach)
    }

    /// Normal (–) and gap (m) of a disc that is beyond an `end`, which an`other` hides, with the line of the segment's side; if the two
    /// make a corner there, in which the disc is, and its way `ahead`, seen from the segment (m), does not lead over the far end.
    fn face(
        &self,
        end: usize,
        beside: &Beside<P>,
        other: &Nearer<P>,
        ahead: P,
        place: P,
    ) -> Option<(P, f64)> {
        let [near, far] = [self.ends[end], self.ends[1 - end]];
        let (along, normal) = (far - near, beside.normal);
        let is_above = |direction: P, normal: P| direction.dot_product(normal) > TURNS * direction.length();
        if !is_above(other.place - near, normal) || !is_above(along, other.normal) {
            return None;
        }
        let gap = normal.dot_product(place - near) - beside.touching;
        let squared = along.dot_product(along);
        let [from, by] = [place - near, ahead].map(|way| way.dot_product(along) / squared);
        // The parts of the way after which the disc is beside the segment, and beyond its far end.
        let reaches_side = by > 0.0 && from + by > 0.0;
        let [enters, leaves] = [-from / by, (1.0 - from) / by];
        let gap_after = |part: f64| gap + part * normal.dot_product(ahead);
        let meets = if reaches_side {
            leaves >= 1.0 || f64::min(gap_after(enters), gap_after(leaves)) <= 0.0
        } else {
            other.is_face
        };
        (gap >= 0.0 && meets).then_some((normal, gap))
    }
}
