//! Problems with nothing to do, or with grains that have nothing to do.

use crate::common::{gravel, impulses, methods, pair, pair_with, text, write};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Every method ends on the problem before its first iteration, without impulses.
#[track_caller]
fn nothing_to_do(problem: &Value) {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "problem.json", &problem.to_string());
    let contacts = problem["contacts"]["candidate"].as_array().unwrap().len();
    for start in ["cold", "warm"] {
        for (method, _) in methods() {
            let request = [text(&file), "--method", &method, "--start", start, "--json"];
            let object = gravel(&[&["solve"], &request[..]].concat()).json();
            assert_eq!(
                (&object["status"], &object["iterations"]),
                (&json!("converged"), &json!(0)),
                "{method}"
            );
            assert_eq!(object["natural_map"], 0.0, "{method}");
            assert_eq!(impulses(&request), vec![0.0; contacts], "{method}");
        }
    }
}

fn without_contacts(grains: Value) -> Value {
    let mut problem = pair_with("/grains", grains);
    for list in problem["contacts"].as_object_mut().unwrap().values_mut() {
        *list = json!([]);
    }
    problem
}

#[test]
fn problem_without_contacts_is_solved_at_iteration_zero() {
    nothing_to_do(&without_contacts(pair()["grains"].clone()));
}

#[test]
fn one_grain_without_contact_is_solved_at_iteration_zero() {
    nothing_to_do(&without_contacts(
        json!({ "mass": [1.0], "radius": [0.5], "position": [[0.0, 3.0]], "free_velocity": [[0.0, -1.0]] }),
    ));
}

#[test]
fn problem_without_grains_is_solved_at_iteration_zero() {
    nothing_to_do(&without_contacts(
        json!({ "mass": [], "radius": [], "position": [], "free_velocity": [] }),
    ));
}

#[test]
fn contacts_that_do_not_close_carry_nothing_whatever_they_carried_before() {
    // A gap of 1 mm closes at 0.2 m/s at least; the discs fall at 0.05 m/s, and b = 0 between them.
    let mut open = pair_with("/contacts/offset", json!([0.2, 0.0]));
    open["contacts"]["gap"] = json!([0.001, 0.0]);
    open["contacts"]["start"] = json!([0.15, 0.1]);
    nothing_to_do(&open);
}

#[test]
fn grain_without_contact_beside_a_column_changes_nothing() {
    let folder = TempDir::new().unwrap();
    let mut beside = pair();
    let grains = beside["grains"].as_object_mut().unwrap();
    let free = [json!(5.0), json!(0.5), json!([9.0, 9.0]), json!([0.0, -3.0])];
    for (key, value) in ["mass", "radius", "position", "free_velocity"].into_iter().zip(free) {
        grains[key].as_array_mut().unwrap().push(value);
    }
    let alone = write(&folder, "alone.json", &pair().to_string());
    let beside = write(&folder, "beside.json", &beside.to_string());
    for (method, _) in methods() {
        let r = |file, setting: &[&str]| impulses(&[&[text(file), "--method", &method], setting].concat());
        assert_eq!(r(&beside, &[]), r(&alone, &[]), "{method}");
        // The discs weigh 1 kg and 2 kg, and fall at 0.05 m/s; their system's condition number is below 14, so
        // that `natural_map` ≤ 1e-6 leaves no error of 1e-4.
        let solved = r(&beside, &[]);
        assert!((solved[0] - 0.15).abs() < 1e-4 && (solved[1] - 0.1).abs() < 1e-4, "{method}: {solved:?}");
        if method.ends_with("-dd") {
            // The grain widens the boxes: the right one of 2x1 is empty.
            let both = ["--set", "subdomains=2x1"];
            assert_eq!(r(&beside, &both), r(&alone, &[]), "{method}");
        }
    }
}
