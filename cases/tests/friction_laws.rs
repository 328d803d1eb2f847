//! Static beside dynamic friction: known answers of a block on a slope.

use cases::{Case, March, Marched};
use contact::{Measure, RoughDiscs, RoughSpheres, Solver, Vector};
use nsgs::Nsgs;
use runner::Stop;
use std::path::Path;

const STOP: Stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 100_000 };
const SLOPE: f64 = 0.4;
const DYNAMIC: f64 = 0.3;

/// Returns the speed of a block on a slope after each of so many time steps (m/s), thrown along it at `thrown` m/s, and g h (m/s).
fn speeds<M: Marched>(name: &str, ratio: f64, thrown: f64, time_steps: usize) -> (Vec<f64>, f64)
where
    Nsgs: Solver<M>,
{
    let settings = [
        ("scene.slope_rad", format!("{SLOPE}")),
        ("scene.friction", format!("{DYNAMIC}")),
        ("scene.static_friction_ratio", format!("{ratio}")),
        ("scene.thrown_at_m_per_s", format!("[{thrown:?}, 0.0]")),
    ];
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    let case = Case::read(&file, &settings.map(|(key, value)| (key.to_owned(), value))).unwrap();
    let mut march = March::<M>::new(&case).unwrap();
    let speed = |march: &mut March<M>| {
        march.time_step(&Nsgs::default(), &STOP).unwrap();
        march.velocity()[0].first()
    };
    let speeds = (0..time_steps).map(|_| speed(&mut march)).collect();
    (speeds, case.scene.gravity_m_per_s2 * case.scene.time_step_s)
}

/// A block at rest stands up to its static friction, whatever the dynamic one.
fn stands_by_static_friction<M: Marched>(name: &str)
where
    Nsgs: Solver<M>,
{
    let least = SLOPE.tan() / DYNAMIC;
    let after = |ratio: f64| {
        let (speeds, unit) = speeds::<M>(name, ratio, 0.0, 20);
        speeds[19] / unit
    };
    assert!(after(least * (1.0 + 1e-10)).abs() < 1e-12, "it stands");
    // Above by nothing: it begins to slide with its static friction, and is then held back by the dynamic one alone.
    let fallen = 19.0 * (SLOPE.sin() - DYNAMIC * SLOPE.cos());
    assert!((after(least * (1.0 - 1e-6)) / fallen - 1.0).abs() < 1e-5, "it falls");
}

/// A block that slides has its dynamic friction from the second time step on, even where static friction would hold it.
fn slides_with_dynamic_friction<M: Marched>(name: &str)
where
    Nsgs: Solver<M>,
{
    let (found, unit) = speeds::<M>(name, 2.0, 1.0, 20);
    let mut expected = 1.0;
    for (k, found) in found.iter().enumerate() {
        let friction = if k == 0 { 2.0 * DYNAMIC } else { DYNAMIC };
        expected += unit * (SLOPE.sin() - friction * SLOPE.cos());
        assert!((found / expected - 1.0).abs() < 1e-10, "{k}: {found} for {expected} m/s");
    }
}

#[test]
fn block_in_the_plane_has_static_friction_until_it_slides() {
    stands_by_static_friction::<RoughDiscs>("block-on-slope");
    slides_with_dynamic_friction::<RoughDiscs>("block-on-slope");
}

#[test]
fn block_in_space_has_static_friction_until_it_slides() {
    stands_by_static_friction::<RoughSpheres>("block-on-slope-in-space");
    slides_with_dynamic_friction::<RoughSpheres>("block-on-slope-in-space");
}

/// Thrown uphill it stops, and static friction holds it from then on.
#[test]
fn block_that_stops_is_held_by_static_friction() {
    let (found, unit) = speeds::<RoughDiscs>("block-on-slope", 2.0, -0.5, 60);
    let slowed = unit * (SLOPE.sin() + DYNAMIC * SLOPE.cos());
    assert!(found[2] > -0.5 + 3.0 * slowed - 1e-9 && found[2] < 0.0, "{}", found[2]);
    assert!(found[59].abs() < 1e-12, "{}", found[59]);
}

#[test]
fn ratio_below_one_is_refused() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("block-on-slope.toml");
    let setting = ("scene.static_friction_ratio".to_owned(), "0.5".to_owned());
    let error = Case::read(&file, &[setting]).unwrap_err().to_string();
    assert!(
        error.contains("`scene.static_friction_ratio` is 0.5: it must be at least 1 and finite"),
        "{error}"
    );
}
