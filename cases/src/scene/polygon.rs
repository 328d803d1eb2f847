//! Convex polygons: their centre, their area, and a check of their corners.

use contact::{Place, shown};
use nalgebra::Vector3;

/// Returns the mean of some points (m).
pub(crate) fn centroid<P: Place>(points: &[P]) -> P {
    points.iter().copied().fold(P::ZERO, |sum, point| sum + point) / points.len() as f64
}

/// Distance of a corner from the plane of the others over the size of a polygon (–): coordinates may have six digits.
const FLAT: f64 = 1e-6;

/// Returns twice the area of a polygon, as a vector across it (m²).
pub(crate) fn area<P: Place>(corners: &[P]) -> Vector3<f64> {
    let from_first = |corner: &P| Vector3::from((*corner - corners[0]).space());
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(corner, next)| from_first(corner).cross(&from_first(next))).sum()
}

/// Refuses corners that are no convex polygon in one plane, going around it once.
pub(crate) fn check_polygon(corners: &[Vector3<f64>], place: &str) -> Result<(), String> {
    let count = corners.len();
    if count < 3 {
        return Err(format!("`{place}.corners_m` has {count} corners: it must have at least 3"));
    }
    let across = area(corners);
    let size = corners.iter().map(|corner| (corner - corners[0]).norm()).fold(0.0, f64::max);
    if across.norm() <= FLAT * size * size {
        return Err(format!("`{place}.corners_m` has no area: its corners must not lie on a line"));
    }
    let normal = across.normalize();
    // By how much the edges turn, once around (rad).
    let mut turned = 0.0;
    for (k, corner) in corners.iter().enumerate() {
        let off = normal.dot(&(corner - corners[0])).abs();
        if off > FLAT * size {
            return Err(format!(
                "`{place}.corners_m[{k}]` lies {} m off the plane of the others",
                shown(off)
            ));
        }
        let [before, after] = [corners[(k + count - 1) % count], corners[(k + 1) % count]];
        let (from, to) = (corner - before, after - corner);
        turned += normal.dot(&from.cross(&to)).atan2(from.dot(&to));
        if normal.dot(&from.cross(&to)) < -FLAT * size * size {
            return Err(format!(
                "`{place}.corners_m[{k}]` is a corner that points inwards: the polygon must be convex"
            ));
        }
    }
    if turned > 3.0 * std::f64::consts::PI {
        return Err(format!("`{place}.corners_m` goes around more than once: the polygon must be convex"));
    }
    Ok(())
}
