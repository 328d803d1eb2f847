//! A grain beside a segment: the nearest point of a line, a polygon or a hollow cylinder, and the side from which the grain came.

use crate::scene::polygon::{area, centroid};
use crate::scene::segments::{Segment, Shape};
use contact::Place;
use nalgebra::Vector3;

/// A grain that may touch a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach<P> {
    /// Its centre (m).
    pub(crate) place: P,
    /// Its radius (m).
    pub(crate) radius: f64,
    /// Displacement since contacts were detected last, as the segment sees it (m).
    pub(crate) came: P,
    /// The greatest gap that matters (m).
    pub(crate) reach: f64,
}

impl<P: Place> Approach<P> {
    /// Returns a grain that has not moved, at any distance.
    pub(crate) fn at(place: P, radius: f64) -> Self {
        Self { place, radius, came: P::ZERO, reach: f64::INFINITY }
    }
}

/// A grain beside a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beside<P> {
    /// The part of its boundary on which the nearest point lies, if it does; none where the grain has passed through.
    pub(crate) end: Option<End>,
    /// Vector from the nearest point to the centre (m).
    pub(crate) between: P,
    /// Its length (m).
    distance: f64,
    /// Unit normal of the segment towards the side from which the grain came (–); 0 of a segment without length.
    pub(crate) normal: P,
    /// Distance of centre and line where the surfaces touch (m).
    pub(crate) touching: f64,
    /// Distance of the surfaces; where the centre has passed through, less than minus the radius (m).
    pub(crate) gap: f64,
}

/// Part of the boundary of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// An end of a line, by its place among the two.
    Of(usize),
    /// An edge of a polygon.
    Edge,
    /// A corner of a polygon.
    Corner,
    /// The rim of a hollow cylinder.
    Rim,
}

impl<P: Place> Beside<P> {
    /// Unit normal of the contact (–).
    pub(crate) fn towards(&self) -> P {
        match self.end {
            None => self.normal,
            Some(_) if self.distance > 0.0 => self.between / self.distance,
            // A centre on an end has no side; any will push it off.
            Some(_) => P::of([0.0, 1.0, 0.0]),
        }
    }
}

/// Share of the touching distance within which a centre that crosses the line beyond an end has passed the segment (–): a grain that goes
/// round an end crosses it at the whole of that. An end without thickness would never be overlapped by more than a radius.
const PASSED: f64 = 0.5;

/// Checks whether a centre that moved from a height `before` above a line to `after` crossed it between 0 and 1 of its length, or within a
/// `room` of its ends; it was at the share `from` of it and is at `to`.
fn is_within(room: f64, from: f64, to: f64, before: f64, after: f64) -> bool {
    let crossed = before * after <= 0.0 && before != after;
    crossed && (-room..=1.0 + room).contains(&(from + (to - from) * before / (before - after)))
}

impl Segment {
    /// Locates a grain beside the segment with these corners or ends (m), if their surfaces are within its reach.
    pub(crate) fn beside<P: Place>(&self, corners: &[P], grain: Approach<P>) -> Option<Beside<P>> {
        match self.shape() {
            Shape::Line => self.beside_line([corners[0], corners[1]], grain),
            Shape::Polygon => self.beside_polygon(corners, grain),
            Shape::Hollow => self.beside_hollow([corners[0], corners[1]], grain),
        }
    }

    fn beside_line<P: Place>(&self, [from, to]: [P; 2], grain: Approach<P>) -> Option<Beside<P>> {
        let Approach { place, radius, came, reach } = grain;
        let along = to - from;
        let squared = along.dot_product(along);
        let share = if squared > 0.0 { (place - from).dot_product(along) / squared } else { 0.0 };
        let between = place - (from + along * share.clamp(0.0, 1.0));
        let touching = radius + self.radius_m;
        // Most are too far: no square root for them.
        if between.dot_product(between) > (touching + reach) * (touching + reach) {
            return None;
        }
        let distance = between.length();
        let end = if share <= 0.0 { Some(0) } else { (share >= 1.0).then_some(1) };
        // A rod in space has no sides: its normal is the way from its axis.
        let line = (squared > 0.0 && P::LEN == 2).then(|| {
            let length = squared.sqrt();
            let upwards = P::of([-along[1], along[0], 0.0]) / length;
            let height = upwards.dot_product(place - from);
            let before = height - upwards.dot_product(came);
            let room = PASSED * touching / length;
            let passed = is_within(room, share - came.dot_product(along) / squared, share, before, height);
            let above = is_above(passed, before, height);
            (if above { upwards } else { -upwards }, passed)
        });
        let from_axis = || if distance > 0.0 { between / distance } else { P::of([0.0, 1.0, 0.0]) };
        let none = || if P::LEN > 2 { from_axis() } else { P::ZERO };
        let (normal, passed) = line.unwrap_or_else(|| (none(), false));
        let gap = if passed { -distance } else { distance } - touching;
        let end = end.filter(|_| !passed).map(End::Of);
        (gap <= reach).then_some(Beside { end, between, distance, normal, touching, gap })
    }

    fn beside_polygon<P: Place>(&self, corners: &[P], grain: Approach<P>) -> Option<Beside<P>> {
        let Approach { place, radius, came, reach } = grain;
        let touching = radius + self.radius_m;
        let upwards = P::of(area(corners).normalize().into());
        let height = upwards.dot_product(place - corners[0]);
        let before = height - upwards.dot_product(came);
        // Most are too far: the rest is for the few that are near its plane, or cross it.
        if height.abs() > touching + reach && before * height > 0.0 {
            return None;
        }
        let foot = place - upwards * height;
        let (nearest, end) = nearest_of(corners, upwards, foot);
        let between = place - nearest;
        let distance = between.length();
        let crossing = || {
            let there = foot - (came - upwards * came.dot_product(upwards)) * (height / (height - before));
            (there - nearest_of(corners, upwards, there).0).length() <= PASSED * touching
        };
        let passed = before * height <= 0.0 && before != height && crossing();
        let normal = if is_above(passed, before, height) { upwards } else { -upwards };
        let gap = if passed { -distance } else { distance } - touching;
        let end = end.filter(|_| !passed);
        (gap <= reach).then_some(Beside { end, between, distance, normal, touching, gap })
    }

    fn beside_hollow<P: Place>(&self, [from, to]: [P; 2], grain: Approach<P>) -> Option<Beside<P>> {
        let Approach { place, radius, came, reach } = grain;
        let along = to - from;
        let length = along.length();
        let axis = along / length;
        let polar = |there: P| {
            let height = axis.dot_product(there - from);
            let across = there - from - axis * height;
            (height, across, across.length())
        };
        let (height, across, distance) = polar(place);
        let (before, _, distance_before) = polar(place - came);
        let out = if distance > 0.0 { across / distance } else { any_across(axis) };
        let level = height.clamp(0.0, length);
        let between = place - (from + axis * level + out * self.radius_m);
        let to_surface = between.length();
        let [was_inside, is_inside] = [distance_before, distance].map(|distance| distance < self.radius_m);
        let room = PASSED * radius;
        let is_between = |height: f64| (-room..=length + room).contains(&height);
        let passed = was_inside != is_inside && is_between(before) && is_between(height);
        let inside = if passed { was_inside } else { is_inside };
        let normal = if inside { -out } else { out };
        let gap = if passed { -to_surface } else { to_surface } - radius;
        let end = (height != level && !passed).then_some(End::Rim);
        (gap <= reach).then_some(Beside { end, between, distance: to_surface, normal, touching: radius, gap })
    }
}

/// Reports whether a grain is on the upper side of a line or a plane: where it came from if it has passed, else where it is.
fn is_above(passed: bool, before: f64, height: f64) -> bool {
    if passed && before != 0.0 { before > 0.0 } else { (height >= 0.0) != passed }
}

/// Returns a unit vector across an axis (–).
fn any_across<P: Place>(axis: P) -> P {
    P::of(contact::frame(&Vector3::from(axis.space()))[0].into())
}

/// Returns the point of a convex polygon with this unit normal that is nearest to a place in its plane (m), and the part of the boundary
/// on which it is, if the place is outside.
pub(crate) fn nearest_of<P: Place>(corners: &[P], upwards: P, place: P) -> (P, Option<End>) {
    let mut nearest: Option<(f64, P, End)> = None;
    for (k, corner) in corners.iter().enumerate() {
        let edge = corners[(k + 1) % corners.len()] - *corner;
        let outwards = P::of(Vector3::from(edge.space()).cross(&Vector3::from(upwards.space())).into());
        if outwards.dot_product(place - *corner) <= 0.0 {
            continue;
        }
        let share = (place - *corner).dot_product(edge) / edge.dot_product(edge);
        let end = if (0.0..=1.0).contains(&share) { End::Edge } else { End::Corner };
        let there = *corner + edge * share.clamp(0.0, 1.0);
        let distance = (place - there).length();
        if nearest.as_ref().is_none_or(|(least, ..)| distance < *least) {
            nearest = Some((distance, there, end));
        }
    }
    nearest.map_or((place, None), |(_, there, end)| (there, Some(end)))
}

/// Returns the way from a place in the plane of a polygon to its middle (m).
pub(crate) fn inwards<P: Place>(corners: &[P], place: P) -> P {
    centroid(corners) - place
}
