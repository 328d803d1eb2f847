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
    let cells = Cells::new(position, 2.0 * radius.iter().copied().fold(0.0, f64::max) + reach);
    let mut contacts = Vec::new();
    let mut near = Vec::new();
    for (i, (x, r)) in position.iter().zip(radius).enumerate() {
        near.clear();
        cells.for_each_near(*x, |j| {
            if j as usize <= i {
                return;
            }
            let between = x - position[j as usize];
            let contact_distance = r + radius[j as usize];
            // Most pairs are too far: no square root for them.
            let farthest = contact_distance + reach;
            if between.norm_squared() > farthest * farthest {
                return;
            }
            let distance = between.norm();
            // Two centres in one place have no normal; any will push them apart.
            let normal = if distance > 0.0 { between / distance } else { Vector2::x() };
            near.push(DetectedContact {
                candidate: i as u32,
                antagonist: Side::Grain(j),
                normal,
                gap: distance - contact_distance,
            });
        });
        near.sort_unstable_by_key(|contact| contact.antagonist);
        contacts.extend_from_slice(&near);
    }
    contacts
}

/// The contacts of one disc with the walls that are within `reach` (m), and the rate at which each opens its gap (m/s).
pub(crate) fn walls_near(
    walls: &[Option<MovingWall>; 3],
    grain: u32,
    position: Vector2<f64>,
    radius: f64,
    reach: f64,
) -> impl Iterator<Item = (DetectedContact, f64)> {
    [Side::Floor, Side::Left, Side::Right].into_iter().zip(*walls).filter_map(move |(side, wall)| {
        let wall = wall?;
        let gap = wall.now.gap(position, radius);
        let normal = wall.now.normal;
        let contact = DetectedContact { candidate: grain, antagonist: side, normal, gap };
        (gap <= reach).then_some((contact, wall.opening_rate(position)))
    })
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
