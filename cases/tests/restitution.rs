//! Shocks that give part of their speed back.

use cases::{Case, Energy, March};
use contact::{Discs, Measure};
use nsgs::Nsgs;
use runner::Stop;
use std::path::Path;

fn march(name: &str, overrides: &[(&str, &str)]) -> March {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("{name}.toml"));
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    let made = Case::read(&path, &overrides).and_then(|case| March::<Discs>::new(&case));
    made.unwrap_or_else(|error| panic!("{error}"))
}

/// Marches one time step, solved to round-off, and gives what became of its energy (J).
fn time_step(march: &mut March) -> Energy {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-13, max_iterations: 100_000 };
    march.time_step(&Nsgs::default(), &stop).unwrap_or_else(|error| panic!("{error}")).1.energy
}

fn speeds(march: &March) -> Vec<f64> {
    march.velocity().iter().map(|v| v.y).collect()
}

#[test]
fn each_bounce_leaves_the_part_e_of_the_speed() {
    for e in [0.0, 0.5, 0.9, 1.0] {
        let mut march = march("bounce", &[("scene.restitution", &e.to_string())]);
        let mut energy = Energy::default();
        let (mut work, mut shocks) = (0.0, 0);
        for _ in 0..1500 {
            let (before, mass) = (speeds(&march)[0], march.mass()[0]);
            energy += time_step(&mut march);
            let after = speeds(&march)[0];
            // The floor pushed.
            if after > before - 9.81 * 0.001 + 1e-12 {
                assert!((after + e * before).abs() < 1e-12, "{before} to {after} with e = {e}");
                let impulse = mass * (9.81 * 0.001 - (1.0 + e) * before);
                work += 0.5 * impulse * (1.0 - e) * before;
                shocks += 1;
            }
        }
        assert!(shocks > 1, "{shocks}");
        // A shock takes ½ r (v⁺ + v⁻), and its impulse carries the weight over the time step as well.
        assert!((energy.shocks - work).abs() < 1e-12 * energy.moved, "{energy:?}, {work}");
        assert!(energy.left_over < 1e-12 * energy.moved, "{energy:?}");
        assert!(energy.walls.abs() < 1e-12 * energy.moved, "{energy:?}");
        assert_eq!((energy.gap, energy.sliding), (0.0, 0.0));
    }
}

#[test]
fn shocks_that_meet_share_as_newtons_law_says_and_one_after_the_other_as_a_cradle_does() {
    let mut touching = march("cradle", &[]);
    time_step(&mut touching);
    for (speed, thirds) in speeds(&touching).iter().zip([-2.0, -2.0, 1.0]) {
        assert!((speed - thirds / 3.0).abs() < 1e-12, "{speed}");
    }
    let discs = "[[0.0, 0.5, 0.5], [0.0, 1.502, 0.5], [0.0, 2.502, 0.5]]";
    let mut apart = march("cradle", &[("sample.discs", discs)]);
    for _ in 0..10 {
        time_step(&mut apart);
    }
    for (speed, expected) in speeds(&apart).iter().zip([-1.0, 0.0, 0.0]) {
        assert!((speed - expected).abs() < 1e-12, "{speed}");
    }
}

#[test]
fn a_packing_in_free_flight_keeps_its_energy_if_shocks_are_elastic_and_never_gains() {
    for (e, keeps) in [("0.3", false), ("0.8", false), ("1.0", true)] {
        let of_impact =
            [("scene.law", "newton"), ("scene.restitution", e), ("scene.gravity_m_per_s2", "0.0")];
        let mut march = march("impact", &of_impact);
        let kinetic = |march: &March| {
            let parts = march.velocity().iter().zip(march.mass()).map(|(v, m)| 0.5 * m * v.norm_squared());
            parts.sum::<f64>()
        };
        let first = kinetic(&march);
        for _ in 0..20 {
            let before = kinetic(&march);
            time_step(&mut march);
            assert!(kinetic(&march) <= before * (1.0 + 1e-9), "{before} to {} with e = {e}", kinetic(&march));
        }
        let left = kinetic(&march) / first;
        assert_eq!((left - 1.0).abs() < 1e-9, keeps, "{left} is left with e = {e}");
    }
}

#[test]
fn restitution_and_its_law_go_together() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("bounce.toml");
    let refused =
        |key: &str, value: &str| Case::read(&path, &[(key.into(), value.into())]).unwrap_err().to_string();
    assert!(refused("scene.restitution", "1.5").contains("`scene.restitution` is 1.5"));
    assert!(refused("scene.law", "iqs").contains("with the law `newton`"));
}
