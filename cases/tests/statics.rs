//! Scenes that stand by static friction, on both sides of their exact boundaries.

use analysis::Meter;
use cases::{Case, March, Marched};
use contact::acceleration::Acceleration;
use contact::{Measure, Mechanics, RoughDiscs, RoughSpheres, Touch};
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
    // Plain sweeps drift for ever where impulses are not unique.
    let sweeps = Nsgs { acceleration: Acceleration::Nesterov, ..Nsgs::default() };
    let mut speed = 0.0;
    for _ in 0..20 {
        let (outcome, observables) = march.time_step(&sweeps, &stop).unwrap();
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
    check::<RoughSpheres>("pinched-in-space", &[], "scene.friction", 0.25);
    // Below, it falls by what is left of its weight: 10 N less 40 N or 20 N times the friction, of 1 kg.
    for (name, left) in [("pinched", 10.0 - 40.0 * 0.2), ("held-at-wall", 10.0 - 20.0 * 0.2)] {
        let speed = fastest::<RoughDiscs>(name, &[("scene.friction", 0.2)]);
        assert!((speed / (20.0 * left / 10.0) - 1.0).abs() < 1e-10, "{name}: {speed}");
    }
}

#[test]
fn each_pair_of_materials_has_its_own_boundary() {
    let both = [("scene.materials.0.friction.inner", 0.6), ("scene.materials.0.friction.walls", 0.8)];
    for (pair, least) in [(0, 0.16), (1, 0.66)] {
        check::<RoughDiscs>("held-in-a-row", &[both[1 - pair]], both[pair].0, least);
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

/// Returns the impulses between the discs of `card-house` over the weight of one times h, (normal, tangential) by the numbers of the discs; a disc of
/// its own stands on the floor. The formulas hold for the friction at the boundary.
fn standing(friction: f64, ends: (u32, Option<u32>)) -> [f64; 2] {
    let (tan, cos, sin) = (15.0_f64.to_radians().tan(), 0.75_f64.sqrt(), 0.5);
    // Share that the centre of the second row passes on for each disc of it, and for the one on top.
    let of_row = cos + friction * sin;
    let outer = friction / (friction + tan * of_row);
    let (inner, top) = ((1.5 - outer) / of_row, 0.5 / of_row);
    match ends {
        (0, None) => [1.0 + outer, -tan * outer],
        (2, None) => [1.0 + outer, tan * outer],
        (1, None) => [4.0 - 2.0 * outer, 0.0],
        (0, Some(3)) => [outer, tan * outer],
        (2, Some(4)) => [outer, -tan * outer],
        (1, Some(3)) => [inner, -friction * inner],
        (1, Some(4)) => [inner, friction * inner],
        (3, Some(5)) => [top, friction * top],
        (4, Some(5)) => [top, -friction * top],
        _ => [0.0; 2],
    }
}

/// Six discs may stand at the boundary, by impulses that are known. From no impulses the other answer is found with a friction of 0.47, in which they
/// roll apart, and not with 0.6.
#[test]
fn a_house_of_discs_may_stand_where_friction_can_hold_it() {
    let root = 3.0_f64.sqrt();
    let least = ((2.0 * root - 3.0) / (2.0 * root - 1.0)).sqrt();
    let left = |share: f64| {
        let settings = [("scene.friction".to_owned(), format!("{:?}", least * share))];
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("card-house.toml");
        let case = Case::read(&file, &settings).unwrap();
        let problem = March::<RoughDiscs>::new(&case).unwrap().next().unwrap().frozen.problem;
        let weight = problem.mass()[0].mass * case.scene.gravity_m_per_s2 * case.scene.time_step_s;
        let of = |contact: &<RoughDiscs as Mechanics>::Contact| {
            let (candidate, antagonist) = contact.ends();
            let ends = antagonist
                .map_or((candidate, None), |other| (candidate.min(other), Some(candidate.max(other))));
            standing(least, ends).map(|r| r * weight)
        };
        let impulses: Vec<f64> = problem.contacts().iter().flat_map(of).collect();
        Meter::new(&problem).measure(&impulses, 0.0).natural_map
    };
    let (inside, outside) = (left(1.0 + BESIDE), left(1.0 - BESIDE));
    assert!(inside < 1e-2 * BESIDE && outside > 0.1 * BESIDE, "{inside:e} inside, {outside:e} outside");
    let [rolls, stands] =
        [0.47, 0.6].map(|friction| fastest::<RoughDiscs>("card-house", &[("scene.friction", friction)]));
    assert!(rolls > 1.0 && stands < BESIDE, "{rolls:e}, {stands:e}");
}
