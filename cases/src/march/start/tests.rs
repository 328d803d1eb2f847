use super::Start;
use crate::{Case, March};
use cg::Cg;
use contact::{Discs, Measure};
use runner::Stop;
use std::path::Path;

const TIGHT: Stop = Stop { on: Measure::NaturalMap, tolerance: 1e-13, max_iterations: 1000 };
const LOOSE: Stop = Stop { tolerance: 1e-10, ..TIGHT };

/// A column at rest after two time steps under each `gravity`, before one under the third: its impulses (N·s) are as gravity is.
fn column(gravity: [f64; 3]) -> March {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("column.toml");
    let mut march = March::<Discs>::new(&Case::read(&path, &[]).unwrap()).unwrap();
    for g in &gravity[..2] {
        march.scene.gravity_m_per_s2 = *g;
        march.time_step(&solver(), &TIGHT).unwrap();
    }
    march.scene.gravity_m_per_s2 = gravity[2];
    march
}

fn solver() -> Cg {
    Cg::preconditioned()
}

#[test]
fn impulses_that_grow_linearly_are_known_before_any_iteration() {
    let iterations = |start| {
        let mut march = column([2.0, 5.0, 8.0]);
        let next = march.next().unwrap();
        march.solve(&next, &solver(), &LOOSE, start, &|| false).unwrap().0.iterations
    };
    assert_eq!(iterations(Start::Extrapolated), 0);
    assert!(iterations(Start::Previous) > 0 && iterations(Start::Nothing) > 0);
}

#[test]
fn contacts_that_would_pull_begin_from_nothing_and_young_ones_from_what_they_have() {
    let march = column([8.0, 2.0, 2.0]);
    let next = march.next().unwrap();
    assert!(march.start(&next, Start::Extrapolated).iter().all(|r| *r == 0.0));
    let mut young = march.clone();
    young.before.truncate(5);
    let [start, previous] = [Start::Extrapolated, Start::Previous].map(|start| young.start(&next, start));
    assert!(previous.iter().all(|r| *r > 0.0));
    assert_eq!((&start[..5], &start[5..]), (&[0.0; 5][..], &previous[5..]));
}

#[test]
fn starts_are_read_as_truth_values_and_as_names_and_written_as_before() {
    let read = |text: &str| serde_json::from_str::<Start>(text);
    for (text, start, written) in [
        ("true", Start::Previous, "true"),
        ("\"previous\"", Start::Previous, "true"),
        ("\"nothing\"", Start::Nothing, "false"),
        ("\"extrapolated\"", Start::Extrapolated, "\"extrapolated\""),
    ] {
        assert_eq!(read(text).unwrap(), start);
        assert_eq!(serde_json::to_string(&start).unwrap(), written);
    }
    let error = read("\"warm\"").unwrap_err().to_string();
    assert!(error.contains("\"extrapolated\""), "{error}");
}
