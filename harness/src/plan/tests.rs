//! Quick forms, changes, runs that are the same; axes, and names of runs.

use crate::plan::variants::of_variants;
use crate::plan::{Method, Plan, Settings, combinations, last_parts, values};
use anyhow::Result;
use runner::Stop;
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

const PLAN: &str = r#"
name = "small"
why = "A test."
problems = ["pair"]

[stop]
on = "zeta"
tolerance = 1e-3
max_iterations = 100

[[methods]]
method = "nsgs"
axes = { relaxation = [1.0, 1.5] }

[[methods]]
method = "cg"
"#;

fn read(text: &str, quick: bool) -> Result<Plan> {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("small.toml");
    fs::write(&file, text).unwrap();
    Plan::read(&file, quick)
}

#[track_caller]
fn refused(text: &str, quick: bool, words: &[&str]) {
    let error = format!("{:#}", read(text, quick).unwrap_err());
    for word in words {
        assert!(error.contains(word), "no `{word}` in: {error}");
    }
}

/// Method and name of each run.
fn runs(plan: &Plan, changes: &[(&str, &str)]) -> Vec<(&'static str, String)> {
    let changes: Vec<(String, String)> =
        changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let variants = plan.variants(&changes).unwrap();
    variants.into_iter().map(|variant| (variant.method.name, variant.name)).collect()
}

#[test]
fn keys_of_quick_replace_those_of_the_plan_and_the_others_stay() {
    let quick =
        "[quick]\nproblems = [\"column\"]\nstop.max_iterations = 7\n[[quick.methods]]\nmethod = \"cg\"\n";
    let text = format!("{PLAN}\n{quick}");
    let (whole, quick) = (read(&text, false).unwrap(), read(&text, true).unwrap());
    assert_eq!((whole.name.as_str(), whole.problems[0].as_str()), ("small", "pair"));
    assert_eq!((whole.stop.max_iterations, runs(&whole, &[]).len()), (100, 3));
    assert_eq!((quick.name.as_str(), quick.problems[0].as_str()), ("small-quick", "column"));
    // One key of the stop rule is replaced.
    let zeta = Stop { max_iterations: 7, ..whole.stop };
    assert_eq!((quick.stop, runs(&quick, &[])), (zeta, vec![("cg", String::new())]));
}

#[test]
fn quick_that_makes_no_sense_is_refused_even_where_it_is_not_asked() {
    for quick in [false, true] {
        let with = |text: &str, words: &[&str]| {
            refused(
                &format!("{PLAN}\n[quick]\n{text}\n"),
                quick,
                &[&["small.toml", "`quick`"], words].concat(),
            );
        };
        with("problem = [\"pair\"]", &["`problem`", "`problems`"]);
        with("name = \"other\"", &["`name`"]);
        with("stop.tolerance = -1.0", &["`stop`: `tolerance` is -1"]);
        with("stop.tolerence = 1.0", &["`tolerence`", "`tolerance`"]);
        with("methods = []", &["`methods` is empty"]);
        with("methods = [{ method = \"cgg\" }]", &["unknown method `cgg`", "did you mean `cg`?"]);
        with("quick = {}", &["`quick`"]);
    }
    refused(PLAN, true, &["--quick", "no table [quick]"]);
}

#[test]
fn error_that_no_reference_tells_stops_no_run() {
    let without = format!("reference = false{PLAN}");
    assert!(!read(&without, false).unwrap().reference && read(PLAN, false).unwrap().reference);
    refused(&without.replace("zeta", "velocity_error"), false, &["`reference`", "velocity_error"]);
}

#[test]
fn change_replaces_the_setting_of_every_method_that_has_it() {
    let plan = read(PLAN, false).unwrap();
    // The two values of the axis become one run.
    assert_eq!(runs(&plan, &[("relaxation", "0.5")]), [("nsgs", String::new()), ("cg", String::new())]);
    let changed = plan.variants(&[("relaxation".into(), "0.5".into())]).unwrap();
    assert_eq!(changed[0].method.settings["relaxation"], 0.5);
    let refused = |key: &str, words: [&str; 2]| {
        let error = plan.variants(&[(key.into(), "0.5".into())]).err().unwrap().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    };
    refused("relaxtion", ["--set relaxtion=0.5: no method", "did you mean `relaxation`?"]);
    refused("order", ["method `nsgs`", "`order`"]);
}

#[test]
fn two_runs_with_the_same_settings_are_refused() {
    refused(
        &format!("{PLAN}\n[[methods]]\nmethod = \"cg\"\n"),
        false,
        &["`cg`", "two runs have the settings"],
    );
    let default = "[[methods]]\nmethod = \"cg\"\nset = { preconditioner = \"none\" }";
    refused(&format!("{PLAN}\n{default}\n"), false, &["\"preconditioner\":\"none\""]);
}

#[test]
fn axes_of_a_method_name_the_method_the_key_and_the_value() {
    let axes = |axes: &str| PLAN.replace("axes = { relaxation = [1.0, 1.5] }", axes);
    let in_nsgs = |text: &str, words: &[&str]| {
        refused(&axes(text), false, &[&["small.toml", "method `nsgs`"], words].concat());
    };
    in_nsgs("axes = { relaxation = 1.0 }", &["the axis `relaxation` is 1.0: it must be a list, or a range"]);
    in_nsgs("axes = { relaxation = \"geom(0, 1, 3)\" }", &["`relaxation` is \"geom(0, 1, 3)\"", "positive"]);
    in_nsgs("zip = { relaxation = [1.0], seed = [1, 2] }", &["`relaxation` has 1", "`seed` has 2"]);
    let plan = read(&axes("zip = { relaxation = \"lin(1, 1.5, 2)\", seed = \"1..2\" }"), false).unwrap();
    let names = ["relaxation=1 seed=1", "relaxation=1.5 seed=2", ""];
    assert_eq!(runs(&plan, &[]).into_iter().map(|(_, name)| name).collect::<Vec<_>>(), names);
}

fn range(text: &str) -> Value {
    Value::Array(values("key", &json!(text)).unwrap())
}

#[track_caller]
fn axis_refused(axis: &Value, words: &[&str]) {
    let error = values("key", axis).unwrap_err().to_string();
    assert!(error.starts_with("the axis `key` is "), "{error}");
    for word in words {
        assert!(error.contains(word), "no `{word}` in: {error}");
    }
}

fn settings(value: &Value) -> Settings {
    value.as_object().unwrap().clone()
}

#[test]
fn integers_have_both_ends() {
    assert_eq!(range("1..5"), json!([1, 2, 3, 4, 5]));
    assert_eq!(range("-1 .. 1"), json!([-1, 0, 1]));
    assert_eq!(range("7..7"), json!([7]));
}

#[test]
fn geometric_values_have_equal_ratios_to_three_digits_and_exact_ends() {
    assert_eq!(range("geom(1, 1000, 4)"), json!([1, 10, 100, 1000]));
    assert_eq!(range("geom(0.1, 10, 5)"), json!([0.1, 0.316, 1, 3.16, 10]));
    assert_eq!(range("geom(8, 1, 4)"), json!([8, 4, 2, 1]));
    assert_eq!(range("geom(0.12345, 1.23456, 2)"), json!([0.12345, 1.23456]));
}

#[test]
fn linear_values_have_equal_steps_to_three_digits_and_exact_ends() {
    let tenths = json!([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1]);
    assert_eq!(range("lin(0.1, 1, 10)"), tenths);
    assert_eq!(range("lin(-1, 1.0001, 3)"), json!([-1, 0.00005, 1.0001]));
}

#[test]
fn range_that_is_none_is_refused() {
    axis_refused(&json!([]), &["empty"]);
    axis_refused(&json!(3), &["is 3:", "a list", "\"1..5\""]);
    axis_refused(&json!("4x2"), &["\"4x2\"", "a list", "geom("]);
    axis_refused(&json!("5..1"), &["\"5..1\"", "not above the last"]);
    axis_refused(&json!("1..2.5"), &["\"1..2.5\"", "integers"]);
    axis_refused(&json!("0..9223372036854775807"), &["at most 100000"]);
    axis_refused(&json!("-9223372036854775808..9223372036854775807"), &["at most 100000"]);
    axis_refused(&json!("geom(0, 1, 3)"), &["\"geom(0, 1, 3)\"", "positive"]);
    axis_refused(&json!("geom(1, inf, 3)"), &["positive"]);
    axis_refused(&json!("geom(1, 10)"), &["a count"]);
    axis_refused(&json!("lin(0, 1, 1)"), &["from 2"]);
    axis_refused(&json!("lin(0, nan, 3)"), &["finite"]);
    axis_refused(&json!("lin(1, 2, 3"), &["a list"]);
    axis_refused(&json!("lin(0.8 1.6 5)"), &["two finite numbers and a count", "with commas between them"]);
    axis_refused(&json!("lin(1000, 1001, 11)"), &["some of these are equal"]);
    axis_refused(&json!("lin(1, 1, 2)"), &["some of these are equal"]);
}

#[test]
fn zipped_values_are_taken_together_and_axes_are_combined() {
    let set = settings(&json!({ "law": "iqs" }));
    let zip = settings(&json!({ "grains": [10, 20], "width": [1.0, 2.0] }));
    let axes = settings(&json!({ "seed": "1..2" }));
    let made = combinations(&set, &zip, &axes).unwrap();
    let expected = [(10, 1.0, 1), (10, 1.0, 2), (20, 2.0, 1), (20, 2.0, 2)];
    let expected = expected.map(|(grains, width, seed)| {
        settings(&json!({ "law": "iqs", "grains": grains, "width": width, "seed": seed }))
    });
    assert_eq!(made, expected);
    let none = Settings::new();
    assert_eq!(combinations(&set, &none, &none).unwrap(), [set]);
}

#[test]
fn axes_that_meet_or_do_not_match_are_refused() {
    let refused = |set, zip, axes, words: &[&str]| {
        let error = combinations(&settings(&set), &settings(&zip), &settings(&axes)).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    };
    let none = || json!({});
    refused(json!({ "a": 1 }), none(), json!({ "a": [1] }), &["`a` is set and an axis"]);
    refused(json!({ "a": 1 }), json!({ "a": [1] }), none(), &["`a` is set and an axis"]);
    refused(none(), json!({ "a": [1] }), json!({ "a": [1] }), &["`a` is an axis twice"]);
    refused(none(), json!({ "a": [1, 2], "b": "1..3" }), none(), &["`a` has 2", "`b` has 3"]);
    refused(none(), none(), json!({ "a": "1..2000", "b": "1..2000" }), &["`b`", "100000 combinations"]);
}

fn variant_names(method: &str, all: &[Value]) -> Vec<String> {
    let method = |settings: &Value| Method::new(method, settings.as_object().unwrap().clone()).unwrap();
    of_variants(&all.iter().map(|settings| (method(settings), false)).collect::<Vec<_>>())
}

#[test]
fn method_that_is_alone_has_no_name() {
    assert_eq!(variant_names("nsgs", &[json!({ "relaxation": 1.5 })]), [""]);
}

#[test]
fn one_differing_setting_names_a_run_by_its_value() {
    let subdomains = |grid: &str| json!({ "subdomains": grid, "inner_sweeps": 2 });
    assert_eq!(variant_names("nsgs-dd", &[subdomains("1x1"), subdomains("4x2")]), ["1x1", "4x2"]);
    let kappa = |kappa: f64| json!({ "kappa_l": kappa });
    let all = [kappa(1.0), kappa(31.6), kappa(1000.0), kappa(1e-7), json!({})];
    assert_eq!(variant_names("latin-dd", &all), ["1", "31.6", "1000", "1e-7", "default"]);
}

#[test]
fn several_differing_settings_name_a_run_by_keys_and_values() {
    let all = [
        json!({ "subdomains": "4x2", "kappa_l": 10.0 }),
        json!({ "subdomains": "4x2", "kappa_d": 10.0 }),
        json!({ "subdomains": "2x1" }),
    ];
    let expected = ["kappa_l=10 subdomains=4x2", "kappa_d=10 subdomains=4x2", "subdomains=2x1"];
    assert_eq!(variant_names("latin-dd", &all), expected);
    let open = [json!({ "kappa_l": 10.0 }), json!({ "kappa_d": 10.0 }), json!({})];
    assert_eq!(variant_names("latin-dd", &open), ["kappa_l=10", "kappa_d=10", "default"]);
}

#[test]
fn warm_start_is_named_beside_a_cold_one_only() {
    let nsgs = |relaxation: f64, warm_start| {
        let settings = json!({ "relaxation": relaxation });
        (Method::new("nsgs", settings.as_object().unwrap().clone()).unwrap(), warm_start)
    };
    assert_eq!(of_variants(&[nsgs(1.0, false), nsgs(1.0, true)]), ["", "warm start"]);
    assert_eq!(of_variants(&[nsgs(1.0, false), nsgs(1.5, true)]), ["1", "1.5, warm start"]);
    assert_eq!(of_variants(&[nsgs(1.0, true), nsgs(1.5, true)]), ["1", "1.5"]);
}

#[test]
fn key_is_short_unless_another_ends_so() {
    assert_eq!(last_parts(&["sample.grains", "scene.box.width_m"]), ["grains", "width_m"]);
    assert_eq!(last_parts(&["a.width", "b.width", "seed"]), ["a.width", "b.width", "seed"]);
}

#[test]
fn a_method_meets_the_problems_that_it_names_alone() {
    let text = |first: &str, second: &str| {
        format!("{PLAN}problems = {first}\n\n[[methods]]\nmethod = \"cg\"\nproblems = {second}\n")
    };
    let plan = read(&text("[\"pair*\"]", "[\"column\"]"), false).unwrap();
    let variants = plan.variants(&[]).unwrap();
    let [first, _, cg] = &variants[..] else { panic!("three variants") };
    assert!(first.meets("any"));
    assert!(cg.meets("pair of discs") && cg.meets("column") && !cg.meets("box"));
    // Twice on one problem.
    refused(&text("[\"pair\"]", "[\"pair\"]"), false, &["`cg`", "two runs"]);
    refused(&text("[\"pair\"]", "[]"), false, &["`cg`", "two runs"]);
}

#[test]
fn a_plan_declares_charts_of_its_own() {
    let own = |x: &str| {
        let chart = format!("{{ name = \"mine\", x = \"{x}\", y = [\"iterations\", \"growth\"] }}");
        PLAN.replace("[stop]", &format!("charts = [\"size\", {chart}]\n\n[stop]"))
    };
    let plan = read(&own("contacts"), false).unwrap();
    assert_eq!(plan.charts().iter().map(|chart| chart.name).collect::<Vec<_>>(), ["size", "mine"]);
    refused(&own("beauty"), false, &["`charts`", "no quantity `beauty`", "contacts, ranks"]);
    let nameless = own("contacts").replace("name = \"mine\", ", "");
    refused(&nameless, false, &["`charts`", "missing field `name`"]);
}
