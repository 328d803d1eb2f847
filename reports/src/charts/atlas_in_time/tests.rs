use results::simulation::{Observed, Simulated};

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{exploded, read, simulated, with};

fn reference() -> Simulated {
    simulated("reference", 0.01, 1e-9)
}

fn run(change: impl Fn(&mut Observed)) -> Simulated {
    with(simulated("run", 0.01, 1e-2), change)
}

fn class_of(change: impl Fn(&mut Observed)) -> Option<Class> {
    let all = read(&[reference(), run(change)]);
    class(&all[1], Some(&all[0]))
}

#[test]
fn simulation_like_its_reference_is_stable() {
    assert_eq!(class_of(|_| {}), Some(Class::Stable));
    let all = read(&[reference()]);
    assert_eq!(class(&all[0], Some(&all[0])), Some(Class::Stable));
}

#[test]
fn sinking_rising_and_overlapping_grains_creep() {
    // 0.05 mean diameters are 5 mm.
    for by in [-0.006, 0.006] {
        assert_eq!(class_of(|row| row.mean_height_m += by), Some(Class::Creeping));
    }
    assert_eq!(class_of(|row| row.greatest_overlap_m = 0.006), Some(Class::Creeping));
    assert_eq!(class_of(|row| row.mean_height_m -= 0.004), Some(Class::Stable));
    assert_eq!(class_of(|row| row.greatest_overlap_m = 0.004), Some(Class::Stable));
}

#[test]
fn first_half_of_the_time_is_not_judged() {
    let settles = |row: &mut Observed| {
        if row.time_s < 0.45 {
            row.mean_height_m += 1.0;
            row.kinetic_energy_j = 1e3;
        }
    };
    assert_eq!(class_of(settles), Some(Class::Stable));
}

#[test]
fn grains_that_move_more_than_the_reference_jitter() {
    // Free fall over 0.01 s gives 0.1 m/s; a tenth of it, and 10 kg, 0.5 mJ.
    assert_eq!(class_of(|row| row.kinetic_energy_j = 0.4e-3), Some(Class::Stable));
    assert_eq!(class_of(|row| row.kinetic_energy_j = 0.6e-3), Some(Class::Jittering));
    // Beside a reference that moves, twice its energy is the limit.
    let moving = with(reference(), |row| row.kinetic_energy_j = 1.0);
    let beside = |energy: f64| {
        let all = read(&[moving.clone(), run(|row| row.kinetic_energy_j = energy)]);
        class(&all[1], Some(&all[0]))
    };
    assert_eq!(beside(1.9), Some(Class::Stable));
    assert_eq!(beside(2.1), Some(Class::Jittering));
}

#[test]
fn explosion_needs_no_reference_and_all_else_does() {
    let all = read(&[exploded(run(|_| {})), run(|_| {})]);
    assert_eq!(class(&all[0], None), Some(Class::Exploded));
    assert_eq!(class(&all[1], None), None);
}

#[test]
fn what_made_a_simulation_explode_has_a_class_of_its_own() {
    let because = |status: &str| {
        let mut one = exploded(run(|_| {}));
        one.simulation.status = status.into();
        one.simulation.scene = status.into();
        one
    };
    let all = [reference(), because("solver-diverged"), because("no-solution")];
    let classes: Vec<_> = read(&all).iter().map(|s| class(s, None)).collect();
    assert_eq!(classes, [None, Some(Class::SolverDiverged), Some(Class::NoSolution)]);
    let files = files(&parts(&read(&all)));
    let letters = |letter: &str| files[0].1.matches(&format!("\n{letter}\n")).count();
    assert_eq!(["x", "n", "d"].map(letters), [1, 2, 2], "{}", files[0].1);
    assert!(files[1].1.contains("0 exploded, 1 no solution, 1 solver diverged.\n"), "{}", files[1].1);
}

#[test]
fn matrix_has_the_letter_of_each_class_and_sentences_count_them() {
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
            "atlas-in-time-found.md",
            "atlas-in-time.csv",
            "atlas-in-time.md",
            "atlas-in-time.tex"
        ]
    );
    let letters = |letter: &str| files[0].1.matches(&format!("\n{letter}\n")).count();
    // Each once in the matrix, and once in the key; the cold run on the other scene was not made.
    assert_eq!(["s", "j", "c", "x", "–"].map(letters), [2, 1, 2, 2, 2], "{}", files[0].1);
    let text = &files[1].1;
    assert!(
        text.starts_with("Of 3\u{a0}simulations: 1 stable, 0 jittering, 1 creeping, 1 exploded.\n"),
        "{text}"
    );
    assert!(
        text.contains(
            "Of 1\u{a0}pair that differ in their start alone, the cold one is of a worse class in 1"
        )
    );
}

#[test]
fn study_without_simulations_is_drawn() {
    assert_eq!(files(&parts(&read(&[]))).len(), 5);
}
