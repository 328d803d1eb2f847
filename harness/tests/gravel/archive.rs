//! Packed studies: the same bytes again, made again from what is packed alone, and refused where something was changed.

use crate::bench::Study;
use crate::common::{gravel, text, write};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A study of a frozen problem and a case, packed.
fn packed() -> (Study, PathBuf) {
    let study = Study::new();
    let plan = "name = \"packed\"\nwhy = \"A test.\"\nproblems = [\"pair\"]\n[stop]\non = \"natural_map\"\ntolerance = 1e-4\nmax_iterations = 500\n\
                [[cases]]\ncase = \"column\"\naxes = { \"sample.grains\" = [3, 4] }\n\
                [[methods]]\nmethod = \"nsgs\"\n[[methods]]\nmethod = \"cg\"\n";
    write(study.folder(), "harness/plans/packed.toml", plan);
    study.bench("packed");
    let file = study.folder().path().join("packed.tar");
    study.gravel(&["archive", "packed", "-o", text(&file)]).succeeded();
    (study, file)
}

/// Files of a pack, in a folder.
fn opened(file: &Path, into: &Path) {
    fs::create_dir_all(into).unwrap();
    assert!(Command::new("tar").args(["xf", text(file), "-C", text(into)]).status().unwrap().success());
}

/// A pack of the files of a folder.
fn closed(folder: &Path) -> PathBuf {
    let file = folder.with_extension("tar");
    let pack = |names: &[String]| {
        let tar = Command::new("tar").args(["cf", text(&file), "-C", text(folder)]).args(names).status();
        assert!(tar.unwrap().success());
    };
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    pack(&names.collect::<Vec<_>>());
    // As the program packs them, files alone.
    let listed = Command::new("tar").args(["tf", text(&file)]).output().unwrap();
    let listed = String::from_utf8(listed.stdout).unwrap();
    let names = listed.lines().filter(|name| !name.ends_with('/')).map(str::to_owned);
    pack(&names.collect::<Vec<_>>());
    file
}

#[test]
fn packed_study_has_the_same_bytes_and_counts_the_same_from_what_is_packed() {
    let (study, file) = packed();
    let again = study.folder().path().join("again.tar");
    study.gravel(&["archive", "packed", "-o", text(&again)]).succeeded();
    assert!(fs::read(&file).unwrap() == fs::read(&again).unwrap());
    study.gravel(&["archive", "packed", "-o", text(&again)]).refused(&["again.tar", "exists"]);
    let metadata = study.folder().path().join("opened");
    opened(&file, &metadata);
    let crate_: Value =
        serde_json::from_slice(&fs::read(metadata.join("ro-crate-metadata.json")).unwrap()).unwrap();
    let graph = crate_["@graph"].as_array().unwrap();
    let named = |id: &str| graph.iter().find(|entity| entity["@id"] == id).unwrap();
    let parts = named("./")["hasPart"].as_array().unwrap();
    for part in
        ["rows/runs.parquet", "harness/plans/packed.toml", "cases/column.toml", "cases/frozen/pair.json"]
    {
        assert!(parts.iter().any(|named| named["@id"] == part), "{part}");
        let length = fs::metadata(metadata.join(part)).unwrap().len().to_string();
        assert_eq!(named(part)["contentSize"], Value::from(length));
    }
    // In another checkout, which knows no `pair`.
    let checked = gravel(&["archive", "check", text(&file), "--share", "100"]).succeeded().stdout;
    assert!(
        checked.ends_with(
            "packed: 6 runs, checksums right; 6 drawn; of this code 0 differ, of earlier code 0\n"
        ),
        "{checked}"
    );
    let rows = study.runs("packed");
    let one = study.gravel(&["archive", "check", text(&rows), "--share", "1"]).succeeded().stdout;
    assert!(one.contains("1 drawn;"), "{one}");
    let none = study
        .gravel(&["archive", "check", text(&rows), "--share", "100", "--budget", "0"])
        .succeeded()
        .stdout;
    assert!(none.contains("6 drawn, 6 beyond the budget"), "{none}");
}

#[test]
fn changed_packs_are_refused_and_other_counts_found() {
    let (study, file) = packed();
    let folder = study.folder().path().join("changed");
    opened(&file, &folder);
    let case = folder.join("cases/column.toml");
    let (metadata, text_of_case) =
        (folder.join("ro-crate-metadata.json"), fs::read_to_string(&case).unwrap());
    fs::write(&case, format!("{text_of_case}\n# changed\n")).unwrap();
    gravel(&["archive", "check", text(&closed(&folder))]).refused(&[
        "changed.tar",
        "cases/column.toml",
        "`sha256` is",
        "was changed",
    ]);
    fs::remove_file(&case).unwrap();
    gravel(&["archive", "check", text(&closed(&folder))]).refused(&["cases/column.toml", "is not there"]);
    fs::write(&case, &text_of_case).unwrap();
    write(study.folder(), "changed/cases/other.toml", "");
    gravel(&["archive", "check", text(&closed(&folder))]).refused(&["cases/other.toml", "does not name it"]);
    fs::remove_file(folder.join("cases/other.toml")).unwrap();
    gravel(&["archive", "check", text(&closed(&folder))]).succeeded();
    fs::remove_file(&metadata).unwrap();
    gravel(&["archive", "check", text(&closed(&folder))]).refused(&["it has no ro-crate-metadata.json"]);
    gravel(&["archive", "check", text(&case)]).refused(&["column.toml", "no tar archive"]);
    gravel(&["archive", "check", "absent"]).refused(&["absent"]);
    study.gravel(&["archive", "packed", "-o", "x.zip"]).refused(&["--output x.zip", ".tar"]);
    gravel(&["archive", "check", text(&file), "--share", "101"]).refused(&["101", "0 to 100"]);
    // A journal that says what no run counts.
    let journal = study.runs("packed").join("journal.jsonl");
    let lines = crate::common::without_checksums(&fs::read_to_string(&journal).unwrap());
    let (before, rest) = lines.split_once("\"iterations\":").unwrap();
    let after = rest.trim_start_matches(|c: char| c.is_ascii_digit());
    fs::write(&journal, format!("{before}\"iterations\":499{after}")).unwrap();
    study.gravel(&["bench", "packed"]).succeeded();
    let found =
        study.gravel(&["archive", "check", text(&study.runs("packed")), "--share", "100"]).failed().stdout;
    assert!(
        found.contains("`iterations` was 499, and is") && found.contains("of this code 1 differ"),
        "{found}"
    );
}

#[test]
fn archived_rows_are_renewed_by_those_of_the_same_method_and_problem_alone() {
    let (study, _) = packed();
    let (archived, runs) = (study.folder().path().join("archived"), study.runs("packed"));
    fs::create_dir(&archived).unwrap();
    for file in fs::read_dir(&runs).unwrap().map(|entry| entry.unwrap().path()) {
        if file.extension().is_some_and(|ending| ending == "parquet") {
            fs::copy(&file, archived.join(file.file_name().unwrap())).unwrap();
        }
    }
    let renew = || study.gravel(&["archive", "renew", text(&archived), text(&runs)]);
    let seconds = || {
        let study = results::store::read(&archived).unwrap().0;
        let results::study::Study::Runs(runs) = study else { panic!("simulations") };
        let all = runs.records.into_iter().map(|one| (one.run.method, one.run.timing.wall_s));
        all.collect::<Vec<_>>()
    };
    let before = seconds();
    study.gravel(&["bench", "packed", "--fresh", "--only", "method=nsgs"]).succeeded();
    let said = renew().succeeded().stdout;
    assert!(said.contains("6 runs, renewed by 3 runs: 6 runs now"), "{said}");
    for (before, after) in before.iter().zip(seconds()) {
        assert!(before.0 == after.0 && (before.1 == after.1) == (after.0 == "cg"), "{before:?} {after:?}");
    }
    // Two of the problems are others now, and `cg` was not run on them.
    let case = study.folder().path().join("cases/column.toml");
    let text_of_case = fs::read_to_string(&case).unwrap();
    let changed = text_of_case.replace("density_kg_per_m2 = ", "density_kg_per_m2 = 2");
    assert_ne!(changed, text_of_case);
    fs::write(&case, changed).unwrap();
    study.gravel(&["bench", "packed", "--fresh", "--only", "method=nsgs"]).succeeded();
    renew().refused(&["column", "another problem", "all of its methods"]);
    assert_eq!(seconds().len(), 6);
    let other = study.folder().path().join("results/runs/packed-quick");
    study.gravel(&["archive", "renew", text(&archived), text(&other)]).refused(&["packed-quick"]);
}
