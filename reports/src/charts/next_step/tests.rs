use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{read, simulated};
use results::simulation::Role;
use results::simulation::Simulated;

/// One run with so many iterations in its 100 time steps, and as many seconds.
fn from(start: &str, iterations: u64) -> Simulated {
    let mut one = simulated(Role::Run, 0.01, 1e-3);
    one.simulation.start = start.into();
    let totals = &mut one.simulation.totals;
    (totals.iterations, totals.setup_s, totals.iterating_s) = (iterations, 0.0, iterations as f64);
    one
}

#[test]
fn starts_are_compared_with_one_from_nothing_of_the_same_run() {
    let study = [from("nothing", 1000), from("previous", 500), from("extrapolated", 250)];
    let files = files(&parts(&read(&study)));
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["next-step.svg", "next-step.csv", "next-step.md", "next-step.tex"]);
    let rows: Vec<&str> = files[1].1.lines().collect();
    assert!(rows[1].ends_with(",1.0,1.0") && rows[2].ends_with(",0.5,0.5"), "{rows:?}");
    assert!(rows[3].ends_with(",0.25,0.25"), "{rows:?}");
    assert!(!files[0].1.contains("Not drawn"), "{}", files[0].1);
}

#[test]
fn run_that_missed_its_tolerance_is_not_compared() {
    let mut study = [from("nothing", 1000), from("previous", 500), from("extrapolated", 250)];
    study[0].simulation.totals.missed_time_steps = 11;
    let text = &files(&parts(&read(&study)))[0].1;
    assert!(
        text.contains("in a time step or have nothing to be compared with: 1.") && text.contains("no value"),
        "{text}"
    );
    // Of another tolerance, time step or method there is nothing to compare with either.
    study[0].simulation.totals.missed_time_steps = 0;
    study[0].simulation.tolerance = 1e-2;
    assert!(over_nothing(&read(&study), &read(&study)[2], COSTS[0].1).is_none());
}
