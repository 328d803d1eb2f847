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
    for method in ["cg", "apgd", "nncg"] {
        assert_same(&format!("settled-991 --method {method} --max-iterations 40"));
    }
    assert_same("settled-991 --method interior-point --max-iterations 3");
}

#[test]
fn subdomains_give_the_same_bits() {
    for setting in ["subdomains=4x2", "subdomains=5x5", "partition=balanced --set subdomains=4x2"] {
        assert_same(&format!("settled-991 --method nsgs-dd --set {setting} --max-iterations 40"));
    }
}

#[test]
fn subdomains_that_work_in_threads_give_the_same_bits() {
    for exchange in ["jacobi", "gauss-seidel"] {
        let settings = format!("--set subdomains=5x5 --set exchange={exchange} --set inner_sweeps=8");
        let object = assert_same(&format!("settled-991 --method nsgs-dd {settings} --max-iterations 20"));
        // From 10,000 updates between two gluings on, NSGS-DD gives its subdomains to the threads.
        assert!(object["contacts"].as_u64().unwrap() * 8 >= 10_000);
        assert_eq!(object["iterations"], 20);
    }
}

#[test]
fn latin_in_threads_gives_the_same_bits() {
    // From 2,000 contacts on, LATIN-DD gives its subdomains to the threads.
    for settings in ["--set subdomains=4x2", "--set subdomains=8x8 --set partition=balanced"] {
        let object = assert_same(&format!("settled-991 --method latin-dd {settings} --max-iterations 40"));
        assert!(object["contacts"].as_u64().unwrap() >= 2_000);
    }
}

#[test]
fn cg_in_blocks_gives_the_same_bits() {
    let large = "deposited-box --scene sample.grains=5000 --scene scene.box.width_m=10.7";
    let object = assert_same(&format!("{large} --method cg --max-iterations 20"));
    // From 8,192 contacts on, CG passes over them in several blocks, in threads.
    assert!(object["contacts"].as_u64().unwrap() > 8_192);
}

#[test]
fn march_gives_the_same_bits() {
    assert_same(
        "settled-box --scene sample.grains=40 --scene scene.box.width_m=1 --time-step 20 --method nsgs",
    );
}
