use results::name::Name;
use results::simulation::SimulationEnding;
use results::simulation::{Observed, Simulated};

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{exploded, read, simulated, with};

fn reference() -> Simulated {
    simulated(Role::Reference, 0.01, 1e-9)
}

fn run(change: impl Fn(&mut Observed)) -> Simulated {
    with(simulated(Role::Run, 0.01, 1e-2), change)
}

fn class_of(change: impl Fn(&mut Observed)) -> Class {
    let all = read(&[reference(), run(change)]);
    Class::in_time(&all[1], Some(&all[0]))
}

#[test]
fn simulation_like_its_reference_is_stable() {
    assert_eq!(class_of(|_| {}), Class::Stable);
    let all = read(&[reference()]);
    assert_eq!(Class::in_time(&all[0], Some(&all[0])), Class::Stable);
}

#[test]
fn sinking_rising_and_overlapping_grains_creep() {
    // 0.05 mean diameters are 5 mm.
    for by in [-0.006, 0.006] {
        assert_eq!(class_of(|row| row.mean_height_m += by), Class::Creeping);
    }
    assert_eq!(class_of(|row| row.greatest_overlap_m = 0.006), Class::Creeping);
    assert_eq!(class_of(|row| row.mean_height_m -= 0.004), Class::Stable);
    assert_eq!(class_of(|row| row.greatest_overlap_m = 0.004), Class::Stable);
}

#[test]
fn first_half_of_the_time_is_not_judged() {
    let settles = |row: &mut Observed| {
        if row.time_s < 0.45 {
            row.mean_height_m += 1.0;
            row.kinetic_energy_j = 1e3;
        }
    };
    assert_eq!(class_of(settles), Class::Stable);
}

#[test]
fn grains_that_move_more_than_the_reference_jitter() {
    // Free fall over 0.01 s gives 0.1 m/s; a tenth of it, and 10 kg, 0.5 mJ.
    assert_eq!(class_of(|row| row.kinetic_energy_j = 0.4e-3), Class::Stable);
    assert_eq!(class_of(|row| row.kinetic_energy_j = 0.6e-3), Class::Jittering);
    // Beside a reference that moves, twice its energy is the limit.
    let moving = with(reference(), |row| row.kinetic_energy_j = 1.0);
    let beside = |energy: f64| {
        let all = read(&[moving.clone(), run(|row| row.kinetic_energy_j = energy)]);
        Class::in_time(&all[1], Some(&all[0]))
    };
    assert_eq!(beside(1.9), Class::Stable);
    assert_eq!(beside(2.1), Class::Jittering);
}

#[test]
fn explosion_needs_no_reference_and_all_else_does() {
    let all = read(&[exploded(run(|_| {})), run(|_| {})]);
    assert_eq!(Class::in_time(&all[0], None), Class::Exploded);
    assert_eq!(Class::in_time(&all[1], None), Class::Unjudged);
}

#[test]
fn what_made_a_simulation_explode_has_a_class_of_its_own() {
    let because = |status: SimulationEnding| {
        let mut one = exploded(run(|_| {}));
        one.simulation.status = status;
        one.simulation.scene = status.name().into();
        one
    };
    let all = [reference(), because(SimulationEnding::SolverDiverged), because(SimulationEnding::NoSolution)];
    let classes: Vec<_> = read(&all).iter().map(|s| Class::in_time(s, None)).collect();
    assert_eq!(classes, [Class::Unjudged, Class::SolverDiverged, Class::NoSolution]);
    let files = files(&parts(&read(&all)));
    let letters = |letter: &str| files[0].1.matches(&format!("\n{letter}\n")).count();
    assert_eq!(["x", "n", "d"].map(letters), [0, 2, 2], "{}", files[0].1);
    assert!(files[1].1.ends_with(",0,0,0,0,1,1\n"), "{}", files[1].1);
}

#[test]
fn grid_has_the_letter_of_each_class_and_a_table_counts_them() {
    let mut cold = run(|row| row.mean_height_m -= 0.01);
    cold.simulation.warm_start = false;
    let mut other = exploded(run(|_| {}));
    other.simulation.scene = "other".into();
    let files = files(&parts(&read(&[reference(), run(|_| {}), cold, other])));
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "atlas-in-time.svg",
            "atlas-in-time-counts.csv",
            "atlas-in-time-counts.md",
            "atlas-in-time-counts.tex",
            "atlas-in-time.csv",
            "atlas-in-time.md",
            "atlas-in-time.tex"
        ]
    );
    let letters = |letter: &str| files[0].1.matches(&format!("\n{letter}\n")).count();
    // Each once in the grid, and once in the key; the cold run on the other scene was not made.
    assert_eq!(["s", "j", "k", "x", "–"].map(letters), [2, 0, 2, 2, 2], "{}", files[0].1);
    let counted = "method,settings,stable,jittering,creeping,exploded,no_solution,solver_diverged\nnsgs,2,1,0,1,1,0,0\n";
    assert_eq!(files[1].1, counted);
}

#[test]
fn study_without_simulations_is_drawn() {
    assert_eq!(files(&parts(&read(&[]))).len(), 7);
}
