//! When a run has reached an accuracy: not when it first touches it, but when it stays there.

/// A measure may rise to this many accuracies and has stayed all the same (–): one decade, the least that a chart tells apart.
pub const STAYED: f64 = 10.0;

/// Returns the index of the first of `values`, a measure along a curve, that is at most `accuracy` and is followed by none above ten
/// times that; `None` if there is none. A value that is not a number is above.
pub fn reached(
    values: impl DoubleEndedIterator<Item = f64> + ExactSizeIterator + Clone,
    accuracy: f64,
) -> Option<usize> {
    let above = |value: f64| value.is_nan() || value > STAYED * accuracy;
    let from = values.clone().rposition(above).map_or(0, |last| last + 1);
    values.enumerate().skip(from).find(|(_, value)| *value <= accuracy).map(|(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::reached;

    #[test]
    fn reached_means_stayed() {
        for (values, expected) in [
            (&[1.0, 0.1, 0.01, 0.001][..], Some(2)),
            // Up again, but by less than a decade.
            (&[1.0, 0.01, 0.09, 0.001], Some(1)),
            // A touch.
            (&[1.0, 0.01, 0.5, 0.02, 0.01], Some(4)),
            (&[1.0, 0.01, 0.5, 0.02], None),
            // A run that diverged.
            (&[1.0, 0.01, f64::NAN], None),
            (&[f64::NAN, 0.001], Some(1)),
            (&[], None),
        ] {
            assert_eq!(reached(values.iter().copied(), 0.01), expected, "{values:?}");
        }
    }
}
