//! The front of a deposit, by columns of the box, and the places that it holds.

use nalgebra::Vector2;

/// Centre and radius of a disc before it is in its scene (m).
pub type Disc = (Vector2<f64>, f64);

/// Place that can hold a disc.
pub(super) struct Place {
    pub(super) at: Vector2<f64>,
    /// The disc of the front that holds it at the left; `None` for the wall.
    pub(super) left: Option<u32>,
    /// That at the right.
    pub(super) right: Option<u32>,
}

/// Discs laid so far, and the front among them.
pub(super) struct Front {
    pub(super) width: f64,
    /// Greatest radius (m).
    greatest: f64,
    /// Width of a column: at least the greatest diameter, so that a disc reaches into the next column, not further.
    size: f64,
    pub(super) discs: Vec<Disc>,
    /// First of the chain.
    pub(super) first: Option<u32>,
    /// Successor of each disc in the chain.
    pub(super) after: Vec<Option<u32>>,
    /// The discs of the chain by column.
    columns: Vec<Vec<u32>>,
    /// Number of changes of the front within reach of each column.
    pub(super) changes: Vec<u32>,
}

impl Front {
    /// Returns the empty front of discs with the given radii (m), in a box of `width` (m).
    pub(super) fn new(width: f64, radii: &[f64]) -> Self {
        let greatest = radii.iter().copied().fold(0.0, f64::max);
        let count = ((width / (2.0 * greatest)) as usize).min(radii.len()).max(1);
        Self {
            width,
            greatest,
            size: width / count as f64,
            discs: Vec::new(),
            first: None,
            after: Vec::new(),
            columns: vec![Vec::new(); count],
            changes: vec![0; count],
        }
    }

    /// Number of columns.
    pub(super) fn columns(&self) -> usize {
        self.columns.len()
    }

    fn column(&self, x: f64) -> usize {
        ((x / self.size) as usize).min(self.columns() - 1)
    }

    /// The column with those beside it.
    fn around(&self, column: usize) -> std::ops::Range<usize> {
        column.saturating_sub(1)..(column + 2).min(self.columns())
    }

    /// The discs of the front that a disc in this column can touch.
    fn near(&self, column: usize) -> impl Iterator<Item = u32> {
        self.columns[self.around(column)].iter().flatten().copied()
    }

    /// Round-off of a place on two discs, in the units of the box (m).
    pub(super) fn slack(&self) -> f64 {
        1e-12 * self.width
    }

    /// Returns the place of the next disc on the floor (m), while all others lie there, and which it touches; `None` for the wall.
    /// A small disc may lie below a large one, so the last is not always the one.
    pub(super) fn beside_on_floor(&self, radius: f64) -> (f64, Option<u32>) {
        let mut next = (radius, None);
        for (k, (centre, r)) in self.discs.iter().enumerate().rev() {
            // Both on the floor: (R + r)² = (R − r)² + Δx²
            let x = centre.x + 2.0 * (r * radius).sqrt();
            if x > next.0 {
                next = (x, Some(k as u32));
            }
            if centre.x + 2.0 * (self.greatest * radius).sqrt() <= next.0 {
                break;
            }
        }
        next
    }

    /// Lays a disc, and takes what it covers from the front.
    pub(super) fn lay(&mut self, place: &Place, radius: f64) -> u32 {
        let disc = self.discs.len() as u32;
        let mut covered = place.left.map_or(self.first, |left| self.after[left as usize]);
        while let Some(other) = covered.filter(|_| covered != place.right) {
            let column = self.column(self.discs[other as usize].0.x);
            self.columns[column].retain(|k| *k != other);
            covered = self.after[other as usize];
        }
        match place.left {
            Some(left) => self.after[left as usize] = Some(disc),
            None => self.first = Some(disc),
        }
        let column = self.column(place.at.x);
        self.discs.push((place.at, radius));
        self.after.push(place.right);
        self.columns[column].push(disc);
        for near in self.around(column) {
            self.changes[near] += 1;
        }
        disc
    }

    /// Takes for `best` the lowest place of a disc in the column, if it is lower.
    pub(super) fn lower_place(&self, column: usize, radius: f64, best: &mut Option<Place>) {
        let take = |best: &mut Option<Place>, at: Option<Vector2<f64>>, left, right| {
            let lower = |at: &Vector2<f64>| {
                best.as_ref().is_none_or(|best| (at.y, at.x) < (best.at.y, best.at.x))
                    && self.column(at.x) == column
                    && self.fits(self.near(column), *at, radius)
            };
            if let Some(at) = at.filter(lower) {
                *best = Some(Place { at, left, right });
            }
        };
        let bound =
            |best: &Option<Place>| best.as_ref().map_or(f64::INFINITY, |best| best.at.y + self.slack());
        let start = column as f64 * self.size - self.slack();
        let [by_left, by_right] = [radius, self.width - radius].map(|x| self.column(x) == column);
        for k in self.near(column) {
            let held = self.discs[k as usize];
            // No place is lower than the lower of the discs that hold it.
            if by_left && held.0.y <= bound(best) {
                take(best, beside_wall(held, radius, radius), None, Some(k));
            }
            if by_right && held.0.y <= bound(best) {
                take(best, beside_wall(held, self.width - radius, radius), Some(k), None);
            }
            let mut ahead = self.after[k as usize].filter(|_| self.column(held.0.x) <= column);
            while let Some(o) = ahead {
                let other = self.discs[o as usize];
                // The chain winds, but beyond this the new disc touches none.
                if other.0.x - held.0.x > held.1 + 2.0 * radius + self.greatest {
                    break;
                }
                // The place is between the two, and in the column.
                let right = other.0.x >= held.0.x.max(start);
                if right && held.0.y.min(other.0.y) <= bound(best) {
                    take(best, on_two(held, other, radius), Some(k), Some(o));
                }
                ahead = self.after[o as usize];
            }
        }
    }

    /// Reports whether a disc fits at a place and can reach it from above, past those that are `near`.
    pub(super) fn fits(&self, mut near: impl Iterator<Item = u32>, place: Vector2<f64>, radius: f64) -> bool {
        let slack = self.slack();
        let inside =
            place.x >= radius - slack && place.x <= self.width - radius + slack && place.y >= radius - slack;
        let below_or_aside = |k: u32| {
            let (centre, r) = self.discs[k as usize];
            let between = place - centre;
            // Much of the front is aside: no square root for it.
            if between.x.abs() >= r + radius {
                return true;
            }
            let apart = between.norm() >= r + radius - slack;
            apart && (between.y >= 0.0 || between.x.abs() >= r + radius - slack)
        };
        inside && near.all(below_or_aside)
    }

    /// Returns a lower bound of the height of the centre of a disc that comes from above, anywhere in the column (m).
    ///
    /// Each disc of the front bounds its height by an arc. Arcs are concave, so the height is lowest where two arcs meet,
    /// right beside the end of one, or at an end of the column.
    pub(super) fn lowest_height(&self, column: usize, radius: f64) -> f64 {
        let mut lowest = None;
        self.lower_place(column, radius, &mut lowest);
        let [start, end] = [column as f64 * self.size, (column + 1) as f64 * self.size];
        let mut lowest = lowest.map_or(f64::INFINITY, |place| place.at.y);
        // Takes the height at x, if it is lower.
        let mut lower = |x: f64| {
            let x = x.clamp(radius, self.width - radius);
            let mut height = radius;
            for k in self.near(column) {
                let (centre, r) = self.discs[k as usize];
                // Without the arcs that end here.
                let (distance, across) = (r + radius, (x - centre.x).abs());
                if across < distance - self.slack() {
                    height = height.max(centre.y + (distance * distance - across * across).sqrt());
                    if height >= lowest {
                        return;
                    }
                }
            }
            lowest = height;
        };
        lower(start);
        lower(end);
        for k in self.near(column) {
            let (centre, r) = self.discs[k as usize];
            let ends = [centre.x - r - radius, centre.x + r + radius];
            ends.into_iter().filter(|x| start <= *x && *x <= end).for_each(&mut lower);
        }
        lowest
    }
}

/// Place against a wall, with the centre at `x`, and on one disc.
pub(super) fn beside_wall((centre, r): Disc, x: f64, radius: f64) -> Option<Vector2<f64>> {
    let (distance, across) = (r + radius, centre.x - x);
    let height = distance * distance - across * across;
    (height >= 0.0).then(|| Vector2::new(x, centre.y + height.sqrt()))
}

/// Place on two discs, between them.
pub(super) fn on_two((left, r_left): Disc, (right, r_right): Disc, radius: f64) -> Option<Vector2<f64>> {
    let (to_left, to_right) = (r_left + radius, r_right + radius);
    let between = right - left;
    let distance = between.norm();
    let along = (to_left * to_left - to_right * to_right + distance * distance) / (2.0 * distance);
    let height = to_left * to_left - along * along;
    if !(height >= 0.0) {
        return None;
    }
    let axis = between / distance;
    let place = left + axis * along + Vector2::new(-axis.y, axis.x) * height.sqrt();
    (left.x <= place.x && place.x <= right.x).then_some(place)
}
