use results::simulation::{Simulated, Stress};

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{exploded, read, simulated, with};

/// A packing whose friction is first another one, and then `friction` ± `spread`.
fn sheared(grains: f64, tolerance: f64, friction: f64, spread: f64) -> Simulated {
    let mut one = with(simulated("run", 0.01, tolerance), |row| {
        let k = row.time_step / 10;
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let ratio = if k > 5 { friction + sign * spread } else { 5.0 };
        row.stress = Stress { stress_xy_n_per_m: -2.0 * ratio, stress_yy_n_per_m: 2.0, ..Stress::default() };
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
    let still = simulated("run", 0.01, 1e-4);
    let all = read(&[exploded(sheared(0.3, 1e-1, 0.2, 0.0)), still, sheared(0.3, 1e-4, 0.25, 0.0)]);
    assert!(flow(&all[0]).is_none() && flow(&all[1]).is_none());
    let files = files(&parts(&all));
    let found = &files.iter().find(|(name, _)| name == "macroscopic-found.md").unwrap().1;
    assert!(found.contains("2 of 3 simulations say nothing"), "{found}");
}

#[test]
fn the_tolerance_that_is_enough_is_the_loosest_before_friction_changes() {
    let all = read(&[
        sheared(0.3, 1e-6, 0.25, 0.01),
        sheared(0.3, 1e-3, 0.2505, 0.01),
        sheared(0.3, 1e-1, 0.15, 0.01),
        sheared(0.0, 1e-6, 0.1, 0.01),
        sheared(0.0, 1e-1, 0.1, 0.01),
    ]);
    let files = files(&parts(&all));
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert!(names.contains(&"macroscopic.svg") && names.contains(&"macroscopic.csv"), "{names:?}");
    let found = &files.iter().find(|(name, _)| name == "macroscopic-found.md").unwrap().1;
    assert!(found.contains("μ = 0.3: the packing has a friction of 0.252"), "{found}");
    assert!(found.contains("a tolerance of 10⁻³ is enough; one of 0.10 is off by 0.10"), "{found}");
    assert!(found.contains("no tolerance up to 0.10 changes it by more"), "{found}");
}

#[test]
fn a_tolerance_that_only_itself_stays_near_is_not_called_enough() {
    // That the loosest is near again is chance.
    let three = [(1e-6, 0.25), (1e-3, 0.4), (1e-1, 0.25)];
    let all = read(&three.map(|(tolerance, friction)| sheared(0.3, tolerance, friction, 0.01)));
    let files = files(&parts(&all));
    let found = &files.iter().find(|(name, _)| name == "macroscopic-found.md").unwrap().1;
    assert!(found.contains("already one of 10⁻³ is off by 0.15"), "{found}");
    assert!(!found.contains("is enough"), "{found}");
}

#[test]
fn one_that_mostly_missed_its_tolerance_was_not_solved_to_it() {
    let mut missed = sheared(0.3, 1e-6, 0.4, 0.01);
    missed.simulation.totals.missed_time_steps = missed.simulation.totals.time_steps;
    let all = read(&[missed, sheared(0.3, 1e-3, 0.25, 0.01), sheared(0.3, 1e-1, 0.25, 0.01)]);
    let files = files(&parts(&all));
    let found = &files.iter().find(|(name, _)| name == "macroscopic-found.md").unwrap().1;
    assert!(
        found.contains("when solved to 10⁻³") && found.contains("1 of 3 simulations are left out"),
        "{found}"
    );
}

#[test]
fn one_tolerance_alone_says_nothing_of_others() {
    let files = files(&parts(&read(&[sheared(0.3, 1e-3, 0.25, 0.01)])));
    let found = &files.iter().find(|(name, _)| name == "macroscopic-found.md").unwrap().1;
    assert!(found.contains("no other tolerance was met") && !found.contains("no tolerance up to"), "{found}");
}

#[test]
fn packings_that_differ_in_their_seed_are_one_place_with_a_standard_error() {
    let all = read(&[0.2, 0.25, 0.3].map(|friction| sheared(0.3, 1e-3, friction, 0.0)));
    let merged = over_packings(super::sheared(&all));
    assert_eq!((merged.len(), merged[0].packings), (1, 3));
    assert!((merged[0].flow.friction - 0.25).abs() < 1e-12, "{}", merged[0].flow.friction);
    assert!((merged[0].flow.drift - 0.05 / 3.0_f64.sqrt()).abs() < 1e-12, "{}", merged[0].flow.drift);
    let files = files(&parts(&all));
    let found = &files.iter().find(|(name, _)| name == "macroscopic-found.md").unwrap().1;
    assert!(
        found.contains("(mean of 1\u{a0}method and 3 packings") && found.contains("the standard error"),
        "{found}"
    );
    let table = &files.iter().find(|(name, _)| name == "macroscopic.csv").unwrap().1;
    assert_eq!(table.lines().count(), 4, "{table}");
}
