//! Rows as tables and back; and rows for the other tests of this crate.

use crate::columns::{keyed, keys, rows, table};
use crate::error::RowError;
use crate::journal::Record;
use crate::schema::{ContactRow, End, Ending, GrainRow, Provenance, Run, Sample, Snapshot, Timing};
use crate::simulation::{Observed, Simulation};
use contact::{Measures, Work};
use jiff::Timestamp;
use polars::prelude::{Column, DataFrame};
use serde_json::json;
use std::path::PathBuf;
use tempfile::TempDir;

pub(crate) fn sample(iteration: u64) -> Sample {
    let measures = Measures {
        zeta: 0.5,
        natural_map: 0.1,
        penetration_rate: 0.01,
        quad_dv: 0.02,
        max_dv: 0.03,
        velocity_error: 0.04,
        energy_gap: 0.002,
        velocity_jump: 0.0,
        energy: -1.0,
        ..Measures::default()
    };
    let work = Work { contact_updates: 10 * iteration, ..Work::default() };
    Sample { iteration, iterating_s: 1e-4 * iteration as f64, measures, work }
}

pub(crate) fn run(number: u32) -> Run {
    let Sample { measures, work, .. } = sample(7);
    Run {
        id: format!("{number:016x}"),
        plan: "paper".into(),
        problem: "column".into(),
        problem_hash: "c0ffee".into(),
        grains: 10,
        contacts: 10,
        method: "nsgs".into(),
        settings: json!({ "sweeps": 1 }).as_object().unwrap().clone(),
        subdomains: 1,
        tolerance: 1e-4,
        max_iterations: 1000,
        status: Ending::Converged,
        iterations: 7,
        setup_s: 1e-5,
        iterating_s: 7e-4,
        iterations_to_zeta_1e_3: Some(5),
        iterations_to_natural_map_1e_2: Some(3),
        iterations_to_natural_map_1e_4: Some(7),
        iterations_to_velocity_error_1e_2: Some(4),
        timing: Timing {
            repeats: 1,
            timed_alone: true,
            wall_s: 2e-3,
            load_average: 0.5,
            ..Timing::default()
        },
        end: End { measures, work },
        provenance: Provenance {
            commit: "0123abc".into(),
            processor: "a processor".into(),
            processors: 8,
            threads: 1,
            rustc: "1.95.0".into(),
            profile: "release".into(),
            started_utc: "2026-01-02T03:04:05Z".into(),
            other_code: String::new(),
        },
        ..Run::default()
    }
}

pub(crate) type Store = crate::store::Store<Record>;

pub(crate) fn record(number: u32) -> Record {
    // What JSON has no number for, and numbers that are hard to write.
    let odd = Measures {
        zeta: f64::NAN,
        natural_map: f64::INFINITY,
        energy: f64::NEG_INFINITY,
        ..sample(1).measures
    };
    let fine = Measures { zeta: 0.1 + 0.2, quad_dv: 5e-324, max_dv: f64::MAX, ..sample(2).measures };
    let curve = [(1, odd), (2, fine)].map(|(n, measures)| Sample { measures, ..sample(n) }).to_vec();
    let seen = Snapshot {
        iteration: 2,
        natural_map: f64::NAN,
        impulses_n_s: vec![0.1, f64::NAN],
        sliding: vec![1],
        spins_rad_per_s: vec![-0.5],
    };
    Record { run: run(number), curve, snapshots: vec![seen] }
}

/// A store of `runs` runs that is closed again, and the path of its journal.
pub(crate) fn stored(root: &TempDir, runs: u32) -> PathBuf {
    let mut store = Store::open(root.path(), "paper").unwrap();
    for number in 0..runs {
        store.append(record(number)).unwrap();
    }
    root.path().join("paper").join("journal.jsonl")
}

fn columns(table: &DataFrame) -> Vec<String> {
    table.get_column_names().iter().map(ToString::to_string).collect()
}

#[test]
fn no_rows_give_tables_with_all_their_columns() {
    let none = table::<Run>([]).unwrap();
    assert_eq!((none.height(), none.schema()), (0, table([&run(0)]).unwrap().schema()));
    let none = keyed::<Sample>("run", []).unwrap();
    assert_eq!((none.height(), none.schema()), (0, keyed("run", [(0, &sample(1))]).unwrap().schema()));
    assert_eq!(table::<GrainRow>([]).unwrap().shape(), (0, 9));
    assert_eq!(table::<ContactRow>([]).unwrap().shape(), (0, 12));
    assert_eq!(
        columns(&keyed::<Snapshot>("run", []).unwrap()),
        ["run", "iteration", "natural_map", "impulses_n_s", "sliding", "spins_rad_per_s"]
    );
    assert_eq!(columns(&table::<Simulation>([]).unwrap())[..2], ["id", "plan"]);
    assert_eq!(keyed::<Observed>("simulation", []).unwrap().shape(), (0, 31));
    assert!(rows::<Sample>(&none).unwrap().is_empty());
}

#[test]
fn columns_stand_in_the_order_of_the_fields_parts_of_a_row_in_their_place() {
    let names = columns(&table([&run(0)]).unwrap());
    assert_eq!(names[..3], ["id", "plan", "problem"]);
    let place = |name: &str| names.iter().position(|other| other == name).unwrap();
    assert!(place("iterating_s") < place("repeats") && place("load_average") < place("zeta"));
    assert!(place("energy_j") < place("contact_updates") && place("factorisations") < place("commit"));
    assert_eq!(names.last().unwrap(), "other_code");
}

#[test]
fn rows_read_equal_the_rows_written() {
    let mut odd = run(1);
    odd.end.measures =
        Measures { zeta: f64::NAN, natural_map: f64::INFINITY, quad_dv: 5e-324, ..odd.end.measures };
    let all = [run(0), odd];
    let read: Vec<Run> = rows(&table(&all).unwrap()).unwrap();
    assert_eq!(format!("{read:?}"), format!("{all:?}"));
    let seen = Snapshot {
        iteration: 2,
        natural_map: f64::NAN,
        impulses_n_s: vec![0.1, f64::NAN],
        sliding: vec![1],
        spins_rad_per_s: vec![-0.5],
    };
    let stored = keyed("run", [(5, &seen), (6, &seen)]).unwrap();
    assert_eq!(keys("run", &stored).unwrap(), [5, 6]);
    let read: Vec<Snapshot> = rows(&stored).unwrap();
    assert_eq!(format!("{read:?}"), format!("{:?}", [&seen, &seen]));
}

#[test]
fn undefined_measure_is_null_and_infinite_one_is_kept() {
    let measures = Measures { zeta: f64::NAN, natural_map: f64::INFINITY, ..sample(1).measures };
    let table = table([&Sample { measures, ..sample(1) }]).unwrap();
    assert_eq!(table.column("zeta").unwrap().f64().unwrap().get(0), None);
    assert_eq!(table.column("natural_map").unwrap().f64().unwrap().get(0), Some(f64::INFINITY));
}

#[test]
fn older_table_lacks_columns_that_have_a_default_and_no_other() {
    let stored = table([&run(0)]).unwrap();
    let older = stored.drop_many(["velocity_error", "spectrum"]);
    let read: Vec<Run> = rows(&older).unwrap();
    assert!(read[0].end.measures.velocity_error.is_nan() && read[0].spectrum.is_empty());
    let error = rows::<Run>(&stored.drop_many(["method"])).unwrap_err().to_string();
    assert!(error.contains("row 0") && error.contains("missing field `method`"), "{error}");
}

#[test]
fn empty_commit_compiler_or_no_thread_is_refused() {
    let gather = |commit, rustc, threads| Provenance::gather(commit, rustc, "release", threads);
    assert!(matches!(gather(" ", "1.95.0", 1), Err(RowError::Untraced("commit"))));
    assert!(matches!(gather("0123abc", "", 1), Err(RowError::Untraced("rustc"))));
    assert!(matches!(gather("0123abc", "1.95.0", 0), Err(RowError::Untraced("threads"))));
}

#[test]
fn empty_processor_is_refused() {
    let provenance = Provenance { processor: String::new(), ..run(0).provenance };
    assert!(matches!(provenance.check(), Err(RowError::Untraced("processor"))));
}

#[test]
fn time_is_an_rfc_3339_instant() {
    let provenance = Provenance::gather("0123abc", "1.95.0", "release", 2).unwrap();
    assert!(provenance.started_utc.parse::<Timestamp>().is_ok());
}

#[test]
fn unknown_name_in_a_table_is_an_error_that_names_row_column_and_value() {
    let mut stored = table(&[run(0), run(1)]).unwrap();
    stored.with_column(Column::new("status".into(), ["converged", "convergud"])).unwrap();
    let error = rows::<Run>(&stored).unwrap_err().to_string();
    assert!(
        error.contains("row 1: ") && error.contains("`status` is \"convergud\": it must be one of"),
        "{error}"
    );
}
