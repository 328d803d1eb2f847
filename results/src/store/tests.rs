use super::*;
use crate::schema::fixture::{run, sample};
use crate::schema::{ContactRow, GrainRow, Run, Sample};
use crate::tables::{contacts_table, curves_table, grains_table, runs_table};

const TIME: &str = "2026-01-02T03:04:05.678Z";

fn tables() -> Tables {
    let grain = GrainRow {
        problem: "column".into(),
        partition: "1x1".into(),
        grain: 0,
        x_m: 0.1,
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
        y0_m: -0.2,
        x1_m: 0.1,
        y1_m: -0.25,
        wall: true,
        subdomain: 0,
        impulse_n_s: f64::NAN,
    };
    let curve = vec![Sample { zeta: f64::NAN, ..sample(1) }, sample(2)];
    Tables {
        runs: runs_table(&[run(0), run(1)]).unwrap(),
        curves: curves_table(&[(0, curve)]).unwrap(),
        grains: grains_table(&[grain]).unwrap(),
        contacts: contacts_table(&[contact]).unwrap(),
    }
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn tables_read_equal_the_tables_written() {
    let root = TempDir::new().unwrap();
    let written = tables();
    let folder = Store::create(root.path(), "paper", TIME).unwrap().write(&written).unwrap();
    let read = read(&folder).unwrap();
    assert!(read.runs.equals_missing(&written.runs));
    assert!(read.curves.equals_missing(&written.curves));
    assert!(read.grains.equals_missing(&written.grains));
    assert!(read.contacts.equals_missing(&written.contacts));
    assert_eq!(entries(&folder), [CONTACTS, CURVES_CSV, CURVES, GRAINS, RUNS_CSV, RUNS]);
}

#[test]
fn study_is_invisible_until_written_and_never_replaces_another() {
    let root = TempDir::new().unwrap();
    let write = || Store::create(root.path(), "paper", TIME).unwrap().write(&tables()).unwrap();
    let store = Store::create(root.path(), "paper", TIME).unwrap();
    assert_eq!(latest(root.path(), "paper"), None);
    drop(store);
    assert!(entries(&root.path().join("paper")).is_empty());
    let folders: Vec<PathBuf> = (0..11).map(|_| write()).collect();
    assert!(folders[0].ends_with("paper/2026-01-02T03-04-05Z"));
    assert!(folders[1].ends_with("paper/2026-01-02T03-04-05Z-2"));
    assert_eq!(latest(root.path(), "paper").as_ref(), folders.last());
    assert_eq!(entries(&root.path().join("paper")).len(), 11);
}

#[test]
fn untraced_run_is_refused_and_leaves_nothing() {
    let root = TempDir::new().unwrap();
    let mut tables = tables();
    tables.runs = runs_table(&[run(0), Run { problem_hash: String::new(), ..run(1) }]).unwrap();
    let refused = Store::create(root.path(), "paper", TIME).unwrap().write(&tables);
    assert!(matches!(refused, Err(StoreError::Untraced { row: 1, column: "problem_hash" })));
    assert!(entries(&root.path().join("paper")).is_empty());
}

#[test]
fn place_that_cannot_hold_a_folder_is_refused_by_name_before_any_run() {
    let root = TempDir::new().unwrap();
    // A file in the place of the folder refuses every user; a read-only folder would not refuse the superuser.
    fs::write(root.path().join("paper"), "").unwrap();
    let error = Store::create(root.path(), "paper", TIME).unwrap_err();
    assert!(matches!(&error, StoreError::File { path, .. } if path.ends_with("paper")), "{error}");
}

#[test]
fn folder_that_vanishes_during_the_study_leaves_nothing_half_written() {
    let root = TempDir::new().unwrap();
    let store = Store::create(root.path(), "paper", TIME).unwrap();
    fs::remove_dir_all(root.path().join("paper")).unwrap();
    assert!(matches!(store.write(&tables()), Err(StoreError::File { .. })));
    assert!(entries(root.path()).is_empty());
}

#[test]
fn file_that_is_no_table_is_named() {
    let root = TempDir::new().unwrap();
    let folder = Store::create(root.path(), "paper", TIME).unwrap().write(&tables()).unwrap();
    fs::write(folder.join(GRAINS), "not a table").unwrap();
    assert!(read(&folder).unwrap_err().to_string().contains(GRAINS));
}

#[test]
fn plan_or_time_that_names_no_folder_is_refused() {
    let root = TempDir::new().unwrap();
    for plan in ["", "..", "a/b"] {
        assert!(matches!(Store::create(root.path(), plan, TIME), Err(StoreError::Plan(_))), "{plan}");
    }
    assert!(matches!(Store::create(root.path(), "paper", "today"), Err(StoreError::Time { .. })));
}
