//! Known properties of the programmes.

use super::Conic;
use contact::{Packing, RoughContact, RoughDiscs, RoughMass, Truth};
use nalgebra::{Vector2, Vector3};

/// A disc that lands on a floor as it slides.
fn sliding_disc(friction: f64) -> Packing<RoughDiscs> {
    let contact = RoughContact {
        candidate: 0,
        antagonist: None,
        normal: Vector2::y(),
        arms: Vector2::new(0.5, 0.0),
        offset: Vector2::zeros(),
        friction,
    };
    let mass = vec![RoughMass { mass: 2.0, inertia: 0.25 }];
    let free = vec![Vector3::new(3.0, -0.1, 0.0)];
    Packing::new(mass, vec![Vector2::new(0.0, 0.5)], free, vec![contact]).unwrap()
}

#[test]
fn one_programme_lifts_a_disc_that_slides_and_the_fixed_point_lays_it_down() {
    let friction = 0.2;
    let problem = sliding_disc(friction);
    let mut convex = Conic::<2, 3>::relaxation(&problem).unwrap();
    let mut velocity = || {
        assert!(convex.advance());
        let mut r = [0.0; 2];
        convex.impulses(&mut r);
        Truth::new(&problem, &r).velocity()[0]
    };
    // v_n = μ |v_t|, with v_t = t · V − R ω and t = (−1, 0).
    let first = velocity();
    let sliding = first.x + 0.5 * first.z;
    assert!(sliding > 1.0 && (first.y - friction * sliding).abs() < 1e-10, "{first}");
    let last = (0..40).map(|_| velocity()).last().unwrap();
    // r_t = μ r_n of 0.2 N·s against the motion.
    assert!(last.y.abs() < 1e-10 && (last.x - (3.0 - friction * 0.1)).abs() < 1e-10, "{last}");
}

#[test]
fn once_what_moves_is_settled_the_next_programme_has_its_velocities() {
    let friction = 0.2;
    let problem = sliding_disc(friction);
    let mut programmes = Conic::<2, 3>::relaxation(&problem).unwrap();
    while programmes.step() {}
    programmes.settle();
    while programmes.step() {}
    let mut r = [0.0; 2];
    programmes.impulses(&mut r);
    assert!((r[0] - 0.2).abs() < 1e-8 && (r[1].abs() - friction * 0.2).abs() < 1e-8, "{r:?}");
    let velocity = Truth::new(&problem, &r).velocity()[0];
    assert!(velocity.y.abs() < 1e-8 && (velocity.x - (3.0 - friction * 0.1)).abs() < 1e-8, "{velocity}");
}
