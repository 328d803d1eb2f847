use super::*;
use crate::error::RowError;
use crate::schema::{ContactRow, GrainRow, Provenance};
use crate::tests::{Store, record, run, stored};
use tempfile::TempDir;

fn study() -> Study {
    let grain = GrainRow {
        problem: "column".into(),
        partition: "1x1".into(),
        grain: 0,
        x_m: 0.1,
        z_m: 0.0,
        y_m: -0.2,
        radius_m: 0.05,
        subdomain: None,
        multiplicity: 0,
    };
    let contact = ContactRow {
        problem: "column".into(),
        partition: "1x1".into(),
        contact: 0,
        x0_m: 0.1,
        z0_m: 0.0,
        z1_m: 0.0,
        y0_m: -0.2,
        x1_m: 0.1,
        y1_m: -0.25,
        wall: true,
        subdomain: 0,
        impulse_n_s: f64::NAN,
    };
    let alone = Record { run: run(1), curve: Vec::new(), snapshots: Vec::new() };
    Study::Runs(Runs { records: vec![record(0), alone], grains: vec![grain], contacts: vec![contact] })
}

/// The runs of a study whose tables all have checksums.
fn runs((study, unsealed): (Study, Vec<PathBuf>)) -> Runs {
    assert!(unsealed.is_empty(), "{unsealed:?}");
    let Study::Runs(runs) = study else { panic!("no study of problems: {study:?}") };
    runs
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn second_writer_is_refused_and_told_who_the_first_is() {
    let root = TempDir::new().unwrap();
    let first = Store::open(root.path(), "paper").unwrap();
    let refused = Store::open(root.path(), "paper").unwrap_err().to_string();
    assert!(refused.contains(&format!("process {} since 2", std::process::id())), "{refused}");
    drop(first);
    stored(&root, 1);
    let _first = Store::open(root.path(), "paper").unwrap();
    assert!(matches!(Store::set_aside(root.path(), "paper"), Err(StoreError::InUse { .. })));
    assert!(Store::open(root.path(), "other").is_ok());
}

#[test]
fn what_is_set_aside_is_kept_in_a_folder_of_its_own() {
    let root = TempDir::new().unwrap();
    assert_eq!(Store::set_aside(root.path(), "paper").unwrap(), None);
    assert!(entries(root.path()).is_empty());
    let journal = stored(&root, 1);
    Store::open(root.path(), "paper").unwrap().write_tables(&study()).unwrap();
    let first = Store::set_aside(root.path(), "paper").unwrap().unwrap();
    assert_eq!(records_of::<Record>(&first, &["nsgs"]).unwrap().records.len(), 1);
    assert_eq!(runs(read(&first).unwrap()).records.len(), 2);
    assert_eq!(tables_folder(root.path(), "paper"), None);
    // Even what cannot be read.
    fs::write(&journal, "no run\n").unwrap();
    let second = Store::set_aside(root.path(), "paper").unwrap().unwrap();
    assert_eq!(fs::read_to_string(second.join(JOURNAL)).unwrap(), "no run\n");
    assert_ne!(first, second);
    assert!(Store::open(root.path(), "paper").unwrap().records().is_empty());
}

#[test]
fn tables_read_equal_the_tables_written_and_replace_those_before() {
    let root = TempDir::new().unwrap();
    let written = study();
    let mut store = Store::open(root.path(), "paper").unwrap();
    assert_eq!(tables_folder(root.path(), "paper"), None);
    store.write_tables(&Study::Runs(Runs::default())).unwrap();
    assert!(runs(read(store.folder()).unwrap()).records.is_empty());
    store.write_tables(&written).unwrap();
    let (read, _) = read(&tables_folder(root.path(), "paper").unwrap()).unwrap();
    assert_eq!(format!("{read:?}"), format!("{written:?}"));
    let files = [
        "contacts.parquet",
        "curves.csv",
        "curves.parquet",
        "grains.parquet",
        JOURNAL,
        LOCK,
        "runs.csv",
        "runs.parquet",
        "snapshots.parquet",
    ];
    assert_eq!(entries(store.folder()), files);
}

#[cfg(unix)]
#[test]
fn table_that_is_a_link_stays_one_and_its_target_is_written() {
    let root = TempDir::new().unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    let (link, target) = (store.folder().join("runs.csv"), root.path().join("elsewhere.csv"));
    // Seen from the folder of the link; first the target is not there, then it is.
    std::os::unix::fs::symlink("../elsewhere.csv", &link).unwrap();
    for _ in 0..2 {
        store.write_tables(&study()).unwrap();
        assert!(link.is_symlink() && fs::read_to_string(&target).unwrap().starts_with("run,id,"));
        fs::write(&target, "old").unwrap();
    }
    std::fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink("runs.csv", &link).unwrap();
    assert!(store.write_tables(&study()).unwrap_err().to_string().contains("links lead in a circle"));
}

#[test]
fn untraced_run_is_refused_and_leaves_nothing() {
    let root = TempDir::new().unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    let good = run(0);
    let untraced = [
        Run { problem_hash: String::new(), ..good.clone() },
        Run { provenance: Provenance { commit: " ".into(), ..good.provenance.clone() }, ..good.clone() },
        Run { provenance: Provenance { threads: 0, ..good.provenance.clone() }, ..good.clone() },
    ];
    for run in untraced {
        let refused = store.append(Record { run, curve: Vec::new(), snapshots: Vec::new() });
        assert!(matches!(refused, Err(StoreError::Entry(RowError::Untraced(_)))), "{refused:?}");
    }
    assert_eq!(fs::read(store.folder().join(JOURNAL)).unwrap(), b"");
}

#[test]
fn place_that_cannot_hold_a_folder_or_a_journal_is_refused_by_name_before_any_run() {
    let root = TempDir::new().unwrap();
    // A file in the place of a folder refuses every user; a read-only folder would not refuse the superuser.
    fs::write(root.path().join("paper"), "").unwrap();
    let error = Store::open(root.path(), "paper").unwrap_err();
    assert!(matches!(&error, StoreError::File { path, .. } if path.ends_with("paper")), "{error}");
    fs::create_dir_all(root.path().join("other").join(JOURNAL)).unwrap();
    let error = Store::open(root.path(), "other").unwrap_err();
    assert!(matches!(&error, StoreError::File { path, .. } if path.ends_with(JOURNAL)), "{error}");
}

#[test]
fn file_that_is_no_table_is_named() {
    let root = TempDir::new().unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    store.write_tables(&study()).unwrap();
    fs::write(parquet(store.folder(), GRAINS), "not a table").unwrap();
    assert!(read(store.folder()).unwrap_err().to_string().contains("grains.parquet"));
}

#[test]
fn plan_that_names_no_folder_is_refused() {
    let root = TempDir::new().unwrap();
    for plan in ["", "..", "a/b"] {
        assert!(matches!(Store::open(root.path(), plan), Err(StoreError::Plan(_))), "{plan}");
    }
}

#[test]
fn study_from_before_there_were_snapshots_has_none() {
    let root = TempDir::new().unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    store.write_tables(&study()).unwrap();
    fs::remove_file(parquet(store.folder(), SNAPSHOTS)).unwrap();
    assert!(runs(read(store.folder()).unwrap()).records.iter().all(|record| record.snapshots.is_empty()));
}

/// The tables without checksums, as they were written once.
fn without_checksums(folder: &Path) {
    for Named { name, mut table, .. } in study().tables().unwrap() {
        let mut bytes = Vec::new();
        polars::prelude::ParquetWriter::new(&mut bytes).finish(&mut table).unwrap();
        fs::write(parquet(folder, name), bytes).unwrap();
    }
}

#[test]
fn no_flipped_bit_of_a_table_is_taken_for_what_was_written() {
    let root = TempDir::new().unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    store.write_tables(&study()).unwrap();
    let written = format!("{:?}", read(store.folder()).unwrap());
    for name in [RUNS, CURVES, GRAINS, CONTACTS, SNAPSHOTS] {
        let path = parquet(store.folder(), name);
        let bytes = fs::read(&path).unwrap();
        // Of each byte another bit, and all of the last bytes: the metadata with the checksum.
        let last = 8 * (bytes.len() - 120);
        for bit in (0..last).step_by(131).chain((last..8 * bytes.len()).step_by(3)) {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            fs::write(&path, &flipped).unwrap();
            let error = read(store.folder()).map(drop).unwrap_err().to_string();
            assert!(error.contains(name) && error.contains("damaged"), "{name}, bit {bit}: {error}");
        }
        fs::write(&path, bytes).unwrap();
    }
    assert_eq!(format!("{:?}", read(store.folder()).unwrap()), written);
}

#[test]
fn tables_from_before_there_were_checksums_are_read_and_named() {
    let root = TempDir::new().unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    without_checksums(store.folder());
    let (old, unsealed) = read(store.folder()).unwrap();
    assert_eq!(unsealed.len(), 5, "{unsealed:?}");
    assert_eq!(format!("{old:?}"), format!("{:?}", study()));
    // The program was stopped after the first new one.
    let before = fs::read(parquet(store.folder(), CURVES)).unwrap();
    store.write_tables(&study()).unwrap();
    fs::write(parquet(store.folder(), CURVES), before).unwrap();
    assert!(
        matches!(read(store.folder()), Err(StoreError::Apart { path, .. }) if path.ends_with("curves.parquet"))
    );
}

#[test]
fn tables_of_two_times_are_not_read_as_one_study() {
    let root = TempDir::new().unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    store
        .write_tables(&Study::Runs(Runs { records: vec![record(3), record(0)], ..Runs::default() }))
        .unwrap();
    let before = fs::read(parquet(store.folder(), CURVES)).unwrap();
    store.write_tables(&study()).unwrap();
    fs::write(parquet(store.folder(), CURVES), before).unwrap();
    let error = read(store.folder()).map(drop).unwrap_err().to_string();
    assert!(
        error.contains("curves.parquet is not of the same time as") && error.contains("runs.parquet"),
        "{error}"
    );
}

#[test]
fn what_a_program_that_was_killed_did_not_finish_is_removed_by_the_next() {
    let root = TempDir::new().unwrap();
    let folder = Store::open(root.path(), "paper").unwrap().folder().to_owned();
    for name in [".unfinished-aB3xYz", ".unfinished-000000", "notes.txt"] {
        fs::write(folder.join(name), "half").unwrap();
    }
    let _store = Store::open(root.path(), "paper").unwrap();
    assert_eq!(entries(&folder), [JOURNAL, LOCK, "notes.txt"]);
}
