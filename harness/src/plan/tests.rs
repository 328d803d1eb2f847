//! Quick forms, changes, runs that are the same.

use crate::plan::file::Plan;
use anyhow::Result;
use contact::Stop;
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
