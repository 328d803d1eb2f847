use results::schema::Ending;
use results::schema::Run;

use super::*;
use crate::tests::assert_well_formed;
use crate::tests::fixture::{files, run, study};

#[test]
fn runs_of_both_studies_are_compared_and_others_are_counted() {
    let before = [
        run(0, "nsgs", "", Ending::Converged),
        run(1, "cg", "", Ending::Converged),
        run(2, "jacobi", "", Ending::IterationLimit),
        run(3, "gone", "", Ending::Converged),
    ];
    let after = [
        Run { iterations: 50, iterating_s: 0.006_15, setup_s: 5e-6, ..run(0, "nsgs", "", Ending::Converged) },
        run(1, "cg", "", Ending::Converged),
        run(2, "jacobi", "", Ending::Diverged),
    ];
    let files = files(&parts(&study(&before, &[]), &study(&after, &[])));
    let text = |name: &str| &files.iter().find(|(other, _)| other == name).unwrap().1;
    let said = "4\u{a0}runs before, 3\u{a0}runs after, 3 in both";
    assert!(text("against.svg").contains(said));
    assert!(
        text("against.csv").contains("column,nsgs,\"\",converged,converged,100,50,0.5,"),
        "{}",
        text("against.csv")
    );
    assert_well_formed("against.svg", text("against.svg"));
}

#[test]
fn studies_without_a_common_run_are_no_obstacle() {
    let some = study(&[run(0, "nsgs", "", Ending::Converged)], &[]);
    let none = study(&[], &[]);
    for (before, after) in [(&none, &some), (&some, &none), (&none, &none)] {
        assert!(files(&parts(before, after))[0].1.contains("0 in both"));
    }
}
