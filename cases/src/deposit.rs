//! Discs laid one by one at the lowest place where two others, or one and a wall, hold it.
//!
//! The discs that can still be touched from above form the front, a chain from wall to wall in which each disc touches
//! the next. A new disc replaces what it covers of the chain. The cost of a disc grows with the length of the front, which
//! is the width of the box: some 10 ns per disc of it.

use nalgebra::Vector2;
use std::ops::Range;

/// Centre and radius (m).
type Placed = (Vector2<f64>, f64);

/// Centres and radii (m) of discs with the given radii, in a box of `width` (m) with a floor at y = 0; `Err` is the
/// radius of a disc that no place holds.
pub(crate) fn deposit(radii: impl Iterator<Item = f64>, width: f64) -> Result<Vec<Placed>, f64> {
    let mut discs: Vec<Placed> = Vec::new();
    let mut chain: Vec<Placed> = Vec::new();
    let mut on_floor = true;
    for radius in radii {
        if on_floor {
            let x = chain.last().map_or(radius, |last| {
                // Beside the last, both on the floor: (R + r)² = (R − r)² + Δx²
                last.0.x + 2.0 * (last.1 * radius).sqrt()
            });
            on_floor = x + radius <= width;
            if on_floor {
                chain.push((Vector2::new(x, radius), radius));
                discs.push((Vector2::new(x, radius), radius));
                continue;
            }
        }
        let (place, covered) = lowest_place(&chain, radius, width).ok_or(radius)?;
        chain.splice(covered, [(place, radius)]);
        discs.push((place, radius));
    }
    Ok(discs)
}

/// The lowest place of a disc on the chain, and the part of the chain that it covers.
///
/// No place is lower than the lower of the discs that hold it, so most of the chain is left out at a glance; and only a place
/// that is lower than the best so far is tried against the whole chain.
fn lowest_place(chain: &[Placed], radius: f64, width: f64) -> Option<(Vector2<f64>, Range<usize>)> {
    let slack = slack(width);
    let mut best = (Vector2::repeat(f64::INFINITY), 0..0);
    let take = |best: &mut (Vector2<f64>, _), place: Option<Vector2<f64>>, covered: Range<usize>| {
        let fits = |place: &Vector2<f64>| fits(chain, covered.start, *place, radius, width);
        if let Some(place) = place.filter(|place| place.y < best.0.y && fits(place)) {
            *best = (place, covered);
        }
    };
    for (k, held) in chain.iter().enumerate() {
        if held.0.y <= best.0.y + slack {
            take(&mut best, beside_wall(*held, radius, radius), 0..k);
            take(&mut best, beside_wall(*held, width - radius, radius), k + 1..chain.len());
        }
        for (ahead, other) in chain[k + 1..].iter().enumerate() {
            // The chain winds, but beyond this the new disc reaches no further along it.
            if other.0.x - held.0.x > 2.0 * radius + held.1 + other.1 {
                break;
            }
            if held.0.y.min(other.0.y) <= best.0.y + slack {
                take(&mut best, on_two(*held, *other, radius), k + 1..k + 1 + ahead);
            }
        }
    }
    best.0.y.is_finite().then_some(best)
}

/// Round-off of a place on two discs, in the units of the box (m).
fn slack(width: f64) -> f64 {
    1e-12 * width
}

/// Against a wall, with the centre at `x`, and on one disc.
fn beside_wall((centre, r): Placed, x: f64, radius: f64) -> Option<Vector2<f64>> {
    let (distance, across) = (r + radius, centre.x - x);
    let height = distance * distance - across * across;
    (height >= 0.0).then(|| Vector2::new(x, centre.y + height.sqrt()))
}

/// On two discs, between them.
fn on_two((left, r_left): Placed, (right, r_right): Placed, radius: f64) -> Option<Vector2<f64>> {
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

/// Whether a disc can lie there, and come there from above. What is in the way is mostly close to `near` in the chain, where
/// the search begins.
fn fits(chain: &[Placed], near: usize, place: Vector2<f64>, radius: f64, width: f64) -> bool {
    let slack = slack(width);
    let inside = place.x >= radius - slack && place.x <= width - radius + slack && place.y >= radius - slack;
    let below_or_aside = |(centre, r): &Placed| {
        let between = place - centre;
        // Most of the chain is far aside: no square root for it.
        if between.x.abs() >= r + radius {
            return true;
        }
        let apart = between.norm() >= r + radius - slack;
        apart && (between.y >= 0.0 || between.x.abs() >= r + radius - slack)
    };
    let (before, after) = chain.split_at(near.saturating_sub(4));
    inside && after.iter().chain(before).all(below_or_aside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deposited_discs_fill_the_box_without_overlap() {
        let radii = (0..400).map(|k| 0.05 + 0.05 * (f64::from(k) * 0.618_034).fract());
        let discs = deposit(radii, 3.0).unwrap();
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
}
