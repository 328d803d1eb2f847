//! `gravel list` and `gravel simulate`, and what is printed where nobody reads.

use crate::common::{all_methods, command, frozen_names, gravel, methods, names, text, write};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// The first word of every line.
fn first_words(printed: &str) -> Vec<&str> {
    printed.lines().filter_map(|line| line.split_whitespace().next()).collect()
}

#[test]
fn lists_of_cases_and_problems_have_every_one() {
    let mut cases: Vec<String> = names("cases", ".toml");
    cases.retain(|name| name != "Cargo");
    let problems = [frozen_names(), names("cases/foreign", ".hdf5")].concat();
    for (what, expected) in [("cases", cases), ("problems", problems)] {
        let printed = gravel(&["list", what]).succeeded().stdout;
        assert_eq!(first_words(&printed), expected, "{what}");
    }
}

#[test]
fn listed_charts_are_those_that_a_plan_may_ask_for_each_with_what_it_shows() {
    let printed = gravel(&["list", "charts"]).succeeded().stdout;
    let schema = gravel(&["schema", "plan"]).succeeded().stdout;
    let schema: Value = serde_json::from_str(&schema).unwrap();
    let known: Vec<&str> = schema["properties"]["charts"]["items"]["anyOf"][0]["enum"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert_eq!(first_words(&printed), known);
    assert!(printed.lines().all(|line| line.split_whitespace().count() > 3), "{printed}");
}

#[test]
fn list_of_plans_has_every_plan() {
    let printed = gravel(&["list", "plans"]).succeeded().stdout;
    assert_eq!(first_words(&printed), names("harness/plans", ".toml"));
}

#[test]
fn every_listed_method_solves_and_no_other_is_known() {
    let listed = methods();
    for (method, _) in &listed {
        let object = gravel(&["solve", "two-discs", "--json", "--method", method]).json();
        assert_eq!(object["status"], "converged", "{method}");
    }
    let all = all_methods();
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    gravel(&["solve", "two-discs", "--method", "?"]).refused(&[&format!("there are {}", names.join(", "))]);
}

#[test]
fn every_setting_is_listed_with_its_default_what_it_takes_and_what_it_is() {
    let printed = gravel(&["list", "methods"]).succeeded().stdout;
    let lines: Vec<&str> = printed.lines().collect();
    let settings: Vec<usize> =
        (0..lines.len()).filter(|n| lines[*n].starts_with("  ") && !lines[*n].starts_with("   ")).collect();
    assert!(settings.len() > 10, "{printed}");
    for n in settings {
        let takes = lines[n].split_once(": ").unwrap().1;
        assert!(!takes.is_empty() && !takes.contains('?'), "{}", lines[n]);
        assert!(lines[n + 1].trim().len() > 10, "{}: {}", lines[n], lines[n + 1]);
    }
    for line in [
        "  order = \"natural\": natural, bottom-up, shuffled, coloured",
        "  kappa_l = none: a number",
        "  start = none: cg, sweeps, cold-set, interior-point",
        "  symmetric = false: true or false",
        "  inner_sweeps = 1: a whole number, not negative",
    ] {
        assert!(lines.contains(&line), "no `{line}` in: {printed}");
    }
}

#[test]
fn help_fits_a_hundred_columns() {
    for name in ["bench", "plan", "view", "solve", "freeze", "simulate", "list"] {
        // However wide the terminal says that it is.
        let output = command(&[name, "--help"]).env("COLUMNS", "300").output().unwrap();
        for line in String::from_utf8(output.stdout).unwrap().lines() {
            assert!(line.chars().count() <= 100, "{name}: {line}");
        }
    }
}

#[test]
fn simulation_writes_a_row_per_time_step() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("column.csv");
    gravel(&["simulate", "column", "--time-steps", "3", "-o", text(&file)]).succeeded();
    let csv = fs::read_to_string(&file).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 3, "{csv}");
    assert_eq!(&rows[0][..5], ["time_step", "time_s", "contacts", "status", "iterations"]);
    for (k, row) in (1..).zip(&rows[1..]) {
        assert_eq!(row.len(), rows[0].len(), "{csv}");
        assert_eq!((row[0], row[2], row[3]), (&*k.to_string(), "20", "converged"), "{csv}");
        // 5 ms per time step, to the rounding of a product.
        assert!((row[1].parse::<f64>().unwrap() - 0.005 * f64::from(k)).abs() < 1e-15, "{csv}");
        // A column has no bulk, no drum and no segments.
        for (name, value) in rows[0].iter().zip(row) {
            let is_undefined =
                name.starts_with("bulk_") || ["bed_angle_rad", "passed_mass_kg"].contains(name);
            assert_eq!(value.is_empty(), is_undefined, "{name}: {csv}");
        }
    }
    let printed = gravel(&["simulate", "column", "--time-steps", "3", "--json"]).succeeded().stdout;
    let object: Value = serde_json::from_str(&printed).unwrap();
    for key in ["bulk_solid_fraction", "bulk_coordination", "bulk_rattlers"] {
        assert!(object["last_time_step"].get(key).is_some_and(Value::is_null), "{key}: {printed}");
    }
}

#[test]
fn what_is_rarely_meant_in_a_case_is_a_line_on_stderr() {
    let said = |sets: &[&str]| {
        let sets = sets.iter().flat_map(|set| ["--scene", *set]).collect::<Vec<_>>();
        gravel(&[&["simulate", "thrown-disc", "--time-steps", "2"], &sets[..]].concat()).succeeded().stderr
    };
    assert!(!said(&[]).contains("warning"));
    let friction = said(&["scene.friction=30"]);
    assert_eq!(friction.matches("warning: thrown-disc: `scene.friction` is 30").count(), 1, "{friction}");
    let far = said(&["scene.thrown_at_m_per_s=[60.0, 0.0]"]);
    assert!(
        far.contains("warning: thrown-disc: `scene.time_step_s` is 0.01: time step 1 moves grain 0"),
        "{far}"
    );
}

#[test]
fn a_deep_overlap_is_a_line_on_stderr_once() {
    let said = |sets: &[&str]| {
        let sets = sets.iter().flat_map(|set| ["--scene", *set]).collect::<Vec<_>>();
        let words = [&["simulate", "biaxial", "--time-steps", "60", "--tolerance", "1e-4"], &sets[..]];
        gravel(&words.concat()).succeeded().stderr
    };
    assert!(!said(&[]).contains("overlap"));
    let deep = said(&["scene.law=predicted-gap", "scene.time_step_s=0.02"]);
    assert_eq!(deep.matches("found an overlap of").count(), 1, "{deep}");
    assert!(deep.contains("a smaller `scene.time_step_s`"), "{deep}");
}

#[test]
fn simulation_refuses_to_replace_a_file() {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "kept.csv", "what was there");
    gravel(&["simulate", "column", "--time-steps", "3", "-o", text(&file)]).refused(&["kept.csv", "exists"]);
    assert_eq!(fs::read_to_string(&file).unwrap(), "what was there");
}

#[test]
fn simulation_says_how_many_time_steps_did_not_converge() {
    let printed =
        gravel(&["simulate", "column", "--time-steps", "3", "--max-iterations", "1"]).ended(3).stdout;
    assert!(printed.contains("3 of 3 time steps did not converge to natural_map ≤ 1e-6"), "{printed}");
}

#[test]
fn output_that_nobody_reads_stops_no_work() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("column.csv");
    let simulate = ["simulate", "column", "--time-steps", "3", "-o", text(&file)];
    for args in [&["list", "methods"][..], &["solve", "column"], &["solve", "column", "--json"], &simulate] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(args).stdout(writer).output().unwrap();
        let printed = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), &*printed), (Some(0), ""), "{args:?}");
    }
    assert_eq!(fs::read_to_string(file).unwrap().lines().count(), 1 + 3);
}
