//! Solutions of the law, and values that are not numbers.

use super::*;
use crate::rough::obeys_friction;
use nalgebra::Vector3;

#[test]
fn fixed_points_of_the_update_are_the_solutions_of_the_law() {
    for (r, v, solves) in [
        (0.0, 1.0, true),
        (2.0, 0.0, true),
        (0.0, 0.0, true),
        (2.0, 1.0, false),
        (0.0, -1.0, false),
        (2.0, -1.0, false),
    ] {
        assert_eq!(update(r, v, 0.5, 1.0) == r, solves, "r = {r}, v = {v}");
        assert_eq!(change(r, v, 1.0) == 0.0, solves, "r = {r}, v = {v}");
    }
}

#[test]
fn not_a_number_is_not_hidden_by_the_projection() {
    assert!(non_negative(f64::NAN).is_nan());
    assert_eq!(non_negative(-1.0), 0.0);
    assert!([(f64::NAN, 1.0), (1.0, f64::NAN)].iter().all(|(r, v)| (r + change(*r, *v, 1.0)).is_nan()));
    assert_eq!(change(2.0, 3.0, 1.0), -2.0);
}

#[test]
fn impulses_whose_squares_underflow_are_in_the_cone() {
    let r = Vector3::new(8.851_713_500_238_487e-161, -2.655_514_050_071_546e-161, 0.0);
    assert!(obeys_friction(r.as_slice(), 0.3));
    assert!(!obeys_friction((r * 1e161).as_slice(), 0.299_999));
    assert!(!obeys_friction((-r).as_slice(), 0.3));
}
