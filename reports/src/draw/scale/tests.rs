use super::*;

#[test]
fn lightness_falls_from_few_to_many() {
    let scale = ColorScale::of([10.0, 1000.0].into_iter()).unwrap();
    let luma = |v: f64| {
        let RGBColor(r, g, b) = scale.color(v);
        0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
    };
    let lumas: Vec<f64> = (0..=20).map(|i| luma(10f64.powf(1.0 + 0.1 * f64::from(i)))).collect();
    assert!(lumas.windows(2).all(|pair| pair[0] > pair[1]), "{lumas:?}");
}

#[test]
fn no_values_have_no_scale_and_equal_ones_have_a_range() {
    assert!(ColorScale::of(std::iter::empty()).is_none());
    let scale = ColorScale::of([5.0, 5.0].into_iter()).unwrap();
    assert!(scale.high > scale.low);
}
