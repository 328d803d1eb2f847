use super::recalled;
use contact::{RoughContact, RoughDiscs, Touch};
use nalgebra::Vector2;

#[test]
fn round_off_of_a_contact_that_opened_is_admitted_in_the_next_time_step() {
    let contact = RoughContact {
        candidate: 0,
        antagonist: None,
        normal: Vector2::new(0.0, 1.0),
        arms: Vector2::new(1.0, 0.0),
        offset: Vector2::zeros(),
        friction: 0.5,
    };
    let recalled = |r: [f64; 2]| recalled::<RoughDiscs>(&contact, Vector2::from(r));
    // As Gauss-Seidel left it of impulses of 1 N·s.
    let left = recalled([1.776_6e-16, 8.883_5e-17]);
    assert!(contact.is_admissible(left) && left.x == 1.776_6e-16, "{left}");
    for inside in [[2.0, 1.0], [2.0, -0.3], [0.0, 0.0]] {
        assert_eq!(recalled(inside), Vector2::from(inside));
    }
}
