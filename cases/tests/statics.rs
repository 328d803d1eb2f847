//! Scenes that stand by static friction, on both sides of their exact boundaries.

use cases::{Case, March, Marched};
use contact::{Measure, RoughDiscs, RoughSpheres};
use nsgs::Nsgs;
use runner::{Status, Stop};
use std::path::Path;

/// Share by which a friction is beside its boundary (–).
const BESIDE: f64 = 1e-10;

/// Returns the greatest speed of a grain after 20 time steps, solved to round-off, over g h (–).
fn fastest<M: Marched>(name: &str, settings: &[(&str, f64)]) -> f64 {
    let settings: Vec<(String, String)> =
        settings.iter().map(|(key, value)| ((*key).to_owned(), format!("{value:?}"))).collect();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    let case = Case::read(&file, &settings).unwrap();
    let mut march = March::<M>::new(&case).unwrap();
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 100_000 };
    let mut speed = 0.0;
    for _ in 0..20 {
        let (outcome, observables) = march.time_step(&Nsgs::default(), &stop).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{name}");
        speed = observables.greatest_speed;
    }
    speed / (case.scene.gravity_m_per_s2 * case.scene.time_step_s)
}

/// Checks that a scene stands with this much friction, by its key, and a little more, and not with a little less.
fn check<M: Marched>(name: &str, others: &[(&str, f64)], key: &str, least: f64) {
    let at = |friction: f64| fastest::<M>(name, &[others, &[(key, friction)]].concat());
    let (inside, outside) = (at(least * (1.0 + BESIDE)), at(least * (1.0 - BESIDE)));
    assert!(
        inside < 1e-2 * BESIDE && outside > 0.1 * BESIDE,
        "{name}, {key} at {least}: {inside:e} inside, {outside:e} outside"
    );
}

#[test]
fn a_block_stands_above_the_tangent_of_its_slope() {
    for slope in [0.1_f64, 0.4, 0.7] {
        let on_it = [("scene.slope_rad", slope)];
        check::<RoughDiscs>("block-on-slope", &on_it, "scene.friction", slope.tan());
        check::<RoughSpheres>("block-on-slope-in-space", &on_it, "scene.friction", slope.tan());
    }
}

#[test]
fn what_is_pressed_to_a_wall_stays_where_friction_carries_its_weight() {
    check::<RoughDiscs>("pinched", &[], "scene.friction", 0.25);
    check::<RoughDiscs>("held-at-wall", &[], "scene.friction", 0.5);
    // Below, it falls by what is left of its weight: 10 N less 40 N or 20 N times the friction, of 1 kg.
    for (name, left) in [("pinched", 10.0 - 40.0 * 0.2), ("held-at-wall", 10.0 - 20.0 * 0.2)] {
        let speed = fastest::<RoughDiscs>(name, &[("scene.friction", 0.2)]);
        assert!((speed / (20.0 * left / 10.0) - 1.0).abs() < 1e-10, "{name}: {speed}");
    }
}

#[test]
fn a_stack_stands_where_its_thrust_stays_within_the_cones() {
    let fifteen = 15.0_f64.to_radians().tan();
    check::<RoughDiscs>("stack-of-three", &[("scene.box.friction", 0.5)], "scene.friction", fifteen);
    check::<RoughDiscs>("stack-of-three", &[("scene.friction", 0.5)], "scene.box.friction", fifteen / 3.0);
    let half = (0.5 * 0.5_f64.sqrt().atan()).tan();
    check::<RoughSpheres>("stack-of-four", &[("scene.box.friction", 0.5)], "scene.friction", half);
    check::<RoughSpheres>("stack-of-four", &[("scene.friction", 0.5)], "scene.box.friction", half / 4.0);
}
