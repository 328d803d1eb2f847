//! Tests of the table of other codes.

use results::schema::Ending;
use results::schema::{End, Provenance, Run, Sample};
use serde_json::json;

use super::parts;
use crate::tests::fixture::{decay, files, object, run, sample, study};

fn file<'f>(files: &'f [(String, String)], name: &str) -> &'f str {
    &files.iter().find(|(of, _)| of == name).unwrap().1
}

/// Another code at two tolerances; the second comes to a velocity error of 10⁻⁷.
fn other() -> (Run, Vec<Sample>) {
    let rung = |tolerance: f64, solve_s: f64| json!({ "tolerance": tolerance, "setup_s": 0.5, "solve_s": solve_s, "process_s": 9.0 });
    let derived = object(&json!({ "rungs": [rung(0.1, 1.0), rung(1e-5, 1.5)] }));
    let last = sample(7, 1e-7, 1e-7);
    let end = End { measures: last.measures, work: last.work };
    (
        Run {
            derived,
            end,
            provenance: Provenance {
                other_code: "piqp 1".to_owned(),
                ..run(0, "", "", Ending::Converged).provenance
            },
            ..run(0, "piqp", "", Ending::Converged)
        },
        vec![sample(0, 1.0, 1.0), sample(5, 0.1, 0.1), last],
    )
}

#[test]
fn no_run_makes_a_table_without_rows() {
    let files = files(&parts(&study(&[], &[])));
    assert_eq!(file(&files, "peers.csv").lines().count(), 1);
    assert_eq!(file(&files, "peers-ratios.csv").lines().count(), 1);
}

#[test]
fn seconds_of_another_code_are_those_of_the_tolerance_that_came_there_by_both_clocks() {
    let (other, curve) = other();
    let ours = Run { setup_s: 0.25, ..run(1, "cg", "", Ending::Converged) };
    let fast = vec![sample(0, 1.0, 1.0), Sample { iterating_s: 0.25, ..sample(1, 1e-7, 1e-7) }];
    let files = files(&parts(&study(&[other, ours], &[(0, curve), (1, fast)])));
    let csv = file(&files, "peers.csv");
    assert!(csv.contains("column,piqp,converged,1e-7,1e-7,2.0,4.0,9.0,0.00001"), "{csv}");
    assert!(
        csv.lines().any(|row| row.starts_with("column,cg,converged,") && row.ends_with(",0.5,1.0,,")),
        "{csv}"
    );
    let ratios: Vec<&str> = file(&files, "peers-ratios.csv").lines().skip(1).collect();
    assert_eq!(ratios, ["cg,1,1,0,1.0", "piqp,1,1,0,4.0"]);
    // It comes to 10⁻² at its second tolerance too; ours in 0.25 + 0.25 s.
    let codes: Vec<&str> = file(&files, "peers-codes.csv").lines().skip(1).collect();
    assert_eq!(codes[0], "piqp,0.01,1,1,1,4.0,4.0,4.0");
    assert_eq!(codes.len(), 3);
    let worth: Vec<&str> = file(&files, "peers-tolerances.csv").lines().skip(1).collect();
    assert_eq!(worth, ["piqp,0.1,1,0.1,0.1,0.1", "piqp,0.00001,1,1e-7,1e-7,1e-7"]);
    assert!(file(&files, "peers-problems.csv").contains("column,0.0001,piqp,piqp,2.0,cg,0.5,4.0"));
}

#[test]
fn accuracy_is_the_strictest_at_which_a_run_was_to_stop() {
    let ours = Run { tolerance: 1e-3, ..run(0, "cg", "", Ending::Converged) };
    let fast = vec![sample(0, 1.0, 1.0), Sample { iterating_s: 0.25, ..sample(1, 5e-3, 5e-3) }];
    let note = files(&parts(&study(&[ours], &[(0, fast)])));
    assert!(file(&note, "peers.md").contains("to a natural map of 10⁻²"), "{}", file(&note, "peers.md"));
    assert!(file(&note, "peers.csv").contains("column,cg,converged,"));
}

#[test]
fn run_that_does_not_come_there_has_no_seconds_and_a_failed_one_its_reason() {
    let reason = "at the tolerance 1e-2: no answer within 1 s".to_owned();
    let failed = Run { reason, ..run(1, "osqp", "", Ending::Failed) };
    let skipped = Run { reason: "highs is not installed".to_owned(), ..run(2, "highs", "", Ending::Skipped) };
    let ours = Run { tolerance: 1e-6, ..run(0, "nsgs", "", Ending::Converged) };
    let files = files(&parts(&study(&[ours, failed, skipped], &[(0, decay())])));
    let csv = file(&files, "peers.csv");
    for row in ["column,nsgs,converged,", "column,osqp,failed,", "column,highs,skipped,,"] {
        assert!(csv.lines().any(|line| line.starts_with(row) && line.ends_with(",,,,")), "{csv}");
    }
    let ratios: Vec<&str> = file(&files, "peers-ratios.csv").lines().skip(1).collect();
    assert!(ratios.contains(&"highs,0,0,1,") && ratios.contains(&"osqp,1,0,0,"), "{ratios:?}");
    let note = file(&files, "peers.md");
    assert!(note.contains("failed: osqp on column: at the tolerance 1e-2: no answer within 1 s"), "{note}");
}
