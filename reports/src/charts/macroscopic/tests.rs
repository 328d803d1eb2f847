use results::simulation::Role;
use results::simulation::{Simulated, Stress};

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{exploded, read, simulated, with};
use results::settings::FRICTION;

/// A packing whose friction is first another one, and then `friction` ± `spread`.
fn sheared(grains: f64, tolerance: f64, friction: f64, spread: f64) -> Simulated {
    let mut one = with(simulated(Role::Run, 0.01, tolerance), |row| {
        let k = row.time_step / 10;
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let ratio = if k > 5 { friction + sign * spread } else { 5.0 };
        row.stress = Stress { xy: -2.0 * ratio, yy: 2.0, ..Stress::default() };
    });
    one.simulation.scene_settings.insert(FRICTION.to_owned(), grains.into());
    one
}

#[test]
fn friction_is_the_mean_ratio_of_the_second_half_with_its_spread() {
    // Five rows: + − + − +.
    let all = read(&[sheared(0.3, 1e-4, 0.25, 0.05)]);
    let flow = flow(&all[0]).unwrap();
    assert!((flow.friction - 0.26).abs() < 1e-12, "{}", flow.friction);
    assert!((flow.spread - 0.05 * 0.96_f64.sqrt()).abs() < 1e-12, "{}", flow.spread);
    // (0.3 + 0.2)/2, and (0.3 + 0.2 + 0.3)/3.
    assert!((flow.drift - 0.05 / 3.0).abs() < 1e-12, "{}", flow.drift);
}

#[test]
fn one_that_exploded_or_is_not_pressed_says_nothing_and_is_told() {
    let still = simulated(Role::Run, 0.01, 1e-4);
    let all = read(&[exploded(sheared(0.3, 1e-1, 0.2, 0.0)), still, sheared(0.3, 1e-4, 0.25, 0.0)]);
    assert!(flow(&all[0]).is_none() && flow(&all[1]).is_none());
    let files = files(&parts(&all));
    assert!(files[0].1.contains("time step missed: 2."), "{}", files[0].1);
}

#[test]
fn one_that_missed_its_tolerance_once_was_not_solved_to_it() {
    let mut missed = sheared(0.3, 1e-6, 0.4, 0.01);
    missed.simulation.totals.missed_time_steps = 1;
    let all = read(&[missed, sheared(0.3, 1e-3, 0.25, 0.01), sheared(0.3, 1e-1, 0.25, 0.01)]);
    let files = files(&parts(&all));
    assert!(files[0].1.contains("time step missed: 1."), "{}", files[0].1);
}

/// Packings of a seed each at two tolerances, whose friction differs by so much at the coarser.
fn verdict(differences: &[f64]) -> &'static str {
    let of_seed = |(seed, difference): (usize, &f64)| {
        [(1e-4, 0.0), (1e-2, *difference)].map(|(tolerance, more)| {
            // Packings differ from each other by more than tolerances do.
            let mut one = sheared(0.3, tolerance, 0.25 + 0.02 * seed as f64 + more, 0.0);
            one.simulation.scene = format!("shear seed={seed}");
            one
        })
    };
    let all = read(&differences.iter().enumerate().flat_map(of_seed).collect::<Vec<_>>());
    let differences = super::differences(&super::sheared(&all));
    assert_eq!(differences.len(), 1);
    differences[0].verdict()
}

#[test]
fn tolerance_is_enough_where_packing_by_packing_nothing_changes() {
    assert_eq!(verdict(&[0.0, 0.001, -0.001, 0.0005, -0.0005]), "equivalent");
    assert_eq!(verdict(&[0.01, -0.012, 0.011, -0.01, 0.02]), "not resolved");
    assert_eq!(verdict(&[0.03, 0.031, 0.029, 0.03, 0.0305]), "differs");
    // A difference that shows and does not matter.
    assert_eq!(verdict(&[0.002, 0.0021, 0.0019, 0.002, 0.0021]), "equivalent");
    assert_eq!(verdict(&[0.0; 4]), "fewer than five packings");
}

#[test]
fn means_are_over_the_packings_that_met_their_tolerance() {
    let mut all: Vec<Simulated> =
        (0..5).map(|k| sheared(0.3, 1e-4, 0.24 + 0.005 * f64::from(k), 0.0)).collect();
    let mut missed = sheared(0.3, 1e-4, 9.0, 0.0);
    missed.simulation.totals.missed_time_steps = 1;
    all.push(missed);
    let files = files(&parts(&read(&all)));
    let csv = &files.iter().find(|(name, _)| name == "macroscopic-means.csv").unwrap().1;
    let row: Vec<&str> = csv.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(row[..5], ["nsgs", "0.3", "0.0001", "5", "1"], "{csv}");
    let [mean, low, high] = [5, 6, 7].map(|k| row[k].parse::<f64>().unwrap());
    // Standard error 0.005 √(2.5/5), Student's 2.776 of 4 degrees of freedom.
    assert!(
        (mean - 0.25).abs() < 1e-12 && (high - low - 2.0 * 2.776 * 0.005 * 0.5_f64.sqrt()).abs() < 1e-4,
        "{csv}"
    );
}
