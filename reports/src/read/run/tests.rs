use results::schema::Run;
use serde_json::json;

use super::*;
use crate::tests::fixture::{object, run, study};

/// Labels of runs of one method with these variants and settings.
fn labels(all: &[(&str, Value)]) -> Vec<String> {
    let row = |(variant, settings): &(&str, Value)| Run {
        settings: object(settings),
        ..run(0, "m", variant, "converged")
    };
    let study = study(&all.iter().map(row).collect::<Vec<_>>(), &[]);
    study.runs.iter().map(RunRow::label).collect()
}

#[test]
fn ambiguous_value_is_told_with_the_setting_that_it_is_of() {
    let polish = |on: bool| json!({ "polish": on, "symmetric": false });
    assert_eq!(labels(&[("true", polish(true)), ("false", polish(false))]), ["m, polish", "m, no polish"]);
    let omega = |omega: f64| json!({ "relaxation": omega, "sweeps": 1 });
    let told = labels(&[("1", omega(1.0)), ("0.5", omega(0.5)), ("0.5, warm start", omega(0.5))]);
    assert_eq!(told, ["m, relaxation=1", "m, relaxation=0.5", "m, relaxation=0.5, warm start"]);
    let names = |name: &str| json!({ "preconditioner": name });
    let variants = ["none", "none, warm start", "diagonal"];
    let named: Vec<_> =
        variants.iter().zip(["none", "none", "diagonal"]).map(|(v, n)| (*v, names(n))).collect();
    assert_eq!(labels(&named), ["m", "m, warm start", "m, diagonal"]);
    let start = |name: &str| json!({ "start": name });
    assert_eq!(
        labels(&[("cg", start("cg")), ("cold-set", start("cold-set"))]),
        ["m, start=cg", "m, cold-set"]
    );
    // Two settings have the value: of which it is, is not known.
    let both = |x: f64| json!({ "kappa_l": x, "kappa_d": x });
    assert_eq!(labels(&[("1", both(1.0)), ("2", both(2.0))]), ["m 1", "m 2"]);
}
