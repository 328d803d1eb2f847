//! `gravel solve`: what it prints, what it writes, how it ends.

use crate::common::{gravel, impulses, methods, pair, pair_with, text, write};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fs;
use tempfile::TempDir;

#[test]
fn run_that_ends_at_once_without_an_impulse_says_what_to_check() {
    let folder = TempDir::new().unwrap();
    let loose = gravel(&["solve", "settled-60", "--tolerance", "5"]).succeeded();
    assert!(loose.stdout.contains("converged after 0 iterations"), "{}", loose.stdout);
    let warning = "warning: no contact pushes: natural_map is 1.000e0 without any impulse";
    assert!(loose.stderr.starts_with(warning), "{}", loose.stderr);
    assert!(loose.stderr.contains("`--tolerance 5` allows"), "{}", loose.stderr);
    // The normal of the floor the wrong way round, and no contact closes.
    let turned = pair_with("/contacts/normal", json!([[0.0, -1.0], [0.0, 1.0]]));
    let turned = write(&folder, "turned.json", &turned.to_string());
    for more in [&[][..], &["--json"]] {
        let ran = gravel(&[&["solve", text(&turned)], more].concat()).succeeded();
        assert!(ran.stderr.contains("no contact pushes, since none closes"), "{}", ran.stderr);
        assert!(ran.stderr.contains("`contacts.normal` points from the antagonist"), "{}", ran.stderr);
    }
    assert_eq!(gravel(&["solve", "settled-60"]).succeeded().stderr, "");
}

/// Where every μ is 0, grains have no spin, and a method that needs a minimum takes the problem.
#[test]
fn friction_of_zero_is_none() {
    let small =
        ["--scene", "sample.grains=20", "--scene", "scene.box.width_m=0.6", "--time-step", "5", "--json"];
    let mechanics = |friction: &str| {
        let friction = format!("scene.friction={friction}");
        gravel(&[&["solve", "rough-box", "--scene", &friction], &small[..]].concat()).json()["mechanics"]
            .clone()
    };
    assert_eq!([mechanics("0"), mechanics("0.3")], [json!("discs"), json!("rough-discs")]);
}

/// Weight impulse of a disc of `radius` (m) over the time step of the cases, and their gravity and density (N·s).
fn weight(radius: f64) -> f64 {
    1000.0 * PI * radius * radius * 9.81 * 0.005
}

#[track_caller]
fn assert_close(value: f64, expected: f64) {
    // `natural_map` ≤ 1e-13 is asked where this is used; the impulses of twenty discs may be 10⁴ times less exact.
    assert!((value - expected).abs() <= 1e-9 * expected, "{value} instead of {expected}");
}

const EXACT: [&str; 2] = ["--tolerance", "1e-13"];

#[test]
fn json_is_one_object_with_the_ending_the_measures_the_work_and_the_settings() {
    let object = gravel(&["solve", "column", "--json", "--method", "nsgs", "--tolerance", "1e-2"]).json();
    assert_eq!(object["status"], "converged");
    let iterations = object["iterations"].as_u64().unwrap();
    assert!(iterations > 0);
    for key in [
        "zeta",
        "natural_map",
        "penetration_rate_m_per_s",
        "quad_dv",
        "max_dv",
        "velocity_jump_m_per_s",
        "setup_s",
        "iterating_s",
    ] {
        assert!(object[key].as_f64().is_some_and(|value| value >= 0.0), "{key}: {}", object[key]);
    }
    assert!(object["natural_map"].as_f64().unwrap() <= 1e-2);
    assert!(object["worst_contact"].as_u64().unwrap() < 20);
    // NSGS updates each contact once per iteration and does no other work.
    for (count, _) in contact::Work::default().named() {
        let expected = if count == "contact_updates" { 20 * iterations } else { 0 };
        assert_eq!(object[count].as_u64(), Some(expected), "{count}");
    }
    assert_eq!(
        (&object["problem"], &object["grains"], &object["contacts"]),
        (&json!("column-t1"), &json!(20), &json!(20))
    );
    let stop = ["stop_on", "tolerance", "max_iterations"].map(|key| &object[key]);
    assert_eq!(stop, [&json!("natural_map"), &json!(1e-2), &json!(100_000)]);
}

#[test]
fn json_spells_out_the_defaults_of_every_method() {
    for (method, defaults) in methods() {
        let limit = ["--json", "--max-iterations", "0"];
        let object = gravel(&[&["solve", "column", "--method", &method], &limit[..]].concat()).json();
        assert_eq!(object["method"], method.as_str());
        assert_eq!(object["settings"], defaults, "{method}");
    }
    let set = gravel(&["solve", "column", "--json", "--method", "nsgs", "--set", "relaxation=1.5"]).json();
    let settings = json!({
        "order": "natural", "relaxation": 1.5, "seed": 1, "symmetric": false,
        "acceleration": "none", "lag": 2.0, "slack": null, "precision": "double"
    });
    assert_eq!(set["settings"], settings);
}

#[test]
fn zeta_of_no_iteration_is_null() {
    let object = gravel(&["solve", "column", "--json", "--max-iterations", "0"]).json();
    assert_eq!((&object["iterations"], &object["zeta"]), (&json!(0), &Value::Null));
    assert_eq!(object["natural_map"], 1.0, "at r = 0, by its definition");
}

#[test]
fn zeta_from_no_impulse_is_null() {
    let object = gravel(&["solve", "column", "--json", "--max-iterations", "1"]).json();
    assert_eq!((&object["iterations"], &object["zeta"]), (&json!(1), &Value::Null));
}

#[test]
fn two_discs_carry_their_weight_in_the_order_of_the_frozen_contacts() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("two-discs.json");
    gravel(&["freeze", "two-discs", "--time-step", "1", "-o", text(&file)]).succeeded();
    let frozen: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    let antagonists = frozen["contacts"]["antagonist"].as_array().unwrap();
    assert_eq!(antagonists.len(), 2);
    for (method, _) in methods() {
        let r = impulses(&[&["two-discs", "--method", &method], &EXACT[..]].concat());
        assert_eq!(r.len(), 2);
        for (r, antagonist) in r.iter().zip(antagonists) {
            // The case lays a disc of 1 m on one of 0.5 m; only the lower one touches the floor.
            let expected = if antagonist.is_null() { weight(0.5) + weight(1.0) } else { weight(1.0) };
            assert_close(*r, expected);
        }
    }
}

#[test]
fn contact_of_a_column_carries_the_discs_above_it() {
    let mut r = impulses(&[&["column", "--method", "cg"], &EXACT[..]].concat());
    assert_eq!(r.len(), 20);
    r.sort_by(f64::total_cmp);
    for (above, r) in (1..).zip(r) {
        assert_close(r, f64::from(above) * weight(0.5));
    }
}

#[test]
fn file_of_impulses_is_replaced_and_that_is_said() {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "r.json", "before");
    let ran = gravel(&["solve", "column", "--impulses", text(&file)]).succeeded();
    assert!(ran.stderr.contains(&format!("replacing {}", text(&file))), "{}", ran.stderr);
    assert!(fs::read_to_string(&file).unwrap().starts_with("{\"impulse\":["));
}

#[test]
fn run_that_reaches_its_limit_ends_well() {
    let object = gravel(&["solve", "column", "--json", "--method", "nsgs", "--max-iterations", "3"]).json();
    assert_eq!((&object["status"], &object["iterations"]), (&json!("iteration-limit"), &json!(3)));
}

#[test]
fn jacobi_without_relaxation_diverges_on_a_packing_and_ends_well() {
    for problem in ["settled-991", "shear-box-991-sheared"] {
        let jacobi = ["--method", "jacobi", "--set", "relaxation=1"];
        let object = gravel(&[&["solve", problem, "--json"], &jacobi[..]].concat()).json();
        assert_eq!(object["status"], "diverged", "{problem}");
        assert!(object["energy_j"].as_f64().unwrap() > 0.0, "far above q(0) = 0");
    }
}

#[test]
fn text_names_the_ending_and_every_measure() {
    let printed = gravel(&["solve", "column", "--method", "nsgs", "--max-iterations", "3"]).ended(3).stdout;
    let words =
        ["column-t1: 20 grains, 20 contacts", "\"relaxation\":1.0", "iteration-limit after 3 iterations"];
    let measures = ["zeta", "natural_map", "penetration_rate", "quad_dv", "max_dv", "worst_contact"];
    for word in words.iter().chain(&measures) {
        assert!(printed.contains(word), "no `{word}` in: {printed}");
    }
    let printed = gravel(&["solve", "column", "--max-iterations", "1"]).ended(3).stdout;
    assert!(printed.contains("iteration-limit after 1 iteration (asked: natural_map ≤ 1e-6)"), "{printed}");
}

#[test]
fn warm_start_begins_from_the_impulses_of_the_file() {
    let folder = TempDir::new().unwrap();
    let mut problem = pair();
    // The solution: the discs weigh 1 kg and 2 kg, and fall at 0.05 m/s.
    problem["contacts"]["start"] = json!([0.15, 0.1]);
    let file = write(&folder, "pair.json", &problem.to_string());
    let solve = |start| gravel(&["solve", text(&file), "--json", "--start", start]).json();
    let (cold, warm) = (solve("cold"), solve("warm"));
    assert_eq!((&cold["warm_start"], &warm["warm_start"]), (&json!(false), &json!(true)));
    assert!(cold["iterations"].as_u64().unwrap() > 0);
    assert_eq!(warm["iterations"], 0);
}

#[test]
fn subdomains_as_a_material_sum_to_the_whole_whatever_the_threads() {
    let folder = TempDir::new().unwrap();
    let table = |name: &str, threads: &str, subdomains: &str| {
        let file = folder.path().join(name);
        let method = ["--method", "nsgs-dd", "--set", subdomains, "--homogenised", text(&file)];
        gravel(&[&["--threads", threads, "solve", "column", "--tolerance", "1e-12"][..], &method].concat())
            .succeeded();
        fs::read_to_string(file).unwrap()
    };
    let (parts, whole) = (table("two", "1", "subdomains=1x2"), table("one", "1", "subdomains=1x1"));
    assert_eq!(parts, table("two-threads", "2", "subdomains=1x2"));
    let head = "subdomain,grains,area_m2,coordination,pressure_n_per_m,stress_xx_n_per_m,stress_yy_n_per_m,";
    assert!(parts.starts_with(head), "{parts}");
    // Areas times σ_yy.
    let sum = |table: &str| -> f64 {
        let rows = table.lines().skip(1).map(|row| row.split(',').collect::<Vec<_>>());
        rows.map(|row| row[2].parse::<f64>().unwrap() * row[6].parse::<f64>().unwrap()).sum()
    };
    // Over all 20 discs Σ ½ (39 − 2k) m g, and 1 m² each.
    let expected = 200.0 * weight(0.5) / 0.005;
    for sum in [sum(&parts), sum(&whole)] {
        assert!((sum / expected - 1.0).abs() < 1e-8, "{sum} instead of {expected}");
    }
}
