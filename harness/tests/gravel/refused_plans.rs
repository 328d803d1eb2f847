//! Plans that make no sense: nothing is run and nothing is written.

use crate::bench::{Study, plan};
use crate::common::{entries, text, write};

/// A plan with this text is refused, with its file and all of `words`, and leaves nothing behind.
#[track_caller]
fn refused(plan: &str, words: &[&str]) {
    let study = Study::new();
    let file = write(study.folder(), "harness/plans/bad.toml", plan);
    study.gravel(&["bench", text(&file)]).refused(&[&["bad.toml"], words].concat());
    assert_eq!(entries(study.folder().path()), ["cases", "harness"]);
}

const NSGS: &str = "[[methods]]\nmethod = \"nsgs\"\n";

#[test]
fn unknown_key_of_a_plan_is_refused_at_its_line() {
    refused(
        &format!("tolerance = 1e-3\n{}", plan("bad", &["pair"], NSGS)),
        &["line 1, column 1", "`tolerance`"],
    );
    let nested = plan("bad", &["pair"], &format!("{NSGS}axis = {{ relaxation = [1.0] }}\n"));
    let line = 1 + nested.lines().position(|line| line.starts_with("axis")).unwrap();
    refused(&nested, &[&format!("line {line}, column 1"), "`axis`", "`axes`"]);
}

#[test]
fn unknown_method_of_a_plan_is_refused() {
    refused(&plan("bad", &["pair"], "[[methods]]\nmethod = \"newton\"\n"), &["`newton`", "nsgs"]);
}

#[test]
fn unknown_setting_of_a_plan_is_refused() {
    let relax = |key: &str| plan("bad", &["pair"], &format!("{NSGS}{key}\n"));
    refused(&relax("set = { relax = 1.0 }"), &["`nsgs`", "`relax`", "`relaxation`"]);
    refused(&relax("axes = { relax = [1.0, 1.5] }"), &["`nsgs`", "`relax`", "`relaxation`"]);
    refused(&relax("axes = { relaxation = [1.0, \"much\"] }"), &["`nsgs`", "`relaxation`", "\"much\""]);
}

#[test]
fn axis_that_is_empty_or_also_set_is_refused() {
    let axes = |keys: &str| plan("bad", &["pair"], &format!("{NSGS}{keys}\n"));
    refused(&axes("axes = { relaxation = [] }"), &["`nsgs`", "`relaxation`", "empty"]);
    refused(&axes("set = { relaxation = 1.0 }\naxes = { relaxation = [1.5] }"), &["`relaxation`", "axis"]);
}

#[test]
fn plan_without_methods_or_problems_is_refused() {
    refused(&plan("bad", &[], NSGS), &["`problems` is empty"]);
    // A key at the end belongs to the table before it, so this one stands at the top.
    refused(&format!("methods = []\n{}", plan("bad", &["pair"], "")), &["`methods` is empty"]);
}

#[test]
fn missing_problem_of_a_plan_is_refused_with_the_known_ones() {
    refused(&plan("bad", &["absent"], NSGS), &["`problems`", "`absent`", "pair"]);
    // A case is no frozen problem: which of its time steps is meant?
    refused(&plan("bad", &["column"], NSGS), &["`problems`", "`column` is a case", "[[cases]]", "pair"]);
}

#[test]
fn tolerance_of_a_plan_that_is_not_a_positive_number_is_refused() {
    let tolerance = |value: &str| plan("bad", &["pair"], NSGS).replace("1e-3", value);
    refused(&tolerance("-1.0"), &["`stop`: `tolerance` is -1:", "not negative"]);
    refused(&tolerance("nan"), &["`stop`: `tolerance` is NaN:", "finite"]);
}

#[test]
fn unknown_measure_of_a_plan_is_refused() {
    let energy = plan("bad", &["pair"], NSGS).replace("natural_map", "energy");
    refused(&energy, &["line ", "`energy`", "`natural_map`"]);
}

#[test]
fn unknown_chart_of_a_plan_is_refused_with_the_known_ones() {
    let charts = |names: &str| format!("charts = {names}\n{}", plan("bad", &["pair"], NSGS));
    refused(
        &charts("[\"sampel\"]"),
        &["`charts`", "`sampel`", "convergence, sample, directions", "did you mean `sample`?"],
    );
    refused(&charts("\"sample\""), &["line 1", "a sequence"]);
    let curves = format!("curves = \"end\"\n{}", plan("bad", &["pair"], NSGS));
    refused(&curves, &["line 1", "`end`", "did you mean `ends`?"]);
}

#[test]
fn plan_whose_name_is_no_folder_is_refused() {
    for name in ["", "../bad", ".bad"] {
        let study = Study::new();
        let file = write(study.folder(), "harness/plans/bad.toml", &plan(name, &["pair"], NSGS));
        study.gravel(&["bench", text(&file)]).refused(&[&format!("plan `{name}`"), "name"]);
        assert_eq!(entries(study.folder().path()), ["cases", "harness"]);
    }
}
