//! The room that grains take up.

use contact::Place;

/// Returns how far grains reach along a direction (m).
pub(crate) fn reach<P: Place>(position: &[P], radius: &[f64], along: P) -> f64 {
    let reaches = position.iter().zip(radius).map(|(q, r)| along.dot_product(*q) + r);
    reaches.fold(f64::NEG_INFINITY, f64::max)
}

/// Area or volume of the box around the grains (m², m³).
pub(crate) fn room<P: Place>(position: &[P], radius: &[f64]) -> f64 {
    let length = |axis: usize| {
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        let along = P::of(along);
        reach(position, radius, along) + reach(position, radius, -along)
    };
    (0..P::LEN).map(length).product()
}
