//! Heaps, drums and hoppers: what friction holds, what it lifts, and what it lets flow.

use cases::{Case, Energy, March};
use contact::{Measure, RoughDiscs, RoughSpheres};
use nalgebra::{Vector2, Vector3};
use nsgs::Nsgs;
use runner::Stop;
use std::path::PathBuf;

/// To within a hundredth, as far as flow needs it.
const STOP: Stop = Stop { on: Measure::NaturalMap, tolerance: 1e-2, max_iterations: 500 };

fn march(name: &str, grains: &str, width: &str, friction: &str) -> March<RoughDiscs> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    let size = if name == "heap" { "scene.box.width_m" } else { "scene.drum.radius_m" };
    let overrides = [("sample.grains", grains), (size, width), ("scene.friction", friction)];
    March::new(&Case::read(&file, &overrides.map(|(key, value)| (key.into(), value.into()))).unwrap())
        .unwrap()
}

/// Centre of mass (m).
fn centre(march: &March<RoughDiscs>) -> Vector2<f64> {
    let weights: f64 = march.mass().iter().map(|m| m.mass).sum();
    march.mass().iter().zip(march.grains()).map(|(m, (_, x, _))| x * m.mass).sum::<Vector2<f64>>() / weights
}

/// The angle of the heap on bumps of 0.1 m (rad): of a triangle the mean height over the mean distance from its middle.
fn repose(march: &March<RoughDiscs>) -> f64 {
    let (centre, weights) = (centre(march), march.mass().iter().map(|m| m.mass).sum::<f64>());
    let away = march.mass().iter().zip(march.grains()).map(|(m, (_, x, _))| (x.x - centre.x).abs() * m.mass);
    ((centre.y - 0.1) / (away.sum::<f64>() / weights)).atan()
}

#[test]
fn the_angle_of_repose_of_a_heap_rises_with_friction_and_saturates() {
    let at_rest = |friction: &str| {
        let mut heap = march("heap", "150", "1.6", friction);
        for _ in 0..1600 {
            heap.time_step(&Nsgs::default(), &STOP).unwrap();
        }
        let fastest = heap.grains().map(|(_, _, v)| v.norm()).fold(0.0, f64::max);
        assert!(fastest < 0.02, "{friction}: it comes to rest, {fastest:e} m/s");
        repose(&heap).to_degrees()
    };
    // What bumps alone hold, and what friction adds.
    let [none, low, middle, high] = ["0.0", "0.1", "0.3", "0.8"].map(at_rest);
    assert!(none + 2.0 < low && low + 2.0 < middle && middle < high, "{none}, {low}, {middle}, {high}");
    assert!(high - middle < 0.5 * (middle - none), "{none}, {low}, {middle}, {high}");
}

/// A drum that turns for 6 s: its angle (°), and the energy of the last 3 s, with what gravity's torque about the axis takes of the
/// drum's work, Ω M g ∫ x dt (J).
fn turned(friction: &str) -> (f64, Energy, f64) {
    let mut drum = march("drum", "100", "1.4", friction);
    let weight: f64 = drum.mass().iter().map(|m| 9.81 * m.mass).sum();
    let (mut energy, mut lifted, mut angle) = (Energy::default(), 0.0, 0.0);
    for k in 0..1200 {
        let before = centre(&drum).x;
        let (_, seen) = drum.time_step(&Nsgs::default(), &STOP).unwrap();
        let centre = centre(&drum);
        angle = centre.x.atan2(-centre.y);
        assert!((seen.shape.bed_angle - angle).abs() < 1e-12 && seen.shape.passed_mass.is_nan(), "{angle}");
        if k >= 600 {
            energy += seen.energy;
            lifted += 0.07 * weight * 0.5 * (before + centre.x) * 0.005;
        }
    }
    (angle.to_degrees(), energy, lifted)
}

#[test]
fn a_drum_lifts_its_grains_by_friction_alone_and_works_against_their_weight() {
    let (angle, energy, _) = turned("0.0");
    assert!(angle.abs() < 1.0 && energy.walls == 0.0 && energy.sliding == 0.0, "{angle}°, {energy:?}");
    let mut last = angle;
    for friction in ["0.1", "0.3"] {
        let (angle, energy, lifted) = turned(friction);
        assert!(angle > last + 5.0, "{friction}: {angle}° and {last}°");
        assert!(energy.walls > 0.0 && energy.sliding < 0.0 && energy.shocks < 0.0, "{energy:?}");
        // All but what the angular momentum of the grains has changed by.
        assert!((energy.walls / lifted - 1.0).abs() < 0.05, "{friction}: {} and {lifted} J", energy.walls);
        assert!(energy.left_over <= 1e-12 * energy.moved, "{energy:?}");
        last = angle;
    }
}

/// A disc between two bumps, and one that rolls in a drum with it.
#[test]
fn bodies_hold_and_carry_a_disc_as_geometry_says() {
    let file = |name: &str| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    let settled = |name: &str, disc: &str, time_steps: u32| {
        let overrides =
            [("sample", format!("{{ kind = \"discs\", discs = [{disc}], density_kg_per_m2 = 1000.0 }}"))];
        let case = Case::read(&file(name), &overrides.map(|(key, value)| (key.into(), value))).unwrap();
        let mut march = March::<RoughDiscs>::new(&case).unwrap();
        for _ in 0..time_steps {
            march.time_step(&Nsgs::default(), &Stop { tolerance: 1e-12, ..STOP }).unwrap();
        }
        march
    };
    // Bumps of 0.1 m with their centres at 1 m and 1.2 m hold a disc of 0.2 m at √(0.3² − 0.1²).
    let held = settled("heap", "[1.1, 0.3, 0.2]", 300);
    let (_, place, velocity) = held.grains().next().unwrap();
    assert!((place - Vector2::new(1.1, 0.08_f64.sqrt())).norm() < 1e-9 && velocity.norm() < 1e-9, "{place}");
    // In a drum of radius R that turns at Ω a disc of radius r rolls: where its centre turns at φ' about the axis, its own spin is
    // (Ω R − φ' (R − r))/r. It swings about the bottom as a pendulum does, so at Ω R/r only when φ' = 0.
    let geared = settled("drum", "[0.0, -1.5, 0.5]", 2000);
    let (spin, (_, place, velocity)) = (geared.velocity()[0].z, geared.grains().next().unwrap());
    let along = place.perp(&velocity) / place.norm();
    assert!(along.abs() > 1e-3, "it swings: {along} m/s");
    assert!((spin - (0.07 * 2.0 - along) / 0.5).abs() < 1e-3, "{spin} rad/s, {along} m/s");
}

fn spheres(name: &str, overrides: &[(&str, &str)]) -> March<RoughSpheres> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    March::new(&Case::read(&file, &overrides).unwrap()).unwrap()
}

/// Mass below a height (kg).
fn below(march: &March<RoughSpheres>, height: f64) -> f64 {
    let grains = march.mass().iter().zip(march.grains());
    grains.filter(|(_, (_, x, _))| x.y < height).map(|(m, _)| m.mass).sum()
}

/// Beverloo's law: W = C ρ_b √g (D − k d)^(5/2), with k = 1.4 and C between 0.55 and 0.65 in experiments of spheres.
#[test]
fn sphere_hopper_flows_at_the_rate_of_beverloo_whatever_the_height_above() {
    let mut hopper = spheres("sphere-hopper", &[]);
    let mut at = |time_step: u64| {
        while hopper.time_steps() < time_step {
            let (_, seen) = hopper.time_step(&Nsgs::default(), &STOP).unwrap();
            assert!((seen.shape.passed_mass - below(&hopper, 1.2)).abs() < 1e-9, "{:?}", seen.shape);
        }
        // The bed from 2 to 6 diameters above the bottom.
        (below(&hopper, 1.2), (below(&hopper, 1.8) - below(&hopper, 1.4)) / (0.4 * 1.6 * 1.6))
    };
    let (before, _) = at(60);
    assert_eq!(before, 0.0, "the gate holds all");
    let [first, second, third] = [120, 180, 240].map(&mut at);
    let coefficient = |(from, _): (f64, f64), (to, density): (f64, f64)| {
        let rate = (to - from) / (60.0 * 0.005);
        let (opening, diameter) = (0.6, 0.1);
        rate / (density * 9.81_f64.sqrt() * (opening - 1.4_f64 * diameter).powf(2.5))
    };
    let [early, late] = [coefficient(first, second), coefficient(second, third)];
    assert!([early, late].iter().all(|c| (0.5..=0.7).contains(c)), "C = {early}, then {late}");
    assert!((early / late - 1.0).abs() < 0.15, "C = {early}, then {late}");
}

/// A drum of spheres: its mean angle, from the axis to the centre of mass (°), over each of some turns.
fn sphere_drum(turns: &[f64]) -> Vec<f64> {
    let mut drum = spheres("sphere-drum", &[("sample.grains", "250"), ("sample.depth_m", "0.3")]);
    let axis = Vector3::new(0.7, 1.0, 0.0);
    let mean = |turn: &f64| {
        let (mut sum, mut count) = (0.0, 0);
        while (drum.time_steps() as f64) < turn * std::f64::consts::TAU / (0.443 * 0.005) {
            let (_, seen) = drum.time_step(&Nsgs::default(), &STOP).unwrap();
            let weights: f64 = drum.mass().iter().map(|m| m.mass).sum();
            let grains = drum.mass().iter().zip(drum.grains());
            let centre = grains.map(|(m, (_, x, _))| x * m.mass).sum::<Vector3<f64>>() / weights - axis;
            sum += centre.x.atan2(-centre.y).to_degrees();
            assert!((seen.shape.bed_angle - centre.x.atan2(-centre.y)).abs() < 1e-9, "{:?}", seen.shape);
            count += 1;
            // What sinks by this much comes back; grains of 0.045 m and more that sank for ever would be deeper within a second.
            assert!(seen.greatest_overlap < 0.01 * 0.045, "{} m", seen.greatest_overlap);
            assert!(drum.grains().all(|(_, x, _)| (0.0..=0.5).contains(&x.z)), "between the ends");
        }
        sum / f64::from(count)
    };
    turns.iter().map(mean).collect()
}

#[test]
fn sphere_drum_lifts_its_spheres_and_none_sinks_into_it() {
    let angles = sphere_drum(&[0.2, 0.3]);
    assert!(angles[1] > 15.0 && angles[1] < 40.0, "{angles:?}");
}

#[test]
#[ignore = "takes minutes"]
fn sphere_drum_keeps_its_angle_over_two_turns_and_no_sphere_sinks_into_it() {
    let angles = sphere_drum(&[0.25, 1.0, 2.0]);
    assert!(angles[2] > 10.0 && (angles[2] - angles[1]).abs() < 2.0, "{angles:?}");
}
