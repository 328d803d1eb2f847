//! Maps and tables of small studies of search directions.

use results::schema::Ending;
use results::schema::Run;

use super::parts;
use crate::tests::assert_well_formed;
use crate::tests::fixture::{File, files, object, run, study};
use crate::text::csv;
use serde_json::{Value, json};

/// A run of `latin-dd` with directions as JSON, `null` for derived ones.
fn directed(id: u32, kappa_l: &str, kappa_d: &str, subdomains: u32, iterations: u64) -> Run {
    let kappa = |text: &str| serde_json::from_str::<Value>(text).unwrap();
    let settings = object(&json!({
        "kappa_l": kappa(kappa_l),
        "kappa_d": kappa(kappa_d),
        "kappa_l_plus": null,
        "relaxation": 0.8,
        "subdomains": format!("{subdomains}x1"),
    }));
    let derived = object(&json!({ "kappa_l_minus": 12.5, "kappa_d_minus": 12.5 }));
    Run { settings, derived, subdomains, iterations, ..run(id, "latin-dd", "", Ending::Converged) }
}

fn plane() -> Vec<Run> {
    let mut runs = vec![
        directed(0, "1.0", "1.0", 1, 900),
        directed(1, "1.0", "10.0", 1, 40),
        directed(2, "10.0", "1.0", 1, 80),
        Run { status: Ending::Diverged, ..directed(3, "10.0", "10.0", 1, 7) },
        directed(4, "null", "null", 1, 50),
        Run { status: Ending::IterationLimit, ..directed(5, "1.0", "10.0", 2, 1000) },
        Run { status: Ending::Infeasible, ..directed(6, "10.0", "1.0", 2, 3) },
        Run { status: Ending::IterationLimit, ..directed(7, "null", "null", 2, 1000) },
    ];
    runs.push(run(8, "nsgs", "", Ending::Converged));
    let derived = directed(9, "null", "null", 1, 30);
    let mut settings = derived.settings.clone();
    settings.insert("adaptive".to_owned(), Value::Null);
    runs.push(Run { settings, derived: object(&json!({ "kappa_l_minus": 9.5 })), ..derived });
    runs
}

fn made(runs: &[Run]) -> Vec<File> {
    let files = files(&parts(&study(runs, &[])));
    for (name, text) in files.iter().filter(|(name, _)| name.contains(".svg")) {
        assert_well_formed(name, text);
    }
    files
}

fn text<'f>(files: &'f [File], name: &str) -> &'f str {
    let found = files.iter().find(|(other, _)| other == name);
    &found.unwrap_or_else(|| panic!("no {name} in {:?}", names(files))).1
}

fn names(files: &[File]) -> Vec<&str> {
    files.iter().map(|(name, _)| name.as_str()).collect()
}

#[test]
fn best_and_derived_directions_are_read_off_the_rows() {
    let files = made(&plane());
    assert_eq!(names(&files), ["directions-column.svg", "directions.csv", "directions.md", "directions.tex"]);
    let rows: Vec<&str> = text(&files, "directions.csv").lines().skip(1).collect();
    assert_eq!(
        rows[0],
        "column,20,latin-dd,0.8,1x1,1,1.0,10.0,κ_l,40,12.5,12.5,converged,50,1.25,9.5,30,0.75,4,1,0,0,0"
    );
    assert_eq!(rows[1], "column,20,latin-dd,0.8,2x1,2,,,,,12.5,12.5,iteration limit,,,,,,2,0,1,0,1");
    let svg = text(&files, "directions-column.svg");
    for note in ["derived ×1.25, adapted ×0.75", "derived failed", "6\u{a0}runs\n"] {
        assert!(svg.contains(note), "{note}: {svg}");
    }
}

#[test]
fn only_failures_are_a_map_of_signs_without_a_scale() {
    let failed = |mut run: Run| {
        run.status = Ending::Diverged;
        run
    };
    let files = made(&plane().into_iter().map(failed).collect::<Vec<_>>());
    let svg = text(&files, "directions-column.svg");
    assert!(svg.contains("derived failed"));
    assert!(!svg.contains(">\niterations\n<"), "there is nothing to scale");
}

#[test]
fn one_run_without_derived_ones_is_drawn() {
    let files = made(&[Run { tolerance: f64::NAN, ..directed(0, "1.0", "10.0", 1, 0) }]);
    assert!(!text(&files, "directions-column.svg").contains("derived failed"));
}

#[test]
fn study_without_directions_says_so() {
    for runs in [vec![], vec![run(0, "nsgs", "", Ending::Converged)]] {
        let files = made(&runs);
        assert_eq!(names(&files), ["directions.csv", "directions.md", "directions.tex"]);
        assert!(text(&files, "directions.md").contains("no such run"));
    }
}

#[test]
fn thousands_of_runs_fill_as_many_pages_as_they_need() {
    let ladder = |i: u32| format!("{:.1}", 10f64.powf(f64::from(i) / 3.0));
    let mut runs = Vec::new();
    for group in 1..=24 {
        for i in 0..81 {
            runs.push(directed(runs.len() as u32, &ladder(i / 9), &ladder(i % 9), group, u64::from(50 + i)));
        }
    }
    let files = made(&runs);
    assert_eq!(text(&files, "directions.csv").lines().count(), 1 + 24);
    assert!(names(&files).contains(&"directions-column.svg"));
    let pages = files.iter().filter(|(name, _)| name.contains(".svg")).map(|(_, svg)| svg);
    assert_eq!(pages.map(|svg| svg.matches(", relaxation 0.8").count()).sum::<usize>(), 24, "each map once");
}

#[test]
fn matched_directions_on_problems_of_several_sizes_are_drawn_against_them() {
    let mut runs = Vec::new();
    for (grains, seed, best) in [(250, 1, 20), (250, 2, 30), (1000, 1, 40), (1000, 2, 60)] {
        for (kappa, iterations) in [("10.0", best), ("20.0", best + 5), ("null", best + 10)] {
            let problem = format!("grains={grains} seed={seed}");
            runs.push(Run { problem, grains, ..directed(runs.len() as u32, kappa, "null", 1, iterations) });
        }
    }
    let files = made(&runs);
    assert_eq!(
        names(&files),
        ["derived-direction.svg", "derived-direction.csv", "derived-direction.md", "derived-direction.tex"]
    );
    // Medians of 1.5 and 1.333 in logarithms, and of 1.25 and 1.167.
    let svg = text(&files, "derived-direction.svg");
    assert!(svg.contains("1.41 at 250 grains, 1.21 at 1000 grains"), "{svg}");
    assert!(text(&files, "derived-direction.csv").contains("grains=250 seed=1,250,latin-dd"));
}

#[test]
fn table_of_no_field_has_its_columns() {
    assert!(csv(&super::table(&[])).unwrap().starts_with("problem,grains,method,relaxation"));
}
