use results::simulation::Simulated;

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{exploded, read, simulated, with};

/// A reference, its twin, a floor, and runs at two time steps and two tolerances.
fn study() -> Vec<Simulated> {
    let off = |role, h, tolerance, by: f64| {
        with(simulated(role, h, tolerance), |row| {
            row.mean_height_m += by;
            row.floor_impulse_n_s *= 1.0 + by;
            row.kinetic_energy_j = 2.0 + by;
            row.greatest_overlap_m = by;
        })
    };
    vec![
        off(Role::Reference, 0.0025, 1e-10, 0.0),
        off(Role::Twin, 0.0025, 1e-9, 1e-9),
        off(Role::Floor, 0.01, 1e-10, 1e-4),
        off(Role::Run, 0.01, 1e-1, 1e-2),
        off(Role::Run, 0.01, 1e-3, 1.2e-4),
        off(Role::Run, 0.01, 1e-4, 1.1e-4),
        exploded(off(Role::Run, 0.02, 1e-1, 1e-1)),
    ]
}

#[test]
fn reference_compared_with_itself_has_no_error() {
    let all = read(&study());
    assert_eq!(errors(&all[0], &all[0]), Some([0.0; 4]));
    // At rest the reference has no kinetic energy to measure errors with.
    let still = read(&[simulated(Role::Reference, 0.01, 1e-9)]);
    assert_eq!(errors(&still[0], &still[0]), Some([0.0; 4]));
}

#[test]
fn errors_have_the_scales_that_they_are_said_to_have() {
    let all = read(&study());
    let errors = errors(&all[3], &all[0]).unwrap();
    // Heights and overlaps are off by 0.01 m with a mean diameter of 0.1 m; impulses by a hundredth, energies by 0.01 of 2.
    for (error, expected) in errors.into_iter().zip([0.01, 0.005, 0.1, 0.1]) {
        assert!((error / expected - 1.0).abs() < 1e-9, "{error}, {expected} expected");
    }
}

#[test]
fn simulation_that_ended_early_has_no_error_and_is_told() {
    let all = read(&study());
    assert_eq!(errors(&all[6], &all[0]), None);
    let files = files(&parts(&read(&study())));
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["trajectory-box.svg", "trajectory.csv", "trajectory.md", "trajectory.tex"]);
    assert!(files[0].1.contains("did not come to the end: 1"));
    assert!(files[0].1.contains("d: mean diameter of the grains."));
    assert!(files[0].1.contains("from loose to tight: 0.10, 10⁻³, 10⁻⁴."), "{}", files[0].1);
}

#[test]
fn key_has_the_uncertainty_of_the_reference_only_where_its_line_is_drawn() {
    let key = "uncertainty of the reference";
    let drawn = |study: &[Simulated]| files(&parts(&read(study))).swap_remove(0).1.contains(key);
    // The references differ by far less than any run.
    assert!(!drawn(&study()));
    let mut near = study();
    near[1] = Simulated { ..near[2].clone() };
    near[1].simulation.role = Role::Twin;
    assert!(drawn(&near));
}

#[test]
fn study_without_reference_or_runs_has_its_table_alone() {
    for study in [&study()[3..], &[]] {
        let files = files(&parts(&read(study)));
        assert_eq!(files.len(), 3, "there is nothing to draw");
    }
}
