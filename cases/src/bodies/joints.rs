//! Segments that meet: a disc touches them as the one line that they are.
//!
//! A joint is an end of a segment that lies on another one, or on a wall of the box, which moves alike. There a disc touches the end
//! only if it is the nearest point of both, so that the normal is in the cone between theirs; of several segments that end there the
//! thickest has the contact, the first of equal ones. Where the other is nearer, the end is hidden. If the line turns towards the disc
//! beyond the hidden end, the disc may reach that side within the time step: it has a contact with the line of that side as well.

use super::seeker::{Near, Seeker};
use crate::detect::Side;
use crate::scene::Scene;
use crate::scene::segments::{Beside, Segment};
use crate::scene::walls::{MovingWall, WallMotion, Walls};
use contact::Place;
use nalgebra::Vector2;

/// Support of an end.
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

/// Distance within which points coincide, over the length of a segment, or its radius if it has none (–): coordinates may have six
/// digits.
const TOGETHER: f64 = 1e-6;

/// The sine of an angle by which a line turns (–); by less it is straight.
const TURNS: f64 = 1e-6;

impl Joints {
    /// Returns the joints of a scene.
    pub(crate) fn of(scene: &Scene) -> Self {
        Self(scene.segments.iter().map(|segment| [0, 1].map(|end| ends_on(scene, segment, end))).collect())
    }
}

/// Returns the support of the `end` of a segment.
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

/// Checks that a segment moves as the walls of the box, which keep their angles and distances.
fn stands_in(segment: &Segment, walls: &Walls) -> bool {
    let still = segment.velocity_m_per_s == [0.0; 2] && segment.motion.is_empty() && segment.driven.is_none();
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
    ends: [P; 2],
    /// Displacement since contacts were detected last, or since time began (m).
    came: P,
    /// Its velocity until they are sought again, on average (m/s).
    velocity: P,
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
            let ends = segment.ends(time)?;
            let came = segment.moved::<P>(time) - segment.moved(time - since);
            Some(Placed { segment, ends, came, velocity: segment.velocity(time, span) })
        };
        Self { joints, placed: scene.segments.iter().map(place).collect(), walls, span }
    }

    /// The contacts of a disc, at most one with each segment.
    pub(crate) fn near(&self, disc: &Seeker<P>) -> impl Iterator<Item = Near<P>> {
        (0..).zip(&self.placed).filter_map(move |(number, placed)| {
            let placed = placed.as_ref()?;
            let (normal, gap) = self.contact((number, placed), &placed.beside(disc, disc.reach)?, disc)?;
            let motion = || WallMotion::sliding(placed.velocity, normal);
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
        for other in &self.joints.0[number as usize][end] {
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
        let ahead = disc.ahead - placed.velocity * self.span;
        let goes_on = self.turns_up((number, placed), 1 - end, beside.normal);
        placed.face((end, goes_on), beside, &other, (disc.place, ahead))
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
                let [radius, own] = [there, placed].map(|placed| placed.segment.radius_m);
                let Some(nearest) = there.beside(disc, f64::INFINITY).filter(|_| radius >= own) else {
                    return Hides::No;
                };
                if nearest.end.is_some() && nearest.end == at {
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
    fn beside(&self, disc: &Seeker<P>, reach: f64) -> Option<Beside<P>> {
        self.segment.beside(self.ends, disc.came - self.came, (disc.place, disc.radius), reach)
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
