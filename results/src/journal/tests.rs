//! Tests of the lines that a journal takes, keeps and refuses.

use super::*;
use crate::store::records_of;
use crate::tests::{Store, record, stored};
use std::fs;
use tempfile::TempDir;

/// NaN is what it is, here.
fn same(a: &[Record], b: &[Record]) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

#[test]
fn runs_read_equal_the_runs_appended_to_the_last_bit() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let all: Vec<Record> = (0..3).map(record).collect();
    assert!(same(&records_of(&root.path().join("paper"), &["nsgs"]).unwrap().records, &all[..2]));
    let mut store = Store::open(root.path(), "paper").unwrap();
    store.append(record(2)).unwrap();
    assert!(same(store.records(), &all));
    assert_eq!(store.lines().torn, 0);
    assert_eq!(fs::read_to_string(journal).unwrap().lines().count(), 3);
    assert!(records_of::<Record>(&root.path().join("absent"), &[]).unwrap().records.is_empty());
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
        assert_eq!(store.lines().torn, (length - first) as u64);
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
fn line_that_lost_its_checksum_is_refused_behind_one_that_has_its_own() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 3);
    let text = fs::read_to_string(&journal).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    for lost in [1, 2] {
        fs::write(&journal, text.replacen(lines[lost], &old(lines[lost]), 1)).unwrap();
        let error = Store::open(root.path(), "paper").unwrap_err();
        assert!(
            matches!(&error, StoreError::Line { line, source: RowError::Unsealed, .. } if *line == lost + 1),
            "{error}"
        );
    }
    // The first ones may be from before there were any, which is counted.
    fs::write(&journal, text.replacen(lines[0], &old(lines[0]), 1)).unwrap();
    assert_eq!(Store::open(root.path(), "paper").unwrap().lines().unsealed, 1);
}

#[test]
fn journal_with_the_ends_of_lines_of_windows_is_read_and_goes_on() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let text = fs::read_to_string(&journal).unwrap();
    for before in [text.clone(), text.lines().map(|line| old(line) + "\n").collect()] {
        fs::write(&journal, before.replace('\n', "\r\n")).unwrap();
        let mut store = Store::open(root.path(), "paper").unwrap();
        assert!(same(store.records(), &[record(0), record(1)]) && store.lines().torn == 0);
        store.append(record(2)).unwrap();
        drop(store);
        assert_eq!(read::<Record>(&journal).unwrap().records.len(), 3);
    }
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
        match read::<Record>(&journal) {
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
    assert_eq!(store.lines().unsealed, 2);
    store.append(record(2)).unwrap();
    drop(store);
    let grown = fs::read_to_string(&journal).unwrap();
    assert!(grown.starts_with(&before) && grown.lines().last().unwrap().contains("\"crc32\""));
    assert_eq!(records_of::<Record>(journal.parent().unwrap(), &["nsgs"]).unwrap().records.len(), 3);
}

#[test]
fn status_and_method_that_are_none_are_refused_by_line_and_value() {
    let root = TempDir::new().unwrap();
    let journal = stored(&root, 2);
    let text = fs::read_to_string(&journal).unwrap();
    let second = text.lines().nth(1).unwrap();
    let refused = |name: &str, wrong: &str, expected: &str| {
        let line = old(second).replacen(name, wrong, 1);
        let first = old(text.lines().next().unwrap());
        fs::write(&journal, format!("{first}\n{line}\n")).unwrap();
        let error = records_of::<Record>(journal.parent().unwrap(), &["nsgs"]).unwrap_err().to_string();
        assert!(error.contains("journal.jsonl, line 2: ") && error.contains(expected), "{error}");
    };
    refused(
        "converged",
        "convergud",
        "`status` is \"convergud\": it must be one of converged, iteration-limit",
    );
    refused(
        "natural_map\",\"tol",
        "natural\",\"tol",
        "`stop_on` is \"natural\": it must be one of zeta, natural_map",
    );
    refused("nsgs", "nsgr", "`method` is \"nsgr\": it must be one of nsgs");
    // One that was known when the line was written may be gone since.
    fs::write(&journal, &text).unwrap();
    assert_eq!(records_of::<Record>(journal.parent().unwrap(), &["cg"]).unwrap().records.len(), 2);
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
