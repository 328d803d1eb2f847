use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{read, simulated};
use results::simulation::Simulated;

/// One run with so many iterations in its 100 time steps, and as many seconds.
fn from(start: &str, iterations: u64) -> Simulated {
    let mut one = simulated("run", 0.01, 1e-3);
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
    assert_eq!(
        names,
        ["next-step.svg", "next-step-found.md", "next-step.csv", "next-step.md", "next-step.tex"]
    );
    let text = &files[1].1;
    assert!(text.contains("previous impulses take 0.50 and extrapolated ones 0.25"), "{text}");
    assert!(text.contains("fewer seconds than previous impulses in 1 of 1"), "{text}");
}

#[test]
fn run_that_missed_its_tolerance_is_not_compared() {
    let mut study = [from("nothing", 1000), from("previous", 500), from("extrapolated", 250)];
    study[0].simulation.totals.missed_time_steps = 11;
    let files = files(&parts(&read(&study)));
    assert!(files[0].1.contains("nothing to compare"), "{}", files[0].1);
    // Of another tolerance, time step or method there is nothing to compare with either.
    study[0].simulation.totals.missed_time_steps = 0;
    study[0].simulation.tolerance = 1e-2;
    assert!(rows(&read(&study))[0].warm.iter().all(Option::is_none));
}
