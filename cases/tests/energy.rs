//! Where the energy of a march goes, against what mechanics says of it.

use cases::{Case, Energy, March, Marched};
use contact::{Discs, Measure, RoughDiscs};
use nsgs::Nsgs;
use runner::Stop;
use std::path::PathBuf;

const G: f64 = 10.0;

fn case(name: &str, overrides: &[(&str, &str)]) -> Case {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    Case::read(&folder.join(name).with_extension("toml"), &overrides).unwrap()
}

/// The energy of so many time steps, and the kinetic energy after them (J); each balance closes.
fn marched<M: Marched>(case: &Case, time_steps: u32, tolerance: f64) -> (Energy, f64)
where
    Nsgs: contact::Solver<M>,
{
    let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: 100_000 };
    let mut march = March::<M>::new(case).unwrap();
    let (mut all, mut kinetic) = (Energy::default(), 0.0);
    for _ in 0..time_steps {
        let (_, seen) = march.time_step(&Nsgs::default(), &stop).unwrap();
        all += seen.energy;
        kinetic = seen.kinetic_energy;
    }
    (all, kinetic)
}

fn assert_close(is: f64, expected: f64, what: &str) {
    assert!((is - expected).abs() <= 1e-10 * expected.abs().max(1.0), "{what}: {is} and {expected}");
}

/// 1000 kg/m² on a disc of 0.5 m (kg).
const MASS: f64 = 1000.0 * std::f64::consts::PI * 0.25;

#[test]
fn friction_takes_a_third_of_the_energy_of_a_thrown_disc() {
    // ½ m v₀² before, of which ⅓ rolls away: ½ m (⅔ v₀)² and as much again by half in the spin.
    let thrown = case("thrown-disc", &[("scene.gravity_m_per_s2", "10.0")]);
    let (energy, kinetic) = marched::<RoughDiscs>(&thrown, 60, 1e-13);
    let first = 0.5 * MASS;
    assert_close(kinetic, 2.0 / 3.0 * first, "what rolls on");
    assert_close(energy.sliding, -first / 3.0, "what friction took");
    assert_eq!((energy.walls, energy.gap), (0.0, 0.0));
    assert!(energy.shocks.abs() < 1e-12 * first, "{energy:?}");
}

#[test]
fn half_of_a_belts_work_is_in_the_disc_and_half_is_lost() {
    // μ m g acts until the disc moves at U/3: the belt gives m U²/3, the disc and its spin keep half.
    let belt = case("belt", &[("sample.discs", "[[0.0, 0.5, 0.5]]")]);
    let (energy, kinetic) = marched::<RoughDiscs>(&belt, 40, 1e-13);
    let given = MASS * 0.25 / 3.0;
    assert_close(energy.walls, given, "the belt's work");
    assert_close(kinetic, 0.5 * given, "what the disc has");
    assert_close(energy.sliding, -0.5 * given, "what friction took");
}

#[test]
fn a_disc_that_falls_loses_its_height_in_the_shock_and_in_the_gap_that_closes() {
    let falls = case(
        "thrown-disc",
        &[
            ("scene.gravity_m_per_s2", "10.0"),
            ("scene.thrown_at_m_per_s", "[0.0, 0.0]"),
            ("sample.discs", "[[0.0, 0.75, 0.5]]"),
        ],
    );
    let (energy, kinetic) = marched::<RoughDiscs>(&falls, 100, 1e-13);
    assert!(kinetic < 1e-12 * MASS, "it lies: {kinetic:e} J");
    assert_close(energy.shocks + energy.gap, -MASS * G * 0.25, "what the floor took");
    assert!(energy.shocks < 0.0 && energy.gap <= 0.0 && energy.walls == 0.0, "{energy:?}");
}

#[test]
fn balances_close_to_round_off_whatever_the_solver_leaves() {
    let shaken = case("shaken-box", &[]);
    let rough = case("rough-box", &[]);
    for tolerance in [1e-1, 1e-4] {
        for (energy, friction) in [
            (marched::<Discs>(&shaken, 60, tolerance).0, false),
            (marched::<RoughDiscs>(&rough, 60, tolerance).0, true),
        ] {
            assert!(energy.left_over <= 1e-12 * energy.moved, "{energy:?}");
            assert_eq!(energy.sliding != 0.0, friction, "{energy:?}");
            assert_eq!(energy.walls != 0.0, !friction, "the floor that shakes: {energy:?}");
        }
    }
    // Another θ takes energy by itself.
    let damped = case("shaken-box", &[("scene.theta", "1.0")]);
    let (energy, _) = marched::<Discs>(&damped, 60, 1e-4);
    assert!(energy.left_over > 1e-6 * energy.moved, "{energy:?}");
}
