//! Every case of the folder `literature` can be run, and the page names each.

use cases::{Case, March, Marched};
use contact::{Discs, Measure, RoughDiscs, RoughSpheres, Solver, Spheres};
use nsgs::Nsgs;
use runner::Stop;
use std::path::{Path, PathBuf};

fn two_time_steps<M: Marched>(case: &Case) -> usize
where
    Nsgs: Solver<M>,
{
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-2, max_iterations: 50 };
    let mut march = March::<M>::new(case).unwrap_or_else(|error| panic!("{error}"));
    let mut contacts = 0;
    for _ in 0..2 {
        let (_, seen) =
            march.time_step(&Nsgs::default(), &stop).unwrap_or_else(|error| panic!("{}: {error}", case.name));
        contacts += seen.contacts;
    }
    assert!(march.grain_count() > 0 && march.velocity().len() >= march.grain_count());
    contacts
}

fn run(path: &Path) -> usize {
    let case = Case::read(path, &[]).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(Some(case.name.as_str()), path.file_stem().and_then(|stem| stem.to_str()));
    assert!(case.source.chars().any(|c| c.is_ascii_digit()), "{}: a source has its year", case.name);
    match (case.in_space().unwrap(), case.scene.is_rough()) {
        (false, false) => two_time_steps::<Discs>(&case),
        (false, true) => two_time_steps::<RoughDiscs>(&case),
        (true, false) => two_time_steps::<Spheres>(&case),
        (true, true) => two_time_steps::<RoughSpheres>(&case),
    }
}

#[test]
fn each_scene_of_the_literature_runs_and_is_on_the_page() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(folder.join("literature.md")).unwrap();
    let files = std::fs::read_dir(folder.join("literature")).unwrap();
    let mut files: Vec<PathBuf> = files.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for file in &files {
        let contacts = run(file);
        let name = file.file_stem().unwrap().to_str().unwrap();
        assert!(contacts > 0, "{name}: nothing touches");
        assert!(
            page.contains(&format!("`gravel simulate cases/literature/{name}.toml --time-steps 3`")),
            "{name} is not on the page"
        );
    }
    assert!(files.len() >= 20, "{} files", files.len());
    assert_eq!(page.matches("(literature/").count(), files.len(), "the page links no other file");
}
