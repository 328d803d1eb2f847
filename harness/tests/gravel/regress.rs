//! `gravel regress` and `gravel bless`: what is as accepted passes, whatever differs is named and fails.

use crate::bench::{Study, study_of_the_pair_and_a_column};
use crate::common::{Ran, checkout, methods, write};
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

const METHODS: &str = "[[methods]]\nmethod = \"nsgs\"\n\n[[methods]]\nmethod = \"cg\"\n";

fn guarded() -> Study {
    let study = study_of_the_pair_and_a_column();
    study.plan("guard", &["column-9", "pair"], METHODS);
    study.gravel(&["bless", "guard"]).succeeded();
    study
}

fn baseline(study: &Study) -> PathBuf {
    study.folder().path().join("results/baseline/guard.csv")
}

#[track_caller]
fn differs(study: &Study, words: &[&str]) -> Ran {
    let ran = study.gravel(&["regress", "guard"]).failed();
    for word in words.iter().chain(&["`gravel bless guard` accepts it"]) {
        assert!(ran.stdout.contains(word), "no `{word}` in: {}", ran.stdout);
    }
    ran
}

#[test]
fn counts_as_accepted_pass_and_nothing_is_stored() {
    let study = guarded();
    let printed = study.gravel(&["regress", "guard"]).succeeded().stdout;
    assert!(printed.contains("guard: 4 runs, all as in "), "{printed}");
    assert!(!study.runs("guard").exists());
    let text = fs::read_to_string(baseline(&study)).unwrap();
    let runs: Vec<&str> = text.lines().skip(1).collect();
    assert_eq!(runs.len(), 4);
    assert!(runs.is_sorted(), "{text}");
    study.gravel(&["bless", "guard", "--jobs", "3"]).succeeded();
    assert_eq!(fs::read_to_string(baseline(&study)).unwrap(), text);
}

#[test]
fn count_that_differs_is_named_with_its_run_and_ratio() {
    let study = guarded();
    let accepted = fs::read_to_string(baseline(&study)).unwrap();
    // Columns: problem, method, settings, hash, status, iterations.
    let line = accepted.lines().find(|line| line.starts_with("column-9,nsgs,")).unwrap();
    let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
    let iterations: u64 = fields[5].parse().unwrap();
    fields[5] = (2 * iterations).to_string();
    fs::write(baseline(&study), accepted.replacen(line, &fields.join(","), 1)).unwrap();
    let printed = differs(&study, &[]).stdout;
    let rows: Vec<Vec<&str>> = printed.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows[0], ["run", "count", "before", "now", "ratio"]);
    let (before, now) = (fields[5].as_str(), iterations.to_string());
    assert_eq!(rows[1], ["column-9", "nsgs", "iterations", before, &now, "0.5000"]);
    assert_eq!(rows.len(), 3, "{printed}");
    // Accepting prints the same, and the next comparison passes.
    let printed = study.gravel(&["bless", "guard"]).succeeded().stdout;
    assert!(printed.contains("0.5000"), "{printed}");
    assert_eq!(fs::read_to_string(baseline(&study)).unwrap(), accepted);
}

#[test]
fn setting_that_changes_names_the_runs_that_came_and_went_and_no_other() {
    let study = guarded();
    let relaxed = METHODS.replacen("\"nsgs\"\n", "\"nsgs\"\nset = { relaxation = 0.9 }\n", 1);
    study.plan("guard", &["column-9", "pair"], &relaxed);
    let printed = differs(&study, &[]).stdout;
    let lines: Vec<&str> = printed.lines().collect();
    let expected = [
        "not in the baseline: column-9 nsgs relaxation=0.9",
        "not in the baseline: pair nsgs relaxation=0.9",
        "not in the plan: column-9 nsgs",
        "not in the plan: pair nsgs",
    ];
    assert_eq!(lines[..lines.len() - 1], expected);
}

#[test]
fn failure_must_be_expected_and_an_expected_one_must_come() {
    let study = guarded();
    let ledger = |text: &str| {
        write(study.folder(), "results/baseline/expected-failures.toml", text);
    };
    let entry = |run: &str, status: &str| {
        format!("[[failure]]\nplan = \"guard\"\nrun = \"{run}\"\nstatus = \"{status}\"\nwhy = \"A test.\"\n")
    };
    ledger(&entry("pair cg", "diverged"));
    differs(&study, &["unexpected: pair cg: converged, where diverged is expected: A test."]);
    ledger(&entry("pair jacobi", "diverged"));
    differs(&study, &["expected to fail, and not in the plan: pair jacobi"]);
    fs::remove_file(study.folder().path().join("results/baseline/expected-failures.toml")).unwrap();

    // One iteration is not enough for NSGS on the column.
    let text = crate::bench::plan("guard", &["column-9"], METHODS).replace("10_000", "1");
    write(study.folder(), "harness/plans/guard.toml", &text);
    study.gravel(&["bless", "guard"]).failed();
    differs(&study, &["unexpected failure: column-9 nsgs: iteration-limit"]);
    ledger(&(entry("column-9 nsgs", "iteration-limit") + &entry("column-9 cg", "iteration-limit")));
    study.gravel(&["regress", "guard"]).succeeded();
}

#[test]
fn comparison_without_a_baseline_or_with_a_broken_one_is_refused() {
    let study = guarded();
    study.gravel(&["regress", "small"]).refused(&[
        "baseline/small.csv",
        "no baseline",
        "`gravel bless small`",
    ]);
    fs::write(baseline(&study), "problem,method\npair,nsgs\n").unwrap();
    study.gravel(&["regress", "guard"]).refused(&["guard.csv", "`settings`"]);
    let ledger = "[[failure]]\nplan = \"guard\"\nrun = \"pair cg\"\nstatus = \"diverged\"\nwhy = \"\"\n";
    write(study.folder(), "results/baseline/expected-failures.toml", ledger);
    study.gravel(&["bless", "guard"]).refused(&["expected-failures.toml", "`pair cg`", "`why`"]);
}

#[test]
fn every_method_is_guarded() {
    let text = fs::read_to_string(checkout().join("results/baseline/regress.csv")).unwrap();
    let guarded: BTreeSet<&str> = text.lines().skip(1).filter_map(|line| line.split(',').nth(1)).collect();
    let methods = methods();
    let all: BTreeSet<&str> = methods.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(guarded, all, "a method comes into harness/plans/regress.toml, then `gravel bless`");
}
