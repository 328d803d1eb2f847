use results::simulation::{Role, Simulated};

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{read, simulated};

/// A column of 20 diameters; the share of its weight that the floor bears grows by `each` in a time step.
fn growing(each: f64) -> Simulated {
    let mut one = simulated(Role::Run, 0.1, 1e-4);
    let weight = one.simulation.mass_kg * one.simulation.gravity_m_per_s2;
    for (n, row) in one.series.iter_mut().enumerate() {
        row.time_s = 0.1 * n as f64;
        row.mean_height_m = 10.0 * one.simulation.mean_diameter_m;
        row.floor_impulse_n_s = each * n as f64 * weight * 0.1;
    }
    one
}

#[test]
fn speed_is_height_over_the_time_until_half_the_weight_is_borne() {
    let mut shaken = growing(0.2);
    shaken.series[1].floor_impulse_n_s *= 8.0;
    let all = read(&[growing(0.2), shaken, growing(0.01)]);
    assert!(
        (speed(&all[0]).unwrap() - 20.0 / 5.0).abs() < 1e-9,
        "after five time steps: {:?}",
        speed(&all[0])
    );
    assert_eq!(speed(&all[1]), None, "1.6 weights in the first time step");
    assert_eq!(speed(&all[2]), None, "it never bore the weight");
    let csv = &files(&parts(&all)).iter().find(|(name, _)| name == "sound.csv").unwrap().1.clone();
    assert_eq!(csv.lines().count(), 2, "{csv}");
    assert!(files(&parts(&[])).iter().all(|(name, _)| name != "sound.svg"));
}
