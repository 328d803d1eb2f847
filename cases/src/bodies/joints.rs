//! Segments that meet: a grain touches them as the one surface that they are.
//!
//! A joint is an end of a segment that lies on another one, or on a wall of the box, which moves alike. There a disc touches the end
//! only if it is the nearest point of both, so that the normal is in the cone between theirs; of several segments that end there the
//! thickest has the contact, the first of equal ones. Where the other is nearer, the end is hidden. If the line turns towards the disc
//! beyond the hidden end, the disc may reach that side within the time step: it has a contact with the line of that side as well.
//!
//! Among spheres the same holds of edges, corners and rims: where the nearest point of a polygon lies on another surface too, the nearer of
//! the two has the contact, and in a corner that turns towards the sphere the plane of the other as well.

use super::seeker::{Near, Seeker};
use crate::detect::Side;
use crate::scene::Scene;
use crate::scene::beside::{Approach, Beside, End, inwards, nearest_of};
use crate::scene::segments::{Segment, Shape};
use crate::scene::walls::{MovingWall, WallMotion, Walls};
use contact::Place;
use nalgebra::{Vector2, Vector3};

/// Support of an end.
#[derive(Clone, Copy, Debug)]
enum Other {
    /// A segment, by its place in the scene's list, and the end of it that is there, if one is.
    Segment(u32, Option<usize>),
    /// A wall, by its place among those of the box.
    Wall(usize),
}

/// The joints of each segment: in 2D at its two ends; in 3D what its boundary may lie on anywhere.
#[derive(Clone, Debug, Default)]
pub(crate) struct Joints(Vec<[Vec<Other>; 2]>);

/// Distance within which points coincide, over the length of a segment, or its radius if it has none (–): coordinates may have six
/// digits.
const TOGETHER: f64 = 1e-6;

/// The sine of an angle by which a line turns (–); by less it is straight.
const TURNS: f64 = 1e-6;

impl Joints {
    /// Returns the joints of a scene.
    pub(crate) fn of(scene: &Scene, in_space: bool) -> Self {
        let joints = |segment| {
            if in_space {
                [around(scene, segment), Vec::new()]
            } else {
                [0, 1].map(|end| ends_on(scene, segment, end))
            }
        };
        Self(scene.segments.iter().map(joints).collect())
    }
}

/// Returns what a segment may meet in 3D: the others that move alike and are as thick at least, and the walls.
fn around(scene: &Scene, segment: &Segment) -> Vec<Other> {
    let [low, high] = Vector3::extent(segment.corners_at(Vector3::zeros()).into_iter());
    let meets = |other: &Segment| {
        let [from, to] = Vector3::extent(other.corners_at(Vector3::zeros()).into_iter());
        let room = segment.radius_m + other.radius_m + TOGETHER * size(segment);
        (0..3).all(|axis| low[axis] <= to[axis] + room && from[axis] <= high[axis] + room)
    };
    let others = (0..).zip(&scene.segments).filter(|(_, other)| !std::ptr::eq(*other, segment));
    let others = others.filter(|(_, other)| segment.moves_as(other) && meets(other));
    let stands = scene
        .walls
        .as_ref()
        .is_some_and(|walls| stands_in(segment, walls) && segment.half_thickness() == 0.0);
    let walls = (0..if stands { 5 } else { 0 }).map(Other::Wall);
    others.map(|(number, _)| Other::Segment(number, None)).chain(walls).collect()
}

/// Returns the support of the `end` of a segment.
fn ends_on(scene: &Scene, segment: &Segment, end: usize) -> Vec<Other> {
    let [point, far] = at_begin(segment, end);
    let others = (0..).zip(&scene.segments).filter(|(_, other)| !std::ptr::eq(*other, segment));
    let on_others = others.filter(|(_, other)| segment.moves_as(other)).filter_map(|(number, other)| {
        let room = TOGETHER * size(segment).min(size(other));
        let ends = other.corners_at::<Vector2<f64>>(Vector2::zeros());
        let is_on =
            other.beside(&ends, Approach { reach: room, ..Approach::at(point, -other.radius_m) }).is_some();
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
    let ends = segment.corners_at(Vector2::zeros());
    [ends[end], ends[1 - end]]
}

/// Its length, the first edge of a polygon, or its radius if it has none (m).
fn size(segment: &Segment) -> f64 {
    let corners = segment.corners_at(Vector3::zeros());
    let length = (corners[1] - corners[0]).norm();
    if length == 0.0 { segment.radius_m } else { length }
}

/// Checks that a segment moves as the walls of the box, which keep their angles and distances.
fn stands_in(segment: &Segment, walls: &Walls) -> bool {
    let still = segment.velocity_m_per_s.list() == [0.0; 3]
        && segment.motion.is_empty()
        && segment.driven.is_none()
        && segment.turning.is_none();
    let stand = walls.tilt_rate_rad_per_s == 0.0 && walls.closing_speed_m_per_s == 0.0;
    still && stand && segment.vibration == walls.vibration
}

/// The segments that move as given, and the box, where contacts are sought.
pub(crate) struct Line<'s, P> {
    joints: &'s Joints,
    /// Segments in the order of the scene's list; none of those that are driven or taken away.
    placed: Vec<Option<Placed<'s, P>>>,
    walls: [Option<MovingWall<P>>; 5],
    /// The time until contacts are sought again (s).
    span: f64,
}

/// A segment where contacts are sought.
struct Placed<'s, P> {
    segment: &'s Segment,
    /// Its corners, or its two ends (m).
    ends: Vec<P>,
    /// Displacement since contacts were detected last, or since time began, without its turn (m).
    came: P,
    /// Its velocity until they are sought again, on average and without its turn (m/s).
    velocity: P,
    /// Its turn, if it turns or curves towards grains.
    next: Option<Next<P>>,
}

/// Pose of a segment when contacts are sought again.
struct Next<P> {
    ends: Vec<P>,
    /// The times at which contacts were sought last, are sought now, and will be (s).
    times: [f64; 3],
}

impl<'s, P: Place> Line<'s, P> {
    /// Returns the joints of a scene at a `time` (s), some time `since` contacts were sought last.
    pub(crate) fn at(
        (scene, joints): (&'s Scene, &'s Joints),
        walls: [Option<MovingWall<P>>; 5],
        (time, since): (f64, f64),
    ) -> Self {
        let span = scene.time_step_s;
        let place = |segment: &'s Segment| {
            let ends = segment.corners(time)?;
            let came = segment.moved::<P>(time) - segment.moved(time - since);
            let is_curved = segment.turning.is_some() || segment.shape() == Shape::Hollow;
            let times = [time - since, time, time + span];
            let next = is_curved.then(|| Next { ends: segment.posed(time + span), times });
            Some(Placed { segment, ends, came, velocity: segment.velocity(time, span), next })
        };
        Self { joints, placed: scene.segments.iter().map(place).collect(), walls, span }
    }

    /// The contacts of a disc, at most one with each segment.
    pub(crate) fn near(&self, disc: &Seeker<P>) -> impl Iterator<Item = Near<P>> {
        (0..).zip(&self.placed).filter_map(move |(number, placed)| {
            let placed = placed.as_ref()?;
            let (normal, gap) = self.contact((number, placed), &placed.beside(disc, disc.reach)?, disc)?;
            let motion = || placed.motion(disc, (normal, gap), self.span);
            disc.meets(Side::Segment(number), (normal, gap), motion)
        })
    }

    /// Normal (–) and gap (m) of a disc beside a segment, unless that is hidden.
    fn contact(
        &self,
        (number, placed): (u32, &Placed<P>),
        beside: &Beside<P>,
        disc: &Seeker<P>,
    ) -> Option<(P, f64)> {
        let own = Some((beside.towards(), beside.gap));
        let Some(end) = beside.end else { return own };
        let mut hidden_by: Option<Nearer<P>> = None;
        let joints = &self.joints.0[number as usize];
        let others = if let End::Of(end) = end
            && P::LEN == 2
        {
            &joints[end]
        } else {
            &joints[0]
        };
        for other in others {
            match self.hides((number, placed), other, beside, disc) {
                Hides::No => {}
                Hides::AtItsEnd => return None,
                Hides::Nearer(other) => {
                    if hidden_by.as_ref().is_none_or(|by| other.distance < by.distance) {
                        hidden_by = Some(other);
                    }
                }
            }
        }
        let Some(other) = hidden_by else { return own };
        let ahead = placed.seen_ahead(disc, self.span);
        match end {
            End::Of(end) if P::LEN == 2 => {
                let goes_on = self.turns_up((number, placed), 1 - end, beside.normal);
                placed.face((end, goes_on), beside, &other, (disc.place, ahead))
            }
            _ => placed.plane(beside, &other, (disc.place, ahead)),
        }
    }

    /// Checks that the line turns to the side of this `normal` (–) beyond an `end` of a segment.
    fn turns_up(&self, (number, placed): (u32, &Placed<P>), end: usize, normal: P) -> bool {
        let from = placed.ends[end];
        self.joints.0[number as usize][end].iter().any(|other| match *other {
            Other::Segment(other, at) => {
                let there = self.placed[other as usize].as_ref().zip(at);
                there.is_some_and(|(there, at)| is_above(there.ends[1 - at] - from, normal))
            }
            Other::Wall(_) => true,
        })
    }

    /// Determines how an`other` body, on which an end of a segment lies, hides that end from a disc to which it is the nearest
    /// point.
    fn hides(
        &self,
        (number, placed): (u32, &Placed<P>),
        other: &Other,
        beside: &Beside<P>,
        disc: &Seeker<P>,
    ) -> Hides<P> {
        match *other {
            Other::Segment(other, at) => {
                let Some(there) = &self.placed[other as usize] else { return Hides::No };
                let [radius, own] = [there, placed].map(|placed| placed.segment.half_thickness());
                let Some(nearest) = there.beside(disc, f64::INFINITY).filter(|_| radius >= own) else {
                    return Hides::No;
                };
                // In 3D an edge lies on another surface here and not there.
                let room =
                    if P::LEN > 2 { TOGETHER * size(placed.segment).min(size(there.segment)) } else { 0.0 };
                if P::LEN > 2 && !there.is_beneath(disc.place - beside.between, room) {
                    return Hides::No;
                }
                let nearest_here = |end: End| match at {
                    Some(at) => end == End::Of(at),
                    None => P::LEN > 2 && (nearest.between - beside.between).length() <= room,
                };
                if nearest.end.is_some_and(nearest_here) {
                    let has_it = radius > own || other < number;
                    return if has_it { Hides::AtItsEnd } else { Hides::No };
                }
                let [distance, to_end] = [&nearest, beside].map(|beside| beside.between.length());
                // Of several in a row each is nearer than the one before, so that the row has an end.
                let is_open = nearest.end.is_none()
                    || distance < to_end && self.contact((other, there), &nearest, disc).is_some();
                let place = disc.place - nearest.between;
                Hides::Nearer(Nearer { distance, place, normal: nearest.normal, is_open })
            }
            Other::Wall(side) => {
                let Some(wall) = &self.walls[side] else { return Hides::No };
                let (distance, normal) = (wall.now.gap(disc.place, 0.0), wall.now.normal);
                let point = disc.place - beside.between;
                if P::LEN > 2 && wall.now.gap(point, 0.0).abs() > TOGETHER * size(placed.segment) {
                    return Hides::No;
                }
                let place = disc.place - normal * distance;
                Hides::Nearer(Nearer { distance, place, normal, is_open: true })
            }
        }
    }
}

/// Checks that a direction rises towards the side of this normal.
fn is_above<P: Place>(direction: P, normal: P) -> bool {
    direction.dot_product(normal) > TURNS * direction.length()
}

/// Effect of a body, on which the end of a segment lies, on the contact of this end with a disc.
enum Hides<P> {
    /// No effect.
    No,
    /// The body ends there too, and has the contact.
    AtItsEnd,
    /// The body is nearer.
    Nearer(Nearer<P>),
}

/// Part of the line nearer to a disc than an end that lies on it.
struct Nearer<P> {
    /// Distance from the centre (m).
    distance: f64,
    /// Its nearest point (m).
    place: P,
    /// Unit normal of its line on the side of the disc (–).
    normal: P,
    /// Set where the disc has a contact with its side and can reach the next piece.
    is_open: bool,
}

impl<P: Place> Placed<'_, P> {
    /// Checks that a point lies on the segment, to within a `room` (m).
    fn is_beneath(&self, point: P, room: f64) -> bool {
        let grain = Approach::at(point, -self.segment.half_thickness());
        let beside = self.segment.beside(&self.ends, grain);
        beside.is_some_and(|beside| beside.between.length() <= room)
    }

    fn beside(&self, disc: &Seeker<P>, reach: f64) -> Option<Beside<P>> {
        let came = match &self.next {
            // The place at which the segment was under what it now is under has turned with it.
            Some(Next { times: [before, now, _], .. }) if self.segment.turning.is_some() => {
                disc.place - self.segment.carried(disc.place - disc.came, *before, *now)
            }
            _ => disc.came - self.came,
        };
        self.segment.beside(&self.ends, Approach { came, reach, ..Approach::at(disc.place, disc.radius) })
    }

    /// Returns the free motion of a grain as the segment sees it where they touch (m).
    fn seen_ahead(&self, disc: &Seeker<P>, span: f64) -> P {
        match &self.next {
            Some(Next { times: [_, now, then], .. }) if self.segment.turning.is_some() => {
                disc.ahead - (self.segment.carried(disc.place, *now, *then) - disc.place)
            }
            _ => disc.ahead - self.velocity * span,
        }
    }

    /// Returns the motion of its surface at a contact with this normal (–) and gap (m). Where it turns, it opens at the rate that leads to the
    /// gap there will be where the grain's free motion along it leads; where it curves towards the grain, the contact knows that gap.
    fn motion(&self, disc: &Seeker<P>, (normal, gap): (P, f64), span: f64) -> WallMotion<P> {
        let Some(Next { ends, times: [_, now, then] }) = &self.next else {
            return WallMotion::sliding(self.velocity, normal);
        };
        let point = disc.place - normal * (disc.radius + gap);
        let velocity = (self.segment.carried(point, *now, *then) - point) / span;
        let along = disc.ahead - normal * normal.dot_product(disc.ahead);
        let there = self.segment.beside(ends, Approach::at(disc.place + along, disc.radius));
        let sliding = WallMotion::sliding(velocity, normal);
        let Some(there) = there.map(|there| there.gap) else { return sliding };
        if self.segment.shape() == Shape::Hollow && there < gap {
            // What is left of an overlap is taken back, as in a drum.
            return WallMotion { ahead: Some(there - span * sliding.opening), ..sliding };
        }
        // What curves away from a grain only parts from it.
        let opening = if self.segment.turning.is_some() { (there - gap) / span } else { sliding.opening };
        WallMotion { opening, ..sliding }
    }

    /// Normal (–) and gap (m) of a sphere that is beyond an edge of a polygon, which an`other` surface hides, with the plane of the polygon: if
    /// the two make a corner there, in which the sphere is, and its way `ahead`, seen from the polygon (m), or what pushes it, may lead there.
    fn plane(&self, beside: &Beside<P>, other: &Nearer<P>, (place, ahead): (P, P)) -> Option<(P, f64)> {
        let normal = beside.normal;
        let point = place - beside.between;
        let is_corner = self.segment.shape() == Shape::Polygon
            && is_above(other.place - point, normal)
            && is_above(inwards(&self.ends, point), other.normal);
        if !is_corner {
            return None;
        }
        let gap = normal.dot_product(place - point) - beside.touching;
        let foot = |place: P| place - normal * normal.dot_product(place - point);
        let leads_there = nearest_of(&self.ends, normal, foot(place + ahead)).1.is_none();
        let meets = leads_there || beside.end == Some(End::Edge) && other.is_open;
        (gap >= 0.0 && meets).then_some((normal, gap))
    }

    /// Normal (–) and gap (m) of a disc that is beyond an `end`, which an`other` hides, with the line of the segment's side; if the two
    /// make a corner there, in which the disc is, and its way `ahead`, seen from the segment (m), may lead to that side and not over it. Where the
    /// line `goes_on` to turn towards the disc, nothing is over it.
    fn face(
        &self,
        (end, goes_on): (usize, bool),
        beside: &Beside<P>,
        other: &Nearer<P>,
        (place, ahead): (P, P),
    ) -> Option<(P, f64)> {
        let [near, far] = [self.ends[end], self.ends[1 - end]];
        let (along, normal) = (far - near, beside.normal);
        if !is_above(other.place - near, normal) || !is_above(along, other.normal) {
            return None;
        }
        let gap = normal.dot_product(place - near) - beside.touching;
        let length = along.length();
        // Before the near end, and how far it moves towards the far one.
        let [before, by] = [near - place, ahead].map(|way| way.dot_product(along) / length);
        let [enters, leaves] = [before / by, (before + length) / by];
        let gap_after = |part: f64| gap + part * normal.dot_product(ahead);
        let meets = if by > before {
            goes_on || leaves >= 1.0 || f64::min(gap_after(enters), gap_after(leaves)) <= 0.0
        } else {
            // Pushed by others it may come there all the same.
            other.is_open
        };
        (gap >= 0.0 && meets).then_some((normal, gap))
    }
}
