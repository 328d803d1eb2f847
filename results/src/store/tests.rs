use super::*;
use crate::schema::{ContactRow, GrainRow, Provenance};
use crate::tests::{run, sample};
use contact::Measures;
use tempfile::TempDir;

type Store = super::Store<Record>;

fn record(number: u32) -> Record {
    // What JSON has no number for, and numbers that are hard to write.
    let odd = Measures {
        zeta: f64::NAN,
        natural_map: f64::INFINITY,
        energy: f64::NEG_INFINITY,
        ..sample(1).measures
    };
    let fine = Measures { zeta: 0.1 + 0.2, quad_dv: 5e-324, max_dv: f64::MAX, ..sample(2).measures };
    let curve = [(1, odd), (2, fine)].map(|(n, measures)| Sample { measures, ..sample(n) }).to_vec();
    let seen = Snapshot { iteration: 2, natural_map: f64::NAN, impulses_n_s: vec![0.1, f64::NAN] };
    Record { run: run(number), curve, snapshots: vec![seen] }
}

/// NaN is what it is, here.
fn same(a: &[Record], b: &[Record]) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

fn study() -> Study {
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
    let alone = Record { run: run(1), curve: Vec::new(), snapshots: Vec::new() };
    Study::Runs(Runs { records: vec![record(0), alone], grains: vec![grain], contacts: vec![contact] })
}

fn runs(study: Study) -> Runs {
    let Study::Runs(runs) = study else { panic!("no study of problems: {study:?}") };
    runs
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A store of `runs` runs that is closed again, and the path of its journal.
fn stored(root: &TempDir, runs: u32) -> PathBuf {
    let mut store = Store::open(root.path(), "paper").unwrap();
    for number in 0..runs {
        store.append(record(number)).unwrap();
    }
    root.path().join("paper").join(JOURNAL)
}

#[test]
fn runs_read_equal_the_runs_appended_to_the_last_bit() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let all: Vec<Record> = (0..3).map(record).collect();
    assert!(same(&records_of(&root.path().join("paper"), &["nsgs"]).unwrap(), &all[..2]));
    let mut store = Store::open(root.path(), "paper").unwrap();
    store.append(record(2)).unwrap();
    assert!(same(store.records(), &all));
    assert_eq!(store.dropped(), 0);
    assert_eq!(fs::read_to_string(journal).unwrap().lines().count(), 3);
    assert!(records_of::<Record>(&root.path().join("absent"), &[]).unwrap().is_empty());
}

#[test]
fn every_number_of_a_record_may_be_undefined() {
    fn undefine(value: &mut serde_json::Value) {
        match value {
            serde_json::Value::Object(fields) => fields.values_mut().for_each(undefine),
            serde_json::Value::Array(items) => items.iter_mut().for_each(undefine),
            number if number.is_f64() => *number = serde_json::Value::Null,
            _ => {}
        }
    }
    let mut json = serde_json::to_value(record(0)).unwrap();
    undefine(&mut json);
    let read: Record = serde_json::from_value(json).unwrap();
    assert!(read.run.setup_s.is_nan() && read.run.timing.wall_s.is_nan());
    assert!(read.curve[1].measures.zeta.is_nan() && read.curve[1].measures.velocity_error.is_nan());
}

#[test]
fn line_torn_at_any_byte_is_dropped_and_the_next_run_stands_behind_the_whole_ones() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let bytes = fs::read(&journal).unwrap();
    let first = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    for length in (first..bytes.len()).step_by(97).chain([bytes.len() - 1]) {
        fs::write(&journal, &bytes[..length]).unwrap();
        let mut store = Store::open(root.path(), "paper").unwrap();
        assert_eq!(store.dropped(), (length - first) as u64);
        assert!(same(store.records(), &[record(0)]));
        store.append(record(1)).unwrap();
        drop(store);
        assert!(fs::read(&journal).unwrap() == bytes, "{length}");
    }
}

#[test]
fn line_that_is_whole_and_no_run_is_refused_by_its_number_and_left_alone() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 3);
    let text = fs::read_to_string(&journal).unwrap();
    let second = text.lines().nth(1).unwrap();
    for wrong in ["{}", "", "\u{0}\u{0}", &second.replacen("\"id\"", "\"ID\"", 1)] {
        let wrong = text.replacen(second, wrong, 1);
        fs::write(&journal, &wrong).unwrap();
        let error = Store::open(root.path(), "paper").unwrap_err();
        assert!(matches!(&error, StoreError::Line { line: 2, .. }), "{error}");
        assert!(error.to_string().contains("journal.jsonl, line 2"), "{error}");
        assert_eq!(fs::read_to_string(&journal).unwrap(), wrong);
    }
}

/// A line as it was before there were checksums.
fn old(line: &str) -> String {
    let (row, seal) = line.rsplit_once(",\"crc32\":").unwrap();
    assert_eq!(seal.len(), "\"01234567\"}".len());
    format!("{row}}}")
}

#[test]
fn line_is_json_whose_last_key_is_the_checksum_of_what_is_before() {
    let root = TempDir::new().unwrap();
    let text = fs::read_to_string(stored(&root, 1)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let (row, _) = text.rsplit_once(",\"crc32\"").unwrap();
    assert_eq!(json["crc32"], format!("{:08x}", crc32fast::hash(row.as_bytes())));
    // The check value of CRC-32, as its catalogue gives it.
    assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
}

#[test]
fn no_flipped_bit_of_a_journal_is_taken_for_what_was_written() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let bytes = fs::read(&journal).unwrap();
    let first = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    // Every bit of the checksum and of the end of the first line, and one bit here and there of both.
    let seal = (first - 24) * 8..first * 8;
    for bit in seal.chain((0..bytes.len() * 8).step_by(41)) {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        fs::write(&journal, &flipped).unwrap();
        match read_journal::<Record>(&journal) {
            Err(StoreError::Line { line, .. }) => {
                let of_bit = usize::from(bit / 8 >= first) + 1;
                assert_eq!(line, of_bit, "bit {bit}");
            }
            // The last line has no end then: it is dropped, which is told.
            Ok(lines) => {
                assert_eq!(bit / 8, bytes.len() - 1, "bit {bit}");
                assert!(lines.torn > 0 && same(&lines.records, &[record(0)]), "bit {bit}");
            }
            Err(error) => panic!("bit {bit}: {error}"),
        }
    }
}

#[test]
fn journal_from_before_there_were_checksums_is_read_and_goes_on_with_them() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let text = fs::read_to_string(&journal).unwrap();
    let before: String = text.lines().map(|line| old(line) + "\n").collect();
    fs::write(&journal, &before).unwrap();
    let mut store = Store::open(root.path(), "paper").unwrap();
    assert!(same(store.records(), &[record(0), record(1)]));
    store.append(record(2)).unwrap();
    drop(store);
    let grown = fs::read_to_string(&journal).unwrap();
    assert!(grown.starts_with(&before) && grown.lines().last().unwrap().contains("\"crc32\""));
    assert_eq!(records_of::<Record>(journal.parent().unwrap(), &["nsgs"]).unwrap().len(), 3);
}

#[test]
fn status_and_method_that_are_none_are_refused_by_line_and_value() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let text = fs::read_to_string(&journal).unwrap();
    let second = text.lines().nth(1).unwrap();
    let refused = |name: &str, wrong: &str, expected: &str| {
        let line = old(second).replacen(name, wrong, 1);
        fs::write(&journal, text.replacen(second, &line, 1)).unwrap();
        let error = records_of::<Record>(journal.parent().unwrap(), &["nsgs"]).unwrap_err().to_string();
        assert!(error.contains("journal.jsonl, line 2: ") && error.contains(expected), "{error}");
    };
    refused(
        "converged",
        "convergud",
        "`status` is \"convergud\": it must be one of converged, iteration-limit",
    );
    refused("nsgs", "nsgr", "`method` is \"nsgr\": it must be one of nsgs");
    // One that was known when the line was written may be gone since.
    fs::write(&journal, &text).unwrap();
    assert_eq!(records_of::<Record>(journal.parent().unwrap(), &["cg"]).unwrap().len(), 2);
    let wrong = Run { status: "Converged".into(), ..run(3) };
    let mut store = Store::open(root.path(), "paper").unwrap();
    let refused = store.append(Record { run: wrong, curve: Vec::new(), snapshots: Vec::new() });
    assert!(matches!(refused, Err(StoreError::Entry(RowError::Name { key: "status", .. }))), "{refused:?}");
}

#[test]
fn difference_of_two_runs_of_one_id_is_their_first_unlike_count() {
    let (ours, mut theirs) = (record(0), record(0));
    theirs.run.iterating_s = 1.0;
    theirs.run.provenance.processor = "another".into();
    assert_eq!(ours.difference(&theirs), None);
    theirs.run.end.work.delassus_products = 3;
    let expected = ("delassus_products".to_owned(), "0".to_owned(), "3".to_owned());
    assert_eq!(ours.difference(&theirs), Some(expected));
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
    assert_eq!(records_of::<Record>(&first, &["nsgs"]).unwrap().len(), 1);
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
    let read = read(&tables_folder(root.path(), "paper").unwrap()).unwrap();
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
