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
    for name in ["", "../bad", ".bad", "a/b", "a\\\\b"] {
        let study = Study::new();
        let file = write(study.folder(), "harness/plans/bad.toml", &plan(name, &["pair"], NSGS));
        for command in [&["bench"][..], &["report"], &["figure", "size"], &["plan"], &["bless"]] {
            let words = ["bad.toml: `name` is \"", name, "files are named after it"];
            study.gravel(&[command, &[text(&file)]].concat()).refused(&words);
        }
        assert_eq!(entries(study.folder().path()), ["cases", "harness"]);
    }
}

#[test]
fn more_runs_than_anyone_means_are_refused_before_one_is_planned() {
    let nsgs = |axes: &str| plan("bad", &["pair"], &format!("{NSGS}axes = {{ {axes} }}\n"));
    refused(
        &nsgs("relaxation = [1.0], seed = \"1..1000000000\""),
        &["method `nsgs`", "`seed`", "at most 100000"],
    );
    let product = nsgs("seed = \"1..1000\", relaxation = \"lin(0.001, 1, 1000)\"");
    refused(&product, &["1 problems, 1000000 variants of methods on each", "at most 100000"]);
    let cases = "[[cases]]\ncase = \"column\"\naxes = { \"sample.grains\" = \"1..90000\" }\n";
    let cases = plan("bad", &["pair"], &format!("{NSGS}axes = {{ seed = [1, 2] }}\n{cases}"));
    refused(&cases, &["90001 problems, 2 variants", "at most 100000"]);
    let repeats = format!("repeats = 4294967295\n{}", plan("bad", &["pair"], NSGS));
    refused(&repeats, &["`repeats` is 4294967295: it must be at most 1000"]);
}

#[test]
fn reference_of_a_study_through_time_is_refused_with_its_file() {
    let through_time = |reference: &str| {
        let simulate = format!(
            "[[cases]]\ncase = \"column\"\n[simulate]\nduration_s = 0.01\nsample_every_s = 0.005\n\
             [simulate.reference]\n{reference}\n"
        );
        plan("bad", &[], &format!("{NSGS}{simulate}"))
    };
    let method = "method = \"cgg\"\ntolerance = 1e-8";
    refused(
        &through_time(method),
        &["bad.toml: `simulate.reference`: unknown method `cgg`; did you mean `cg`?"],
    );
    let tolerance = "method = \"cg\"\ntolerance = -1.0";
    refused(&through_time(tolerance), &["bad.toml: `simulate.reference`: `tolerance` is -1:"]);
}
