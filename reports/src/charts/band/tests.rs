use super::*;

#[test]
fn curve_that_goes_up_and_down_has_a_band_that_holds_it_and_one_that_falls_has_none() {
    let falls: Vec<LogPoint> = (0..100).map(|i| Some((-0.06 * f64::from(i), -0.08 * f64::from(i)))).collect();
    assert!(Band::of(&falls, 6.0).is_none());
    let swings = |i: i32| -0.08 * f64::from(i) + if i % 2 == 0 { 1.0 } else { -1.0 };
    let curve: Vec<LogPoint> = (0..100).map(|i| Some((-0.06 * f64::from(i), swings(i)))).collect();
    let band = Band::of(&curve, 6.0).unwrap();
    assert_eq!(band.middle.last(), curve.last());
    assert!(band.low.len() <= 61 && band.middle.len() == band.low.len() + 1);
    let (x, y) = (-0.06 * 50.0, [swings(50), swings(51)]);
    let at = band.low.iter().position(|low| (low.0 - x).abs() <= 0.1).unwrap();
    assert!(y.iter().any(|y| (band.low[at].1..=band.high[at].1).contains(y)));
    assert!(band.low.windows(2).all(|pair| pair[1].0 < pair[0].0));
}
