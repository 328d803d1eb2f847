//! Discs on segments: known answers.

use crate::common::scene_of_discs;
use cases::{Case, March, Observables};
use contact::{Discs, Measure};
use nalgebra::Vector2;
use nsgs::Nsgs;
use runner::{Outcome, Stop};
use std::path::PathBuf;

const G: f64 = 10.0;
const H: f64 = 0.01;
/// A disc of 0.5 m (kg).
const MASS: f64 = 1000.0 * std::f64::consts::PI * 0.25;

/// Discs, as [x, y, radius], over segments.
fn scene(discs: &str, segments: &str) -> Result<Case, String> {
    scene_of_discs(discs, H, &format!("gravity_m_per_s2 = {G:?}\n{segments}"))
}

/// The last of so many time steps, and how the first disc moves after it.
fn after(case: &Case, time_steps: u32) -> (Outcome, Observables, Vector2<f64>) {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 10_000 };
    let mut march = March::<Discs>::new(case).unwrap();
    let mut last = None;
    for _ in 0..time_steps {
        last = Some(march.time_step(&Nsgs::default(), &stop).unwrap());
    }
    let (outcome, seen) = last.unwrap();
    (outcome, seen, march.velocity()[0])
}

fn near(is: f64, expected: f64) {
    assert!((is - expected).abs() <= 1e-10 * expected.abs().max(1.0), "{is} for {expected}");
}

const LEVEL: &str = "[[scene.segments]]\nfrom_m = [-2.0, 1.0]\nto_m = [2.0, 1.0]\n";

#[test]
fn level_segment_carries_the_weight_from_above_and_from_below_nothing() {
    let (outcome, _, velocity) = after(&scene("[[0.0, 1.5, 0.5]]", LEVEL).unwrap(), 5);
    near(outcome.impulses[0], MASS * G * H);
    near(velocity.norm(), 0.0);
    // A disc right below falls, and one thrown upwards is stopped.
    let (_, _, velocity) = after(&scene("[[0.0, 0.5, 0.5]]", LEVEL).unwrap(), 5);
    near(velocity.y, -5.0 * G * H);
    let thrown = format!("thrown_at_m_per_s = [0.0, 3.0]\n{LEVEL}");
    let (_, _, velocity) = after(&scene("[[0.0, 0.5, 0.5]]", &thrown).unwrap(), 1);
    near(velocity.y, 0.0);
}

#[test]
fn disc_slides_down_a_segment_that_leans_and_off_its_end() {
    // 3-4-5: the normal is (0.6, 0.8), the way down (0.8, −0.6).
    let leaning = "[[scene.segments]]\nfrom_m = [-4.0, 3.0]\nto_m = [4.0, -3.0]\n";
    let (_, _, velocity) = after(&scene("[[0.3, 0.4, 0.5]]", leaning).unwrap(), 20);
    near(velocity.x, 0.8 * 0.6 * G * 20.0 * H);
    near(velocity.y, -0.6 * 0.6 * G * 20.0 * H);
    // Beside its end, with the centre on its line: nothing touches.
    let (_, _, velocity) = after(&scene("[[4.8, -3.6, 0.5]]", leaning).unwrap(), 3);
    near(velocity.y, -3.0 * G * H);
}

#[test]
fn end_of_a_segment_is_touched_as_a_point_and_an_obstacle_as_a_disc() {
    // The normal from the end (2, 1) to the centre is (0.6, 0.8): of the weight's impulse 0.8 acts along it.
    let (outcome, _, _) = after(&scene("[[2.3, 1.4, 0.5]]", LEVEL).unwrap(), 1);
    near(outcome.impulses[0], 0.8 * MASS * G * H);
    let obstacle = "[[scene.segments]]\nfrom_m = [2.0, 1.0]\nradius_m = 0.5\n";
    let (outcome, _, _) = after(&scene("[[2.6, 1.8, 0.5]]", obstacle).unwrap(), 1);
    near(outcome.impulses[0], 0.8 * MASS * G * H);
    // Between two obstacles it rests: each gives m g h/(2 · 0.8).
    let two = format!("{obstacle}[[scene.segments]]\nfrom_m = [3.2, 1.0]\nradius_m = 0.5\n");
    let (outcome, _, velocity) = after(&scene("[[2.6, 1.8, 0.5]]", &two).unwrap(), 3);
    near(outcome.impulses[0], MASS * G * H / 1.6);
    near(velocity.norm(), 0.0);
}

#[test]
fn gate_holds_until_it_is_taken_away() {
    let gate = format!("{LEVEL}removed_at_s = {}\n", 10.0 * H);
    let case = scene("[[0.0, 1.5, 0.5]]", &gate).unwrap();
    near(after(&case, 9).2.y, 0.0);
    // Contacts are sought in the middle of the time step: the one from 0.1 s on is the first without.
    near(after(&case, 10).2.y, 0.0);
    near(after(&case, 15).2.y, -5.0 * G * H);
    let march = March::<Discs>::new(&case).unwrap();
    assert_eq!(march.walls().len(), 1);
}

#[test]
fn segment_that_moves_takes_the_disc_along() {
    let rising = format!("{LEVEL}velocity_m_per_s = [0.0, 0.7]\n");
    let (_, _, velocity) = after(&scene("[[0.0, 1.5, 0.5]]", &rising).unwrap(), 20);
    near(velocity.y, 0.7);
}

#[test]
fn segments_without_meaning_are_refused_by_key_and_number() {
    let refused = |segments: &str| scene("[[0.0, 1.5, 0.5]]", segments).unwrap_err();
    let point = refused("[[scene.segments]]\nfrom_m = [0.0, 0.0]\n");
    assert!(
        point.contains("`scene.segments[0].radius_m` is 0: it must be positive for a segment without length"),
        "{point}"
    );
    let late = refused(&format!("{LEVEL}{LEVEL}removed_at_s = -1.0\n"));
    assert!(late.contains("`scene.segments[1].removed_at_s` is -1"), "{late}");
    let same = refused("[[scene.segments]]\nfrom_m = [1.0, 0.0]\nto_m = [1.0, 0.0]\n");
    assert!(same.contains("`scene.segments[0].radius_m`"), "{same}");
    let periodic = refused(&format!("[scene.box]\nwidth_m = 9.0\nperiodic = true\n{LEVEL}"));
    assert!(periodic.contains("`scene.segments` is for boxes without `periodic` sides"), "{periodic}");
}

#[test]
fn disc_rolls_down_a_rough_segment_that_leans() {
    // tan = 0.75 ≤ 3 μ: it rolls, at 2/3 g sin; the spin follows.
    let leaning = "friction = 0.3\n[[scene.segments]]\nfrom_m = [-4.0, 3.0]\nto_m = [4.0, -3.0]\n";
    let case = scene("[[0.3, 0.4, 0.5]]", leaning).unwrap();
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 10_000 };
    let mut march = March::<contact::RoughDiscs>::new(&case).unwrap();
    for _ in 0..20 {
        march.time_step(&Nsgs::default(), &stop).unwrap();
    }
    let [v_x, v_y, spin] = march.velocity()[0].into();
    let speed = 2.0 / 3.0 * 0.6 * G * 20.0 * H;
    near(v_x, 0.8 * speed);
    near(v_y, -0.6 * speed);
    near(spin, -speed / 0.5);
}

#[test]
fn hopper_rests_then_flows() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let overrides = [("sample.grains".to_owned(), "60".to_owned())];
    let hopper = Case::read(&folder.join("hopper.toml"), &overrides).unwrap();
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-3, max_iterations: 500 };
    let mut march = March::<contact::RoughDiscs>::new(&hopper).unwrap();
    let mut energy = |time_steps: u32| {
        let mut kinetic = f64::NAN;
        for _ in 0..time_steps {
            kinetic = march.time_step(&Nsgs::default(), &stop).unwrap().1.kinetic_energy;
        }
        kinetic
    };
    let (resting, flowing) = (energy(240), energy(40));
    assert!(flowing > 20.0 * resting, "{resting} to {flowing} J");
}

#[test]
fn a_vibration_that_the_time_step_does_not_resolve_is_refused_with_both_numbers() {
    let shaken = |place: &str, hertz: f64| {
        let vibration =
            format!("vibration = {{ amplitude_m = 0.001, frequency_hz = {hertz:?}, direction = \"y\" }}\n");
        scene("[[0.0, 1.5, 0.5]]", &format!("{place}{vibration}"))
    };
    // At 100 Hz, 1/h, the floor would stand still.
    for (place, key) in [("[scene.box]\n", "box"), (LEVEL, "segments[0]")] {
        for hertz in [5.01, 100.0, -100.0] {
            let refused = shaken(place, hertz).unwrap_err();
            for said in [
                format!("`scene.{key}.vibration.frequency_hz` is {hertz}"),
                "`scene.time_step_s` is 0.01".into(),
                "20 time steps".into(),
            ] {
                assert!(refused.contains(&said), "{refused}");
            }
        }
        assert!(shaken(place, 5.0).is_ok(), "{key}");
    }
}

#[test]
fn what_is_rarely_meant_is_warned_of_by_its_key() {
    let warned = |sets: &[(&str, &str)]| {
        let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("thrown-disc.toml");
        let sets: Vec<_> = sets.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        March::<contact::RoughDiscs>::new(&Case::read(&file, &sets).unwrap()).unwrap().warnings()
    };
    for (key, value, said) in [
        ("scene.friction", "30", "`scene.friction` is 30"),
        ("scene.box.friction", "3", "`scene.box.friction` is 3"),
        ("scene.slope_rad", "20", "`scene.slope_rad` is 20"),
        ("scene.gravity_m_per_s2", "-9.81", "`scene.gravity_m_per_s2` is -9.81"),
        ("scene.time_step_s", "5", "`scene.time_step_s` is 5"),
        ("scene.impact_speed_m_per_s", "60", "`scene.time_step_s` is 0.01"),
    ] {
        let warnings = warned(&[(key, value)]);
        assert!(warnings.len() == 1 && warnings[0].contains(said), "{key}: {warnings:?}");
    }
    assert_eq!(warned(&[("scene.friction", "2"), ("scene.slope_rad", "1.5")]), Vec::<String>::new());
}

/// A part of a key that is a number is a place in a list.
#[test]
fn one_of_several_segments_is_changed_by_its_place() {
    let read = |key: &str, value: &str| {
        let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("literature/to-2001.toml");
        Case::read(&file, &[(key.to_owned(), value.to_owned())])
    };
    let case = read("scene.segments.2.removed_at_s", "7.5").unwrap();
    let removed: Vec<_> = case.scene.segments.iter().map(|segment| segment.removed_at_s).collect();
    assert_eq!(removed, [None, None, Some(7.5)]);
    for (key, words) in [
        ("scene.segments.3.removed_at_s", "`segments` is a list of 3, counted from 0: it has no `3`"),
        ("scene.segments.last.removed_at_s", "it has no `last`"),
        ("scene.friction.here", "`friction` is a value, it has no keys"),
    ] {
        let error = read(key, "1.0").unwrap_err().to_string();
        assert!(error.contains(words) && error.contains(key), "{error}");
    }
}
