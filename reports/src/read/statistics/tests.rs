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
