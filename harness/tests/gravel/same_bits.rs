//! The same request gives the same bits: again, and with any number of threads.

use crate::common::{gravel, text};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// What `gravel solve` prints, less its seconds, and the bytes of its impulses.
fn solve(threads: &str, request: &str) -> (Value, Vec<u8>) {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("r.json");
    let mut args = vec!["--threads", threads, "solve", "--json", "--impulses", text(&file)];
    args.extend(request.split_whitespace());
    let mut object = gravel(&args).json();
    object.as_object_mut().unwrap().retain(|key, _| !key.ends_with("_s"));
    (object, fs::read(file).unwrap())
}

/// With one thread and with two, the second twice; returns what was printed.
#[track_caller]
fn assert_same(request: &str) -> Value {
    let one = solve("1", request);
    let two = solve("2", request);
    assert!(one == two, "{request}: one thread and two differ: {} {}", one.0, two.0);
    assert!(two == solve("2", request), "{request}: two runs differ");
    one.0
}

#[test]
fn methods_without_subdomains_give_the_same_bits() {
    assert_same("settled-991 --method nsgs --max-iterations 40");
    assert_same("settled-991 --method nsgs --set order=shuffled --set seed=7 --max-iterations 40");
    assert_same("settled-991 --method jacobi --max-iterations 40");
    for method in ["cg", "apgd", "mprgp", "nncg", "active-set"] {
        assert_same(&format!("settled-991 --method {method} --max-iterations 40"));
    }
    assert_same("settled-991 --method interior-point --max-iterations 3");
}

#[test]
fn subdomains_give_the_same_bits() {
    for setting in ["subdomains=4x2", "subdomains=5x5", "partition=balanced --set subdomains=4x2"] {
        let object =
            assert_same(&format!("settled-991 --method nsgs-dd --set {setting} --max-iterations 40"));
        assert!(object["derived"]["critical_path"].as_f64() > Some(0.0), "{setting}: {object}");
    }
}

#[test]
fn methods_that_work_in_threads_give_the_same_bits() {
    let folder = TempDir::new().unwrap();
    let large = folder.path().join("large.json");
    let size = ["--scene", "sample.grains=18000", "--scene", "scene.box.width_m=20.4"];
    let freeze = ["freeze", "deposited-box", "--time-step", "1", "-o", text(&large)];
    gravel(&[freeze.as_slice(), &size].concat()).succeeded();
    let large = text(&large);
    let subdomains = "--set subdomains=16x16 --set partition=balanced";
    for method in ["cg", "nsgs-dd", "nsgs-dd --set exchange=gauss-seidel --set inner_sweeps=4", "latin-dd"] {
        let subdomains = if method == "cg" { "" } else { subdomains };
        let object = assert_same(&format!("{large} --method {method} {subdomains} --max-iterations 20"));
        assert_eq!(object["iterations"], 20, "{method}");
        // From a tenth of a millisecond on, threads are woken: by all passes over these contacts, and over these copies.
        assert!(object["contacts"].as_u64().unwrap() >= 34_000, "{method}");
        let copies = object["interface_values"].as_u64().unwrap() / (2 * 20);
        assert!(method == "cg" || copies >= 5_000, "{method}: {copies}");
    }
}

#[test]
fn march_gives_the_same_bits() {
    assert_same(
        "settled-box --scene sample.grains=40 --scene scene.box.width_m=1 --time-step 20 --method nsgs",
    );
}
