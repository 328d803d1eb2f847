use results::schema::Run;
use serde_json::{Value, json};

use super::*;
use crate::tests::fixture::{object, run, study};

/// Labels of runs of one method with these settings, warm or not.
fn labels(all: &[(Value, bool)]) -> Vec<String> {
    let row = |(settings, warm_start): &(Value, bool)| Run {
        settings: object(settings),
        warm_start: *warm_start,
        ..run(0, "m", "", Ending::Converged)
    };
    let study = study(&all.iter().map(row).collect::<Vec<_>>(), &[]);
    study.runs.iter().map(RunRow::label).collect()
}

#[test]
fn a_run_is_named_by_the_settings_that_set_it_apart() {
    let polish = |on: bool| json!({ "polish": on, "symmetric": false });
    assert_eq!(labels(&[(polish(true), false), (polish(false), false)]), ["m, polish", "m, no polish"]);
    let omega = |omega: f64| json!({ "relaxation": omega, "sweeps": 1 });
    let told = labels(&[(omega(1.0), false), (omega(0.5), false), (omega(0.5), true)]);
    assert_eq!(told, ["m, relaxation=1", "m, relaxation=0.5", "m, relaxation=0.5, warm start"]);
    let names = |name: &str| json!({ "preconditioner": name });
    let named = [(names("none"), false), (names("none"), true), (names("diagonal"), false)];
    assert_eq!(labels(&named), ["m", "m, warm start", "m, diagonal"]);
    let start = |name: &str| json!({ "start": name });
    assert_eq!(
        labels(&[(start("cg"), false), (start("cold-set"), false)]),
        ["m, start=cg", "m, cold-set"],
        "a method's name is told with its setting"
    );
    let both = |grid: &str, kappa: f64| json!({ "subdomains": grid, "kappa_l": kappa });
    assert_eq!(
        labels(&[(both("2x1", 1.0), false), (both("4x2", 2.0), false)]),
        ["m, kappa_l=1, 2x1", "m, kappa_l=2, 4x2"]
    );
}
