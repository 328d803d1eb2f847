//! Neighbours and gaps: which discs and walls are close, on a grid of cells, in time linear in the number of grains.

use crate::scene::MovingWall;
use contact::Groups;
use nalgebra::Vector2;

/// The antagonist of a detected contact. Its order is that of the contacts of one candidate in a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// The floor.
    Floor,
    /// The wall at the left.
    Left,
    /// The wall at the right.
    Right,
    /// The drum.
    Drum,
    /// A bump of the floor, numbered from its foot towards +x.
    Bump(i32),
    /// Another grain, of higher index.
    Grain(u32),
}

/// A pair that is close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectedContact {
    /// The candidate grain.
    pub candidate: u32,
    /// The antagonist.
    pub antagonist: Side,
    /// Unit normal from antagonist to candidate (–).
    pub normal: Vector2<f64>,
    /// Distance between the surfaces (m); negative where they overlap.
    pub gap: f64,
}

/// All pairs of discs with a gap of at most `reach` (m), ordered by candidate, then antagonist.
///
/// The cost is linear in the number of discs as long as they fill the box around them and the largest is not much
/// larger than the others.
pub fn detect(position: &[Vector2<f64>], radius: &[f64], reach: f64) -> Vec<DetectedContact> {
    let mut contacts = Vec::new();
    for_each_close(position, radius, reach, |_, _, contact| contacts.push(contact));
    contacts
}

/// The contact of two discs with a gap of at most `reach` (m).
#[inline]
fn close(position: &[Vector2<f64>], radius: &[f64], reach: f64, [i, j]: [u32; 2]) -> Option<DetectedContact> {
    let [(x, r), (other, s)] = [i, j].map(|k| (position[k as usize], radius[k as usize]));
    let between = x - other;
    let contact_distance = r + s;
    // Most pairs are too far: no square root for them.
    let farthest = contact_distance + reach;
    if between.norm_squared() > farthest * farthest {
        return None;
    }
    let distance = between.norm();
    // Two centres in one place have no normal; any will push them apart.
    let normal = if distance > 0.0 { between / distance } else { Vector2::x() };
    let gap = distance - contact_distance;
    Some(DetectedContact { candidate: i, antagonist: Side::Grain(j), normal, gap })
}

/// The pairs of discs that are close, kept from one time step to the next: they are sought anew where discs have moved so far
/// that others may be close. The contacts are those of [`detect`], bit by bit.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbours {
    /// Where the discs were when the pairs were sought (m).
    sought_at: Vec<Vector2<f64>>,
    /// The gap to which they were sought (m).
    sought_to: f64,
    /// Candidate and antagonist, rising.
    pairs: Vec<[u32; 2]>,
    /// How often they were sought.
    searches: u64,
}

/// How much farther than asked pairs are sought, in greatest radii (–): in the shear box a search for eighteen time steps, with
/// an eighth of the pairs more than are asked for.
const MARGIN: f64 = 0.2;

impl Neighbours {
    /// The contacts of [`detect`]; the discs and their radii are the same at each call.
    pub(crate) fn contacts(
        &mut self,
        position: &[Vector2<f64>],
        radius: &[f64],
        reach: f64,
    ) -> Vec<DetectedContact> {
        if !self.hold(position, reach) {
            self.sought_to = reach + MARGIN * radius.iter().copied().fold(0.0, f64::max);
            self.sought_at.clear();
            self.sought_at.extend_from_slice(position);
            self.pairs.clear();
            for_each_close(position, radius, self.sought_to, |i, j, _| self.pairs.push([i, j]));
            self.searches += 1;
        }
        self.pairs.iter().filter_map(|pair| close(position, radius, reach, *pair)).collect()
    }

    /// Whether no other pair can be close: each of two discs has come nearer by what it has moved.
    fn hold(&self, position: &[Vector2<f64>], reach: f64) -> bool {
        // Less than half of what is left, by far more than round-off.
        let room = 0.5 * (0.999 * self.sought_to - reach);
        let near = |(then, now): (&Vector2<f64>, &Vector2<f64>)| (now - then).norm_squared() < room * room;
        room > 0.0 && self.sought_at.len() == position.len() && self.sought_at.iter().zip(position).all(near)
    }
}

/// The contacts of one disc with the walls that are within `reach` (m), and what the motion of each adds to
/// the relative velocity: the rate at which it opens the gap, and minus that at which it slides (m/s).
pub(crate) fn walls_near(
    walls: &[Option<MovingWall>; 3],
    grain: u32,
    position: Vector2<f64>,
    radius: f64,
    reach: f64,
) -> impl Iterator<Item = (DetectedContact, [f64; 2])> {
    [Side::Floor, Side::Left, Side::Right].into_iter().zip(*walls).filter_map(move |(side, wall)| {
        let wall = wall?;
        let gap = wall.now.gap(position, radius);
        let normal = wall.now.normal;
        let contact = DetectedContact { candidate: grain, antagonist: side, normal, gap };
        (gap <= reach).then(|| (contact, [wall.opening_rate(position), -wall.sliding_rate()]))
    })
}

/// Calls `visit` with every pair of discs with a gap of at most `reach` (m), by rising candidate, then antagonist, and with
/// their contact.
fn for_each_close(
    position: &[Vector2<f64>],
    radius: &[f64],
    reach: f64,
    mut visit: impl FnMut(u32, u32, DetectedContact),
) {
    let cells = Cells::new(position, 2.0 * radius.iter().copied().fold(0.0, f64::max) + reach);
    let mut near = Vec::new();
    for (i, x) in (0_u32..).zip(position) {
        near.clear();
        cells.for_each_near(*x, |j| {
            if j > i {
                near.extend(close(position, radius, reach, [i, j]).map(|contact| (j, contact)));
            }
        });
        near.sort_unstable_by_key(|(j, _)| *j);
        for (j, contact) in &near {
            visit(i, *j, *contact);
        }
    }
}

/// Discs sorted into square cells.
struct Cells {
    low: Vector2<f64>,
    size: f64,
    columns: usize,
    rows: usize,
    /// By cell, row after row.
    grains: Groups,
}

impl Cells {
    /// Cells of at least `size` (m).
    fn new(position: &[Vector2<f64>], size: f64) -> Self {
        let low = position.iter().fold(Vector2::repeat(f64::INFINITY), |low, x| low.inf(x));
        let high = position.iter().fold(Vector2::repeat(f64::NEG_INFINITY), |high, x| high.sup(x));
        let extent = (high - low).sup(&Vector2::repeat(size));
        // A grain that flies far away must not make an endless grid of empty cells.
        let most = 4.0 * position.len() as f64 + 16.0;
        let size = size.max((extent.x * extent.y / most).sqrt()).max(extent.max() / most);
        let count = |extent: f64| (extent / size) as usize + 1;
        let (columns, rows) = (count(extent.x), count(extent.y));
        let mut cells = Self { low, size, columns, rows, grains: Groups::default() };
        let cell: Vec<usize> =
            position.iter().map(|x| cells.cell(*x)).map(|(x, y)| x + columns * y).collect();
        cells.grains = Groups::new((0_u32..).zip(cell.iter().copied()), columns * rows);
        cells
    }

    fn cell(&self, position: Vector2<f64>) -> (usize, usize) {
        let x = (position - self.low) / self.size;
        ((x.x as usize).min(self.columns - 1), (x.y as usize).min(self.rows - 1))
    }

    /// Calls `visit` with every grain in the cell of `position` and in the cells around it.
    fn for_each_near(&self, position: Vector2<f64>, mut visit: impl FnMut(u32)) {
        let (x, y) = self.cell(position);
        for row in y.saturating_sub(1)..=(y + 1).min(self.rows - 1) {
            // The cells of a row lie one after the other.
            let first = x.saturating_sub(1) + self.columns * row;
            let last = (x + 1).min(self.columns - 1) + self.columns * row;
            self.grains.of(first..last + 1).iter().for_each(|grain| visit(*grain));
        }
    }
}

#[cfg(test)]
mod tests;
