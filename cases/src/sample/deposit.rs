//! Discs laid one by one at the lowest place where two others, or one and a wall, hold it.
//!
//! The discs that can still be touched from above form the front, a chain from wall to wall in which each disc touches
//! the next. A new disc replaces what it covers of the chain.
//!
//! The front is searched by columns of the box, the one that promises the lowest place first. What a column promises is the
//! least height at which a smaller disc fitted there once. It stays true: the front only rises; and a disc that is larger by d
//! lies higher by at least d, since the smaller one fits into it, bottom to bottom. So a few columns are looked at for each disc,
//! some ten in a box of a thousand columns, the lowest promise first.

mod front;
mod heights;
mod seam;
mod spheres;

use front::{Front, Place};
use heights::Heights;
use nalgebra::Vector2;

pub use front::Disc;
pub(crate) use seam::Seam;
pub(crate) use spheres::deposit_spheres;

/// Centres and radii (m) of discs with the given radii, in a box of `width` (m) with a floor at y = 0; `Err` is the
/// radius of a disc that no place holds.
pub(crate) fn deposit(radii: &[f64], width: f64) -> Result<Vec<Disc>, f64> {
    laid(radii, width).map(|(front, _)| front.discs)
}

/// The front and the promises when all discs are laid.
fn laid(radii: &[f64], width: f64) -> Result<(Front, Promises), f64> {
    let mut front = Front::new(width, radii);
    let mut promises = Promises::new(radii, front.columns());
    let mut on_floor = true;
    for &radius in radii {
        if on_floor {
            let (x, left) = front.beside_on_floor(radius);
            on_floor = x + radius <= width;
            if on_floor {
                front.lay(&Place { at: Vector2::new(x, radius), left, right: None }, radius);
                continue;
            }
        }
        let place = promises.lowest_place(&front, radius).ok_or(radius)?;
        front.lay(&place, radius);
    }
    Ok((front, promises))
}

/// Classes of radius, so many that a promise is close.
const CLASSES: usize = 8;

/// Promises of each column to each class of radius: lower bounds of the height.
struct Promises {
    /// The least radius of each class, rising.
    radius: Vec<f64>,
    /// Heights by class and column (m): no disc of the least radius lies lower.
    height: Vec<Heights>,
    /// The changes of the column when the promise was made.
    made: Vec<Vec<Option<u32>>>,
    /// Number of times that a column was examined.
    looks: u64,
}

impl Promises {
    /// Classes of about as many discs each; nothing is promised.
    fn new(radii: &[f64], columns: usize) -> Self {
        let mut rising = radii.to_vec();
        rising.sort_by(f64::total_cmp);
        let mut radius: Vec<f64> =
            rising.chunks(radii.len().div_ceil(CLASSES).max(1)).map(|class| class[0]).collect();
        radius.dedup();
        Self {
            height: vec![Heights::new(columns); radius.len()],
            made: vec![vec![None; columns]; radius.len()],
            looks: 0,
            radius,
        }
    }

    /// The lowest place of a disc on the front; of places as low, that at the left.
    fn lowest_place(&mut self, front: &Front, radius: f64) -> Option<Place> {
        let class = self.radius.partition_point(|least| *least <= radius) - 1;
        let larger = radius - self.radius[class];
        let (mut best, mut seen): (Option<Place>, Vec<(usize, f64)>) = (None, Vec::new());
        while let Some((column, promised)) = self.height[class].lowest() {
            let too_high = |best: &Place| promised + larger > best.at.y + front.slack();
            if promised == f64::INFINITY || best.as_ref().is_some_and(too_high) {
                break;
            }
            self.looks += 1;
            let out_of_date = |class: &usize| self.made[*class][column] != Some(front.changes[column]);
            if let Some(class) = [0, class].into_iter().find(out_of_date) {
                self.promise(front, column, class);
            } else {
                front.lower_place(column, radius, &mut best);
                seen.push((column, promised));
                self.height[class].set(column, f64::INFINITY);
            }
        }
        for (column, promised) in seen {
            self.height[class].set(column, promised);
        }
        best
    }

    /// Finds how low a disc of the class can be in the column, which promises something to larger ones too.
    fn promise(&mut self, front: &Front, column: usize, class: usize) {
        let lowest = front.lowest_height(column, self.radius[class]);
        self.made[class][column] = Some(front.changes[column]);
        for (height, radius) in self.height.iter_mut().zip(&self.radius).skip(class) {
            height.raise(column, lowest + (radius - self.radius[class]));
        }
    }
}

#[cfg(test)]
mod tests;
