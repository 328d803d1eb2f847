//! `gravel freeze`: the file stands for the time step of the case, bit by bit.

use crate::common::{checkout, entries, frozen_names, gravel, pair, text, write};
use cases::{AnyFrozen, Frozen};
use contact::Discs;
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

/// A time step of a packing of few discs, in which some contacts are new and some are not.
const PACKING: [&str; 7] =
    ["settled-box", "--scene", "sample.grains=40", "--scene", "scene.box.width_m=1", "--time-step", "20"];

/// What `gravel solve` with `args` prints, less seconds and name, and the bytes of its impulses.
fn solve(args: &[&str]) -> (Value, Vec<u8>) {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("r.json");
    let mut object = gravel(&[&["solve", "--json", "--impulses", text(&file)], args].concat()).json();
    object.as_object_mut().unwrap().retain(|key, _| !key.ends_with("_s") && key != "problem");
    (object, fs::read(file).unwrap())
}

#[test]
fn frozen_time_step_solves_like_that_of_the_case() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("packing.json");
    // What `solve` marches with.
    let cg = ["--method", "cg", "--set", "preconditioner=diagonal"];
    gravel(&[&["freeze", "-o", text(&file)], &PACKING[..], &cg].concat()).succeeded();
    let named = fs::read(&file).unwrap();
    gravel(&[&["freeze", "--force", "-o", text(&file)], &PACKING[..]].concat()).succeeded();
    assert!(named == fs::read(&file).unwrap(), "without a method it is another problem");
    for start in ["cold", "warm"] {
        let end = ["--start", start, "--method", "nsgs", "--tolerance", "1e-3"];
        let frozen = solve(&[&[text(&file)], &end[..]].concat());
        let direct = solve(&[&PACKING[..], &end[..]].concat());
        assert!(frozen.0["contacts"].as_u64().unwrap() > 40, "{}", frozen.0);
        assert_eq!(frozen.0, direct.0);
        assert!(frozen.1 == direct.1, "impulses differ from a {start} start");
    }
}

#[test]
fn time_step_frozen_twice_gives_the_same_bytes() {
    let frozen = || {
        let folder = TempDir::new().unwrap();
        let file = folder.path().join("packing.json");
        gravel(&[&["freeze", "-o", text(&file)], &PACKING[..]].concat()).succeeded();
        fs::read(file).unwrap()
    };
    assert!(frozen() == frozen());
}

#[test]
fn existing_file_is_kept_unless_forced() {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "kept.json", "what was there");
    let freeze = ["freeze", "column", "--time-step", "1", "-o", text(&file)];
    gravel(&freeze).refused(&["kept.json", "exists", "--force"]);
    assert_eq!(fs::read_to_string(&file).unwrap(), "what was there");
    gravel(&[&freeze[..], &["--force"]].concat()).succeeded();
    assert_eq!(Frozen::<Discs>::read(&file).unwrap().name, "kept");
    assert_eq!(entries(folder.path()), ["kept.json"], "nothing else is left");
}

#[test]
fn moment_of_a_case_is_its_time_step() {
    let folder = TempDir::new().unwrap();
    let case = fs::read_to_string(checkout().join("cases/column.toml")).unwrap();
    let case = write(&folder, "column.toml", &case.replace("[sample]", "[moments]\nlater = 3\n\n[sample]"));
    let frozen = |moment| {
        let file = folder.path().join("frozen.json");
        gravel(&["freeze", text(&case), "--time-step", moment, "-o", text(&file), "--force"]).succeeded();
        fs::read(file).unwrap()
    };
    assert!(frozen("later") == frozen("3"));
    assert!(frozen("later") != frozen("2"));
}

#[test]
fn file_says_how_the_time_step_was_reached() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("packing.json");
    gravel(&[&["freeze", "--tolerance", "1e-3", "-o", text(&file)], &PACKING[..]].concat()).succeeded();
    let Frozen { name, source, time_step, .. } = Frozen::<Discs>::read(&file).unwrap();
    assert_eq!((&*name, time_step), ("packing", 0.005));
    for word in ["settled-box", "time step 20", "iqs", "sample.grains = 40", "cg", "natural_map ≤ 1e-3"] {
        assert!(source.contains(word), "no `{word}` in: {source}");
    }
}

#[test]
fn file_says_how_many_time_steps_before_did_not_converge() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("packing.json");
    let freeze = [&["freeze", "-o", text(&file)], &PACKING[..]].concat();
    let words = "of the 19 time steps before did not converge.";
    let stopped = gravel(&[&freeze[..], &["--max-iterations", "1"]].concat()).succeeded();
    assert!(stopped.stderr.contains(words), "{}", stopped.stderr);
    assert!(Frozen::<Discs>::read(&file).unwrap().source.ends_with(words));
    let whole = gravel(&[&freeze[..], &["--force"]].concat()).succeeded();
    assert_eq!(whole.stderr, "");
    assert!(!Frozen::<Discs>::read(&file).unwrap().source.contains("did not converge"));
}

#[test]
fn reading_and_writing_a_problem_keeps_all_bits() {
    let folder = TempDir::new().unwrap();
    let mut odd = pair();
    // Least and greatest numbers, a negative zero, and a sum that no short decimal names.
    odd["grains"]["mass"] = json!([f64::MIN_POSITIVE, f64::MAX]);
    odd["grains"]["free_velocity"] = json!([[-0.0, 5e-324], [0.1 + 0.2, -1.0 / 3.0]]);
    odd["contacts"]["normal"] = json!([[0.6, 0.8], [-0.28, 0.96]]);
    let mut files = vec![write(&folder, "odd.json", &odd.to_string())];
    let folder_of = checkout().join("cases/frozen");
    files.extend(frozen_names().iter().map(|name| folder_of.join(format!("{name}.json"))));
    for file in files {
        let read = AnyFrozen::read(&file).unwrap();
        let written = read.to_json().unwrap();
        let again = AnyFrozen::read(&write(&folder, "again.json", &written)).unwrap();
        assert_eq!(format!("{read:?}"), format!("{again:?}"), "{}", file.display());
        // Equal numbers have equal texts, and -0 has another than 0.
        assert!(again.to_json().unwrap() == written, "{}", file.display());
        let values = |text: &str| serde_json::from_str::<Value>(text).unwrap();
        let (before, after) = (values(&fs::read_to_string(&file).unwrap()), values(&written));
        for (key, list) in [("grains", "mass"), ("grains", "free_velocity"), ("contacts", "normal")] {
            assert_eq!(bits(&before[key][list]), bits(&after[key][list]), "{} {list}", file.display());
        }
    }
}

/// The bits of all numbers of a list, or of a list of lists.
fn bits(value: &Value) -> Vec<u64> {
    match value {
        Value::Array(values) => values.iter().flat_map(bits).collect(),
        number => vec![number.as_f64().unwrap().to_bits()],
    }
}
