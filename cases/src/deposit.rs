//! Discs laid one by one at the lowest place where two others, or one and a wall, hold it.
//!
//! The discs that can still be touched from above form the front, a chain from wall to wall in which each disc touches
//! the next. A new disc replaces what it covers of the chain.
//!
//! The front is searched by columns of the box, the one that promises the lowest place first. What a column promises is the
//! least height at which a smaller disc fitted there once. It stays true: the front only rises; and a disc that is larger by d
//! lies higher by at least d, since the smaller one fits into it, bottom to bottom. So a few columns are looked at for each disc,
//! however wide the box.

mod front;

use front::{Front, Place, Placed};
use nalgebra::Vector2;

/// Centres and radii (m) of discs with the given radii, in a box of `width` (m) with a floor at y = 0; `Err` is the
/// radius of a disc that no place holds.
pub(crate) fn deposit(radii: &[f64], width: f64) -> Result<Vec<Placed>, f64> {
    let mut front = Front::new(width, radii);
    let mut promises = Promises::new(radii, front.columns());
    let (mut on_floor, mut last) = (true, None);
    for &radius in radii {
        if on_floor {
            let x = last.map_or(radius, |last: u32| {
                // Beside the last, both on the floor: (R + r)² = (R − r)² + Δx²
                let (centre, r) = front.discs[last as usize];
                centre.x + 2.0 * (r * radius).sqrt()
            });
            on_floor = x + radius <= width;
            if on_floor {
                let at = Vector2::new(x, radius);
                last = Some(front.lay(&Place { at, left: last, right: None }, radius));
                continue;
            }
        }
        let place = promises.lowest_place(&front, radius).ok_or(radius)?;
        front.lay(&place, radius);
    }
    Ok(front.discs)
}

/// Classes of radius, so many that a promise is close.
const CLASSES: usize = 8;

/// What each column promises for each class of radius.
struct Promises {
    /// The least radius of each class, rising.
    radius: Vec<f64>,
    /// By class and column: no disc of the least radius lies lower (m).
    height: Vec<Vec<f64>>,
    /// The changes of the column when the promise was made.
    made: Vec<Vec<Option<u32>>>,
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
            height: vec![vec![0.0; columns]; radius.len()],
            made: vec![vec![None; columns]; radius.len()],
            radius,
        }
    }

    /// The lowest place of a disc on the front; of places as low, that at the left.
    fn lowest_place(&mut self, front: &Front, radius: f64) -> Option<Place> {
        let class = self.radius.partition_point(|least| *least <= radius) - 1;
        let larger = radius - self.radius[class];
        let (mut best, mut seen): (Option<Place>, Vec<(usize, f64)>) = (None, Vec::new());
        loop {
            let (column, promised) = lowest(&self.height[class]);
            let too_high = |best: &Place| promised + larger > best.at.y + front.slack();
            if promised == f64::INFINITY || best.as_ref().is_some_and(too_high) {
                break;
            }
            let out_of_date = |class: &usize| self.made[*class][column] != Some(front.changes[column]);
            if let Some(class) = [0, class].into_iter().find(out_of_date) {
                self.promise(front, column, class);
            } else {
                front.lower_place(column, radius, &mut best);
                seen.push((column, promised));
                self.height[class][column] = f64::INFINITY;
            }
        }
        for (column, promised) in seen {
            self.height[class][column] = promised;
        }
        best
    }

    /// Looks how low a disc of the class can be in the column, which promises something to larger ones too.
    fn promise(&mut self, front: &Front, column: usize, class: usize) {
        let lowest = front.lowest_height(column, self.radius[class]);
        self.made[class][column] = Some(front.changes[column]);
        for (height, radius) in self.height.iter_mut().zip(&self.radius).skip(class) {
            height[column] = height[column].max(lowest + (radius - self.radius[class]));
        }
    }
}

/// The first of the lowest heights, and it.
fn lowest(height: &[f64]) -> (usize, f64) {
    let lower = |lowest: (usize, f64), (k, height): (usize, &f64)| {
        if *height < lowest.1 { (k, *height) } else { lowest }
    };
    height.iter().enumerate().fold((0, f64::INFINITY), lower)
}

#[cfg(test)]
mod tests {
    use super::front::{beside_wall, on_two};
    use super::*;

    /// `count` radii from `least` to `greatest`, drawn evenly.
    fn radii(count: u32, least: f64, greatest: f64) -> Vec<f64> {
        (0..count).map(|k| least + (greatest - least) * (f64::from(k) * 0.618_034).fract()).collect()
    }

    #[test]
    fn deposited_discs_fill_the_box_without_overlap() {
        let discs = deposit(&radii(400, 0.05, 0.1), 3.0).unwrap();
        for (k, (x, r)) in discs.iter().enumerate() {
            assert!(
                x.x >= r - 1e-11 && x.x <= 3.0 - r + 1e-11 && x.y >= r - 1e-11,
                "disc {k} leaves the box"
            );
            for (other, s) in &discs[..k] {
                assert!((x - other).norm() >= r + s - 1e-11, "disc {k} overlaps another");
            }
        }
        let area: f64 = discs.iter().map(|(_, r)| std::f64::consts::PI * r * r).sum();
        let top = discs.iter().map(|(x, r)| x.y + r).fold(0.0, f64::max);
        assert!(area / (3.0 * top) > 0.7, "solid fraction {}", area / (3.0 * top));
    }

    /// The lowest of all places on any two discs of the front, or on one and beside a wall.
    fn lowest_of_all(front: &Front, radius: f64) -> Option<Place> {
        let chain: Vec<u32> =
            std::iter::successors(front.first, |disc| front.after[*disc as usize]).collect();
        let disc = |k: u32| front.discs[k as usize];
        let beside = |k: u32| {
            let left =
                beside_wall(disc(k), radius, radius).map(|at| Place { at, left: None, right: Some(k) });
            let right = beside_wall(disc(k), front.width - radius, radius);
            left.into_iter().chain(right.map(|at| Place { at, left: Some(k), right: None }))
        };
        let on = |k: u32, other: u32| {
            on_two(disc(k), disc(other), radius).map(|at| Place { at, left: Some(k), right: Some(other) })
        };
        let pairs = chain.iter().enumerate().flat_map(|(k, held)| {
            chain[k + 1..].iter().filter_map(move |other| on(*held, *other)).chain(beside(*held))
        });
        pairs
            .filter(|place| front.fits(chain.iter().copied(), place.at, radius))
            .min_by(|a, b| a.at.y.total_cmp(&b.at.y).then(a.at.x.total_cmp(&b.at.x)))
    }

    #[test]
    fn every_disc_lies_at_the_lowest_of_all_places() {
        let mut with_intruder = radii(250, 0.05, 0.1);
        with_intruder[120] = 0.4;
        for (radii, width) in [
            (radii(250, 0.05, 0.1), 2.4),
            (radii(250, 0.02, 0.2), 3.0),
            (radii(150, 0.001, 0.1), 1.5),
            (with_intruder, 2.4),
        ] {
            let mut front = Front::new(width, &radii);
            for (k, (at, radius)) in (0_u32..).zip(deposit(&radii, width).unwrap()) {
                let on_floor = at.y == radius;
                let place = if on_floor {
                    Place { at, left: k.checked_sub(1), right: None }
                } else {
                    lowest_of_all(&front, radius).unwrap()
                };
                assert_eq!(place.at, at, "disc {k} of radius {radius}");
                front.lay(&place, radius);
            }
        }
    }

    #[test]
    fn equal_discs_lie_in_rows_of_five_and_four() {
        let discs = deposit(&[0.1; 60], 1.0).unwrap();
        let top = discs.iter().map(|(x, _)| x.y).fold(0.0, f64::max);
        assert!((top - (0.1 + 13.0 * 0.1 * 3.0_f64.sqrt())).abs() < 1e-9, "{top}");
    }
}
