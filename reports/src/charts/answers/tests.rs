use results::simulation::{Role, Simulated};

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{exploded, read, simulated, with};
use results::settings::{CASE, FRICTION};

/// A packing of `case` at rest at so many mean diameters.
fn at_rest(case: &str, seed: u32, friction: f64, height: f64) -> Simulated {
    let mut one = simulated(Role::Run, 0.01, 1e-4);
    let diameter = one.simulation.mean_diameter_m;
    one = with(one, |row| row.mean_height_m = height * diameter);
    one.simulation.scene = format!("{case} seed={seed} friction={friction}");
    one.simulation.scene_settings.insert(CASE.to_owned(), case.into());
    one.simulation.scene_settings.insert(FRICTION.to_owned(), friction.into());
    one.simulation.scene_settings.insert("sample.seed".to_owned(), seed.into());
    one
}

/// Five packings of a case are one row for each answer; one that exploded is not among them.
#[test]
fn answers_are_medians_over_packings() {
    let mut all: Vec<Simulated> = (1..)
        .zip([3.9, 3.95, 4.0, 4.05, 4.1])
        .map(|(seed, height)| at_rest("box", seed, 0.3, height))
        .collect();
    all[0].simulation.totals.missed_time_steps = 2;
    all.push(exploded(at_rest("box", 6, 0.3, 400.0)));
    all.push(at_rest("pile", 1, 0.3, 7.0));
    let parts = parts(&read(&all));
    let files = files(&parts);
    let csv = &files.iter().find(|(name, _)| name == "answers.csv").unwrap().1;
    let row = csv.lines().find(|line| line.contains("box,0.3,5,1,height_mean_diameters")).unwrap();
    let numbers: Vec<f64> = row.split(',').skip(5).map(|number| number.parse().unwrap()).collect();
    assert!(
        (numbers[0] - 4.0).abs() < 1e-9 && (numbers[1] - 3.9).abs() < 1e-9 && (numbers[2] - 4.1).abs() < 1e-9,
        "{row}"
    );
    assert!(csv.contains("pile,0.3,1,0,height_mean_diameters,7"), "{csv}");
}
