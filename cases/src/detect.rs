//! Neighbours and gaps: which grains and walls are close, on a grid of cells, in time linear in the number of grains.

pub(crate) mod extent;
pub(crate) mod periodic;

use crate::detect::periodic::Period;
use contact::{Groups, Place};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The share of the smaller radius by which two grains may overlap at first (–): what another code left of its contacts.
pub(crate) const OVERLAP: f64 = 0.1;

/// A rigid disc or sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain<P = Vector2<f64>> {
    /// Radius (m).
    pub radius: f64,
    /// Mass (kg).
    pub mass: f64,
    /// Centre (m).
    pub position: P,
    /// Velocity along x, y and z (m/s), and spin about them (rad/s), beside those that the scene gives.
    pub motion: [f64; 6],
}

/// The antagonist of a detected contact. Its order is that of the contacts of one candidate in a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The floor.
    Floor,
    /// The wall at the left.
    Left,
    /// The wall at the right.
    Right,
    /// The wall behind, at z = 0; in space only.
    Back,
    /// The wall before, towards the viewer.
    Front,
    /// The drum.
    Drum,
    /// A bump of the floor, numbered from its foot towards +x and, in space, +z.
    Bump([i32; 2]),
    /// A segment, by its place in the scene's list.
    Segment(u32),
    /// Another grain, of higher index.
    Grain(u32),
    /// The lid, by its index among the bodies, and the bump of it, if it has some.
    Lid(u32, i32),
    /// A segment that a force drives, by its index among the bodies, and its place in the scene's list.
    Driven(u32, u32),
    /// One of the two guides of such a segment.
    Guide(u32),
}

/// The walls of a box, in the order of its contacts; the last two are in space only.
pub(crate) const WALLS: [Side; 5] = [Side::Floor, Side::Left, Side::Right, Side::Back, Side::Front];

/// A pair that is close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectedContact<P = Vector2<f64>> {
    /// The candidate grain.
    pub candidate: u32,
    /// The antagonist.
    pub antagonist: Side,
    /// Unit normal from antagonist to candidate (–).
    pub normal: P,
    /// Distance between the surfaces (m); negative where they overlap.
    pub gap: f64,
}

/// Returns all pairs of grains with a gap of at most `reach` (m), ordered by candidate, then antagonist.
///
/// The cost is linear in the number of grains as long as they fill the box around them and the largest is not much
/// larger than the others.
pub fn detect<P: Place>(position: &[P], radius: &[f64], reach: f64) -> Vec<DetectedContact<P>> {
    let mut contacts = Vec::new();
    for_each_close(position, radius, reach, Period(None), |_, _, contact| contacts.push(contact));
    contacts
}

/// The contact of two grains with a gap of at most `reach` (m).
#[inline]
fn close<P: Place>(
    position: &[P],
    radius: &[f64],
    reach: f64,
    period: Period,
    [i, j]: [u32; 2],
) -> Option<DetectedContact<P>> {
    let [(x, r), (other, s)] = [i, j].map(|k| (position[k as usize], radius[k as usize]));
    let between = period.nearest(x - other);
    let contact_distance = r + s;
    // Most pairs are too far: no square root for them.
    let farthest = contact_distance + reach;
    if between.dot_product(between) > farthest * farthest {
        return None;
    }
    let distance = between.length();
    // Two centres in one place have no normal; any will push them apart.
    let normal = if distance > 0.0 { between / distance } else { P::of([1.0, 0.0, 0.0]) };
    let gap = distance - contact_distance;
    Some(DetectedContact { candidate: i, antagonist: Side::Grain(j), normal, gap })
}

/// The pairs of discs that are close, kept from one time step to the next: they are sought anew where discs have moved so far
/// that others may be close. The contacts are those of [`detect`], bit by bit.
#[derive(Clone, Debug)]
pub(crate) struct Neighbours<P> {
    /// Positions of the grains at the last search for pairs (m).
    sought_at: Vec<P>,
    /// The gap to which they were sought (m).
    sought_to: f64,
    /// Candidate and antagonist, rising.
    pairs: Vec<[u32; 2]>,
    /// Number of searches.
    searches: u64,
}

/// Margin by which a search exceeds the reach asked for, over the greatest radius (–): in the shear box, one search per eighteen
/// time steps, with an eighth more pairs than asked for.
const MARGIN: f64 = 0.2;

impl<P> Default for Neighbours<P> {
    fn default() -> Self {
        Self { sought_at: Vec::new(), sought_to: 0.0, pairs: Vec::new(), searches: 0 }
    }
}

impl<P: Place> Neighbours<P> {
    /// The contacts of [`detect`], through periodic sides too; the discs, their radii and the sides are the same at each call.
    pub(crate) fn contacts(
        &mut self,
        position: &[P],
        radius: &[f64],
        reach: f64,
        period: Period,
    ) -> Vec<DetectedContact<P>> {
        if !self.hold(position, reach, period) {
            self.sought_to = reach + MARGIN * radius.iter().copied().fold(0.0, f64::max);
            self.sought_at.clear();
            self.sought_at.extend_from_slice(position);
            self.pairs.clear();
            for_each_close(position, radius, self.sought_to, period, |i, j, _| self.pairs.push([i, j]));
            self.searches += 1;
        }
        self.pairs.iter().filter_map(|pair| close(position, radius, reach, period, *pair)).collect()
    }

    /// Reports whether the pairs still include all within `reach` (m): no grain has moved by half the margin since the search.
    fn hold(&self, position: &[P], reach: f64, period: Period) -> bool {
        // Less than half of what is left, by far more than round-off.
        let room = 0.5 * (0.999 * self.sought_to - reach);
        let near = |(then, now): (&P, &P)| {
            let moved = period.nearest(*now - *then);
            moved.dot_product(moved) < room * room
        };
        room > 0.0 && self.sought_at.len() == position.len() && self.sought_at.iter().zip(position).all(near)
    }
}

/// Calls `visit` with every pair of discs with a gap of at most `reach` (m), by rising candidate, then antagonist, and with
/// their contact.
fn for_each_close<P: Place>(
    position: &[P],
    radius: &[f64],
    reach: f64,
    period: Period,
    mut visit: impl FnMut(u32, u32, DetectedContact<P>),
) {
    let cells = Cells::new(position, 2.0 * radius.iter().copied().fold(0.0, f64::max) + reach, period);
    let mut near = Vec::new();
    for (i, x) in (0_u32..).zip(position) {
        near.clear();
        cells.for_each_near(*x, |j| {
            if j > i {
                near.extend(close(position, radius, reach, period, [i, j]).map(|contact| (j, contact)));
            }
        });
        near.sort_unstable_by_key(|(j, _)| *j);
        for (j, contact) in &near {
            visit(i, *j, *contact);
        }
    }
}

/// Grains sorted into cells as wide as they are high and deep.
struct Cells<P> {
    low: P,
    /// Size along each axis (m).
    size: [f64; 3],
    period: Period,
    /// Columns, rows and, in space, layers.
    counts: [usize; 3],
    /// Grains by cell, row after row and layer after layer.
    grains: Groups,
}

impl<P: Place> Cells<P> {
    /// Cells of at least `size` (m).
    fn new(position: &[P], size: f64, period: Period) -> Self {
        let [mut low, mut high] = P::extent(position.iter().copied());
        if let Some(width) = period.0 {
            low += P::of([-low[0], 0.0, 0.0]);
            high += P::of([width - high[0], 0.0, 0.0]);
        }
        let extent = (high - low).space().map(|extent| extent.max(size));
        // A grain that flies far away must not make an endless grid of empty cells.
        let most = 4.0 * position.len() as f64 + 16.0;
        let size = size.max(least_size(&extent[..P::LEN], most));
        let mut counts: [usize; 3] =
            std::array::from_fn(|axis| if axis < P::LEN { (extent[axis] / size) as usize + 1 } else { 1 });
        let mut size = [size; 3];
        if let Some(width) = period.0 {
            // The last column ends where the first begins.
            counts[0] = ((width / size[0]) as usize).max(1);
            size[0] = width / counts[0] as f64;
        }
        let mut cells = Self { low, size, period, counts, grains: Groups::default() };
        let cell: Vec<usize> = position.iter().map(|x| cells.number(cells.cell(*x))).collect();
        cells.grains = Groups::new((0_u32..).zip(cell.iter().copied()), counts.iter().product());
        cells
    }

    fn cell(&self, position: P) -> [usize; 3] {
        let x = (self.period.wrapped(position) - self.low).space();
        std::array::from_fn(|axis| ((x[axis] / self.size[axis]) as usize).min(self.counts[axis] - 1))
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        x + self.counts[0] * (y + self.counts[1] * z)
    }

    /// Calls `visit` with every grain in the cell of `position` and in the cells around it.
    fn for_each_near(&self, position: P, mut visit: impl FnMut(u32)) {
        let cell = self.cell(position);
        let first = cell.map(|k| k.saturating_sub(1));
        let last: [usize; 3] = std::array::from_fn(|axis| (cell[axis] + 1).min(self.counts[axis] - 1));
        let beyond = self.beyond(cell[0]);
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                // The cells of a row lie one after the other.
                let row = self.number([first[0], y, z])..self.number([last[0], y, z]) + 1;
                self.grains.of(row).iter().for_each(|grain| visit(*grain));
                if let Some(column) = beyond {
                    let cell = self.number([column, y, z]);
                    self.grains.of(cell..cell + 1).iter().for_each(|grain| visit(*grain));
                }
            }
        }
    }

    /// The column at the other end that is beside this one, if sides are periodic and it is no neighbour anyway.
    fn beyond(&self, column: usize) -> Option<usize> {
        let last = self.counts[0] - 1;
        let other = if column == 0 { last } else { 0 };
        (self.period.0.is_some() && (column == 0 || column == last) && last > 1).then_some(other)
    }
}

/// The least size of cells of which no more than about `most` fill a box of this `extent`, nor the box's edges (m).
fn least_size(extent: &[f64], most: f64) -> f64 {
    let volume: f64 = extent.iter().product();
    let root = if extent.len() == 2 { (volume / most).sqrt() } else { (volume / most).cbrt() };
    let longest = extent.iter().copied().fold(0.0, f64::max);
    let faces = extent.iter().map(|edge| (volume / edge / most).sqrt()).fold(0.0, f64::max);
    let faces = if extent.len() == 2 { 0.0 } else { faces };
    root.max(faces).max(longest / most)
}

#[cfg(test)]
mod tests;
