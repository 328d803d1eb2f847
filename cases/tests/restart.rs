//! A march that resumes from the file of its state goes on bitwise as the one that did not stop.

use cases::{Case, CaseError, March, Marched, Start, grains_of_state};
use contact::{Discs, RoughDiscs, RoughSpheres, Solver, Spheres};
use nsgs::Nsgs;
use runner::Stop;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/");

fn case(name: &str, changes: &[(&str, &str)]) -> Case {
    let changes: Vec<_> =
        changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Case::read(&PathBuf::from(format!("{CASES}{name}.toml")), &changes).unwrap()
}

fn through<M: Marched>(march: &mut March<M>, time_steps: u64, start: Start)
where
    Nsgs: Solver<M>,
{
    // Few iterations, so that the impulses of one time step decide those of the next.
    let stop = Stop { tolerance: 1e-3, max_iterations: 30, ..Stop::default() };
    for _ in 0..time_steps {
        let next = march.next().unwrap();
        march.solve(&next, &Nsgs::default(), &stop, start, &|| false).unwrap();
    }
}

fn is_resumed_bitwise<M: Marched>(case: &Case)
where
    Nsgs: Solver<M>,
{
    for start in [Start::Previous, Start::Extrapolated, Start::Nothing] {
        let mut whole = March::<M>::new(case).unwrap();
        through(&mut whole, 12, start);
        let folder = TempDir::new().unwrap();
        let file = folder.path().join("state.json");
        fs::write(&file, whole.state(case).unwrap()).unwrap();
        let before = whole.state(case).unwrap();
        let mut resumed = March::<M>::new(case).unwrap();
        resumed.resume(case, &file).unwrap();
        assert_eq!(resumed.state(case).unwrap(), before, "as it was written");
        assert!(
            whole.next().unwrap().frozen.start.iter().any(|r| *r > 0.0),
            "there are impulses to start from"
        );
        through(&mut whole, 8, start);
        through(&mut resumed, 8, start);
        assert_eq!(resumed.state(case).unwrap(), whole.state(case).unwrap(), "{start:?}");
        assert_eq!(resumed.time_steps(), 20);
    }
}

#[test]
fn discs_resume_bitwise() {
    is_resumed_bitwise::<Discs>(&case(
        "settled-box",
        &[("sample.grains", "40"), ("scene.box.width_m", "1.0")],
    ));
}

#[test]
fn discs_with_friction_and_driven_bodies_resume_bitwise() {
    is_resumed_bitwise::<RoughDiscs>(&case("biaxial", &[]));
    is_resumed_bitwise::<RoughDiscs>(&case("periodic-shear", &[]));
}

#[test]
fn spheres_resume_bitwise() {
    let small = [("sample.grains", "40"), ("scene.box.width_m", "0.6"), ("scene.box.depth_m", "0.6")];
    is_resumed_bitwise::<Spheres>(&case("sphere-box", &small));
    let rough = [&small[..], &[("scene.friction", "0.3")]].concat();
    is_resumed_bitwise::<RoughSpheres>(&case("sphere-box", &rough));
}

fn refused(file: &Path, case: &Case) -> String {
    let error = March::<Discs>::new(case).unwrap().resume(case, file).unwrap_err();
    assert!(matches!(error, CaseError::Content { .. }), "{error}");
    let text = error.to_string();
    assert!(text.starts_with(file.to_str().unwrap()), "{text}");
    text
}

#[test]
fn state_of_something_else_or_a_damaged_one_is_refused_by_key_and_value() {
    let column = case("column", &[]);
    let mut march = March::<Discs>::new(&column).unwrap();
    through(&mut march, 3, Start::Previous);
    let text = march.state(&column).unwrap();
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("state.json");
    let write = |text: &str| fs::write(&file, text).unwrap();
    let says = |case: &Case, words: &[&str]| {
        let refused = refused(&file, case);
        for word in words {
            assert!(refused.contains(word), "no `{word}` in: {refused}");
        }
    };
    write(&text);
    says(
        &case("column", &[("scene.theta", "0.6")]),
        &["case column", "`scene.theta` is 0.5", "in this case it is 0.6"],
    );
    says(&case("column", &[("sample.grains", "7")]), &["`sample.grains` is ", "in this case it is 7"]);
    says(&case("settled-box", &[]), &["`sample."]);
    let changed = |from: &str, to: &str, words: &[&str]| {
        assert!(text.contains(from), "{from}");
        write(&text.replacen(from, to, 1));
        says(&column, words);
    };
    changed("gravel/state/1", "gravel/state/9", &["`format` is gravel/state/9", "gravel/state/1"]);
    changed("\"mechanics\":\"discs\"", "\"mechanics\":\"spheres\"", &["`mechanics` is spheres", "discs"]);
    changed("\"radius\":[", "\"radius\":[7.5,", &["`bodies.radius` has", "it must have"]);
    changed("\"candidate\":[0", "\"candidate\":[99", &["`last.candidate[0]` is 99"]);
    changed("\"time_steps\":3", "\"time_step\":3", &["`time_step`"]);
    changed("\"floor\"", "\"ceiling\"", &["ceiling"]);
    write(&text[..text.len() / 2]);
    says(&column, &["where the file ends"]);
    write("{}");
    says(&column, &["`format` is left out"]);
    write(&seal::sealed(&text).replacen("\"time_steps\":3", "\"time_steps\":4", 1));
    says(&column, &["damaged", "checksum"]);
}

/// A settled packing goes on with another friction, through the table of its grains.
#[test]
fn grains_of_a_state_begin_another_scene() {
    let sheared = case("periodic-shear", &[("sample.grains", "60")]);
    let mut march = March::<RoughDiscs>::new(&sheared).unwrap();
    through(&mut march, 10, Start::Previous);
    let folder = TempDir::new().unwrap();
    let (state, table) = (folder.path().join("state.json"), folder.path().join("grains.csv"));
    fs::write(&state, march.state(&sheared).unwrap()).unwrap();
    fs::write(&table, grains_of_state(&state).unwrap()).unwrap();
    let sample =
        format!("{{ kind = \"placed\", file = {:?}, density_kg_per_m2 = 1.0 }}", table.to_str().unwrap());
    let again = case("periodic-shear", &[("sample", &sample), ("scene.friction", "0.8")]);
    let begun = March::<RoughDiscs>::new(&again).unwrap();
    assert_eq!(begun.grain_count(), 60, "a lid is no grain");
    for ((radius, place, velocity), (was_radius, was_place, was_velocity)) in
        begun.grains().zip(march.grains()).take(60)
    {
        assert_eq!((radius, place, velocity), (was_radius, was_place, was_velocity));
    }
    for (k, (mass, was)) in begun.mass().iter().zip(march.mass()).take(60).enumerate() {
        assert!(
            (mass.mass / was.mass - 1.0).abs() < 1e-12 && begun.velocity()[k].z == march.velocity()[k].z,
            "{k}"
        );
    }
    fs::write(&state, "{}").unwrap();
    let error = grains_of_state(&state).unwrap_err().to_string();
    assert!(error.contains("state.json") && error.contains("`format`"), "{error}");
}
