//! The gap between two deposits that stand side by side, filled with discs that touch both: each at the lowest place where two others,
//! or one and the floor, hold it.

use super::front::{Disc, on_two};
use nalgebra::Vector2;

/// A gap between the sides of two deposits.
pub(crate) struct Seam {
    /// End of the left deposit and beginning of the right one (m).
    pub(crate) ends: [f64; 2],
    /// Greatest radius (m).
    pub(crate) greatest: f64,
    /// Round-off of a place (m).
    pub(crate) slack: f64,
}

/// Distances below and above the level within which discs count as near, over the greatest radius (–): a new disc is at most 4
/// below the level or 6 above it, and those that it may touch are at most 2 from there.
const BELOW: f64 = 6.0;
const ABOVE: f64 = 8.0;

impl Seam {
    /// Returns the depth to which a disc of the gap may have its centre in a pocket of a side (m).
    fn pocket(&self) -> f64 {
        self.greatest
    }

    /// Reports whether a disc of a deposit is so near to the gap that discs in the gap may touch it.
    pub(crate) fn is_beside(&self, (centre, radius): &Disc) -> bool {
        let reach = self.pocket() + self.greatest + radius;
        self.ends[0] - reach <= centre.x && centre.x <= self.ends[1] + reach
    }

    /// Discs with the given `radii` between the `sides`, of which each has those of its discs that are beside the gap, up to the
    /// surface of the lower one.
    ///
    /// # Errors
    /// Those of `radii`; and the radius of a disc that no place holds, by `no_place`.
    pub(crate) fn filled(
        &self,
        sides: [&[Disc]; 2],
        radii: impl Iterator<Item = Result<f64, String>>,
        no_place: impl Fn(f64) -> String,
    ) -> Result<Vec<Disc>, String> {
        let surface = |side: &[Disc]| side.iter().map(|(x, _)| x.y).fold(0.0, f64::max);
        let surface = surface(sides[0]).min(surface(sides[1]));
        let mut rising = sides.concat();
        rising.sort_by(|(a, _), (b, _)| {
            (a.y, a.x).partial_cmp(&(b.y, b.x)).unwrap_or(std::cmp::Ordering::Equal)
        });
        let mut ahead = rising.into_iter().peekable();
        let (mut laid, mut near, mut level): (Vec<Disc>, Vec<Disc>, f64) = (Vec::new(), Vec::new(), 0.0);
        for radius in radii {
            let radius = radius?;
            near.retain(|(x, _)| x.y >= level - BELOW * self.greatest);
            while let Some(disc) = ahead.next_if(|(x, _)| x.y <= level + ABOVE * self.greatest) {
                near.push(disc);
            }
            let at = self.lowest_place(&near, radius, level).ok_or_else(|| no_place(radius))?;
            if at.y > surface {
                break;
            }
            level = level.max(at.y);
            laid.push((at, radius));
            near.push((at, radius));
        }
        Ok(laid)
    }

    /// The lowest place between discs that are near the level; of places as low, that at the left.
    fn lowest_place(&self, near: &[Disc], radius: f64, level: f64) -> Option<Vector2<f64>> {
        let mut best: Option<Vector2<f64>> = None;
        for &(left, r) in near {
            // Beside a disc, both on the floor.
            let height = left.y - radius;
            let square = (r + radius) * (r + radius) - height * height;
            if square >= 0.0 {
                self.take(&mut best, near, Vector2::new(left.x + square.sqrt(), radius), radius, level);
            }
            for &(right, s) in near {
                let reach = r + s + 2.0 * radius;
                let beyond = best.is_some_and(|best| left.y.min(right.y) > best.y + self.slack);
                if right.x <= left.x || beyond || (right - left).norm_squared() > reach * reach {
                    continue;
                }
                if let Some(at) = on_two((left, r), (right, s), radius) {
                    self.take(&mut best, near, at, radius, level);
                }
            }
        }
        best
    }

    /// Takes a place for `best` if it is lower, in the gap, and free.
    fn take(
        &self,
        best: &mut Option<Vector2<f64>>,
        near: &[Disc],
        at: Vector2<f64>,
        radius: f64,
        level: f64,
    ) {
        let heights = level - (BELOW - 2.0) * self.greatest..=level + (ABOVE - 2.0) * self.greatest;
        let is_in = at.y >= radius - self.slack
            && heights.contains(&at.y)
            && self.ends[0] - self.pocket() <= at.x
            && at.x <= self.ends[1] + self.pocket();
        let free = |(x, r): &Disc| {
            let distance = r + radius - self.slack;
            (x - at).norm_squared() >= distance * distance
        };
        if is_in && best.is_none_or(|best| (at.y, at.x) < (best.y, best.x)) && near.iter().all(free) {
            *best = Some(at);
        }
    }
}
