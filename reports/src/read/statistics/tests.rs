use super::*;

#[test]
fn median_is_the_middle_or_between_the_two_there() {
    assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), Some(2.5));
    assert_eq!(median(Vec::new()), None);
}

#[test]
fn slope_of_a_power_is_its_exponent() {
    let points = [2.0_f64, 3.0, 7.0].map(|n| (n.log10(), (5.0 * n.powf(1.5)).log10()));
    assert!((slope(&points).unwrap() - 1.5).abs() < 1e-12);
    assert_eq!((slope(&points[..1]), slope(&[])), (None, None));
}

#[test]
fn range_has_room_even_around_one_value() {
    assert_eq!(padded([2.0].into_iter(), 0.1), (1.7, 2.3));
    assert_eq!(padded([0.0, 2.0].into_iter(), 0.25), (-0.5, 2.5));
    assert_eq!(padded(std::iter::empty(), 0.0), (0.0, 1.0));
}

#[test]
fn span_leaves_out_what_is_no_number() {
    assert_eq!(span([f64::NAN, 2.0, f64::INFINITY, 1.0].into_iter()), Some((1.0, 2.0)));
    assert_eq!(span(std::iter::empty()), None);
}

/// By tables of Student's distribution: 2.776 of 4 degrees of freedom, 2.262 of 9, 2.030 of 35.
#[test]
fn the_interval_of_a_mean_is_students() {
    for (n, student) in [(5, 2.776), (10, 2.262), (36, 2.030)] {
        // Half of them one above the mean of 3, half one below, or in the middle of an odd number.
        let sign = |k: i32| {
            if 2 * k + 1 == n {
                0.0
            } else if 2 * k < n {
                1.0
            } else {
                -1.0
            }
        };
        let values: Vec<f64> = (0..n).map(|k| 3.0 + sign(k)).collect();
        let squares: f64 = (0..n).map(|k| sign(k).powi(2)).sum();
        let half = student * (squares / f64::from(n - 1) / f64::from(n)).sqrt();
        let mean = Mean::of(&values, OF_95).unwrap();
        assert!(
            (mean.middle - 3.0).abs() < 1e-12 && (mean.high - 3.0 - half).abs() < 3e-3 * half,
            "{n}: {mean:?}"
        );
        assert!((mean.high + mean.low - 6.0).abs() < 1e-12);
    }
    assert_eq!(Mean::of(&[1.0; 4], OF_95), None);
}

#[test]
fn slope_has_the_interval_of_its_residuals() {
    // y = 2x ± 1 at x = 0 to 5, twice: slope 2, residuals ±1, Σ(x − 2.5)² = 35.
    let points: Vec<(f64, f64)> =
        (0..6).flat_map(|k| [1.0, -1.0].map(|up| (f64::from(k), 2.0 * f64::from(k) + up))).collect();
    let slope = slope_within(&points, OF_95).unwrap();
    // Student's quantile of 10 degrees of freedom is 2.228.
    let half = 2.228 * (12.0_f64 / 10.0 / 35.0).sqrt();
    assert!((slope.middle - 2.0).abs() < 1e-12 && (slope.high - 2.0 - half).abs() < 2e-3 * half, "{slope:?}");
    assert_eq!(slope_within(&points[..5], OF_95), None);
}
