//! `gravel view` of a stored run, by its id.

use crate::bench::{Study, rows};
use crate::common::{entries, pair_with, without_checksums, write};
use serde_json::json;
use std::collections::BTreeMap;
use std::fs;

/// The pair and two columns, warm and cold; the iterates of one run are kept, and one run is skipped.
const PLAN: &str = r#"
name = "kept"
why = "A test."
problems = ["pair"]

[stop]
on = "natural_map"
tolerance = 1e-3
max_iterations = 500

[view]
problem = "pair"
runs = ["nsgs"]

[[cases]]
case = "column"
time_step = 2
axes = { "sample.grains" = [6, 9] }

[[methods]]
method = "nsgs"
warm_start = [false, true]

[[methods]]
method = "nsgs-dd"
set = { subdomains = "3x3" }
"#;

fn study() -> Study {
    let study = Study::new();
    write(study.folder(), "harness/plans/kept.toml", PLAN);
    study.bench("kept");
    study
}

fn row(study: &Study, problem: &str, method: &str, variant: &str) -> BTreeMap<String, String> {
    let runs = rows(study.runs("kept").join("runs.csv"));
    let is = |row: &BTreeMap<String, String>| {
        row["problem"] == problem && row["method"] == method && row["variant"] == variant
    };
    runs.into_iter().find(is).unwrap()
}

#[test]
fn stored_run_is_shown_as_it_was_kept_or_run_again_as_it_was() {
    let study = study();
    let kept = row(&study, "pair", "nsgs", "");
    let printed = study.gravel(&["view", &kept["id"]]).succeeded().stdout;
    assert!(printed.contains(&format!("after {} iterations, as stored\n", kept["iterations"])), "{printed}");
    let page = format!("view-{}.html", kept["id"]);
    assert!(entries(&study.folder().path().join("reports/out")).contains(&page));

    let (cold, warm) =
        (row(&study, "column grains=9", "nsgs", ""), row(&study, "column grains=9", "nsgs", "warm start"));
    assert_ne!(cold["iterations"], warm["iterations"]);
    for row in [&cold, &warm] {
        let printed = study.gravel(&["view", &row["id"][..12], "--run", "cg"]).succeeded().stdout;
        let again =
            format!("after {} iterations, run again: its iterates are not stored\n", row["iterations"]);
        assert!(printed.contains(&again) && printed.contains("\ncg: converged"), "{printed}");
    }
    let printed = study.gravel(&["view", &cold["id"], "--max-iterations", "1"]).succeeded().stdout;
    assert!(
        printed.contains("iteration limit after 1 iterations, run again with another stop rule"),
        "{printed}"
    );
}

#[test]
fn problem_of_few_contacts_is_shown_on_fewer_subdomains_under_a_name_that_says_so() {
    let printed = study().gravel(&["view", "pair"]).succeeded().stdout;
    assert!(printed.contains("latin-dd adaptive=false subdomains="), "{printed}");
    assert!(
        !printed.contains("4x2") && printed.contains("\ncg preconditioner=diagonal: converged"),
        "{printed}"
    );
}

#[test]
fn run_that_cannot_be_shown_is_refused() {
    let study = study();
    let skipped = row(&study, "pair", "nsgs-dd", "");
    study.gravel(&["view", &skipped["id"]]).refused(&[&skipped["id"], "was skipped", "subdomains"]);
    study.gravel(&["view", "0123456"]).refused(&["`0123456`", "results/runs", "iterations.csv"]);
    let (kept, other) = (row(&study, "pair", "nsgs", ""), row(&study, "column grains=6", "nsgs", ""));
    study.gravel(&["view", &kept["id"], "--scene", "sample.grains=9"]).refused(&[
        "--scene",
        &kept["id"],
        "stored",
    ]);

    let journal = study.runs("kept").join("journal.jsonl");
    let whole = fs::read_to_string(&journal).unwrap();
    fs::write(&journal, whole.replacen("\"grains\":2", "\"grains\":3", 1)).unwrap();
    study.gravel(&["view", &kept["id"]]).refused(&["journal.jsonl, line 1", "damaged", "checksum"]);
    fs::write(&journal, whole).unwrap();
    let lines = without_checksums(&fs::read_to_string(&journal).unwrap());
    let alike = lines.replace(&kept["id"], "abcd000000000001").replace(&other["id"], "abcd000000000002");
    let alike: String = alike.lines().map(|line| seal::sealed(line) + "\n").collect();
    fs::write(&journal, alike).unwrap();
    let both = ["`abcd`", "abcd000000000001 (nsgs on pair", "abcd000000000002 (nsgs on column grains=6"];
    study.gravel(&["view", "abcd"]).refused(&both);
    study.gravel(&["view", "abcd000000000001"]).succeeded();

    write(
        study.folder(),
        "cases/frozen/pair.json",
        &pair_with("/grains/mass", json!([1.0, 3.0])).to_string(),
    );
    study.gravel(&["view", "abcd000000000001"]).refused(&[
        "abcd000000000001",
        "has changed",
        &kept["problem_hash"],
    ]);
    fs::remove_file(study.folder().path().join("cases/frozen/pair.json")).unwrap();
    study.gravel(&["view", "abcd000000000001"]).refused(&["abcd000000000001", "no frozen problem `pair`"]);
}
