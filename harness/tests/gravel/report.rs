//! `gravel report` and `gravel figure`: a stored study is drawn again, without running it.

use crate::bench::Study;
use crate::common::{entries, write};
use std::fs;

const PLAN: &str = r#"
name = "drawn"
why = "A test."
problems = ["pair"]
charts = ["subdomains"]

[stop]
on = "natural_map"
tolerance = 1e-3
max_iterations = 100

[[methods]]
method = "nsgs"
"#;

#[test]
fn report_draws_the_charts_of_the_plan_from_its_stored_rows() {
    let study = Study::new();
    write(study.folder(), "harness/plans/drawn.toml", PLAN);
    study.gravel(&["report", "drawn"]).refused(&["no study of plan `drawn`", "gravel bench"]);
    study.bench("drawn");
    let out = study.folder().path().join("reports/out/drawn");
    let made = [
        ".report",
        "iterations.csv",
        "iterations.md",
        "subdomains-pair.svg",
        "subdomains.csv",
        "subdomains.md",
    ];
    assert_eq!(entries(&out), made);
    let read = || made.map(|name| fs::read(out.join(name)).unwrap());
    let first = read();
    fs::write(out.join("iterations.md"), "spoilt").unwrap();
    fs::write(out.join("mine.txt"), "mine").unwrap();
    study.gravel(&["report", "drawn"]).succeeded();
    assert_eq!(read(), first);
    assert_eq!(fs::read_to_string(out.join("mine.txt")).unwrap(), "mine");
}

#[test]
fn figure_draws_one_chart_beside_the_report() {
    let study = Study::new();
    write(study.folder(), "harness/plans/drawn.toml", PLAN);
    study.bench("drawn");
    study.gravel(&["figure", "size", "drawn"]).succeeded();
    let out = study.folder().path().join("reports/out");
    assert_eq!(entries(&out), ["drawn", "drawn-size"]);
    assert!(entries(&out.join("drawn-size")).contains(&"size.svg".to_owned()));
    study.gravel(&["figure", "sizes", "drawn"]).refused(&["`sizes`", "convergence", "size"]);
}
