use results::schema::Run;

use super::*;
use crate::tests::fixture::{end, run, sample, tables, whole};

fn answered(runs: &[Run]) -> Vec<String> {
    answer(&whole(&tables(runs, &[])))
}

#[test]
fn sentence_says_how_the_runs_ended() {
    let mut runs = vec![
        Run { iterations: 40, iterating_s: 0.5, ..run(0, "cg", "", Ending::Converged) },
        Run { iterations: 900, iterating_s: 0.2, ..run(1, "nsgs", "", Ending::Converged) },
        Run { iterations: 7, ..run(2, "jacobi", "", Ending::Diverged) },
    ];
    let expected = "3\u{a0}runs of 3\u{a0}methods on 1\u{a0}problem: 2 converged, 1 diverged.";
    assert_eq!(answered(&runs)[0], expected);
    runs.clear();
    assert_eq!(answered(&runs), ["0\u{a0}runs of 0\u{a0}methods on 0\u{a0}problems."]);
}

#[test]
fn proof_that_there_is_no_solution_is_no_failure_unless_a_run_finds_one() {
    let on = |i, method: &str, status: Ending| {
        let unknown = end(sample(9, 1.0, f64::NAN));
        Run { problem: "wedge".into(), end: unknown, ..run(i, method, "", status) }
    };
    let mut runs = vec![on(0, "cg", Ending::Infeasible), on(1, "nsgs", Ending::IterationLimit)];
    let right = |methods: &str| {
        format!("Converged, or proved that there is no solution, in all of their runs: {methods}.")
    };
    let proof = "2\u{a0}runs of 2\u{a0}methods on 1\u{a0}problem: 1 iteration limit, 1 proved that there is no solution.";
    assert_eq!(answered(&runs), [proof.to_owned(), right("cg (1)")]);
    runs[1].status = Ending::Converged;
    let claim = "2\u{a0}runs of 2\u{a0}methods on 1\u{a0}problem: 1 converged, 1 claimed wrongly that there is no solution.";
    assert_eq!(answered(&runs), [claim.to_owned(), right("nsgs (1)")]);
    // The reference is certified: the velocity error is known.
    runs[1].status = Ending::IterationLimit;
    runs[0].end = end(sample(9, 1.0, 0.5));
    assert!(answered(&runs)[1].starts_with("No method converged"), "{:?}", answered(&runs));
}

#[test]
fn methods_that_are_right_in_all_runs_are_named() {
    let mut runs = vec![run(0, "cg", "", Ending::Converged), run(1, "nsgs", "", Ending::Converged)];
    runs.push(run(2, "nsgs", "slow", Ending::IterationLimit));
    runs.push(Run { problem: "b".into(), ..run(3, "cg", "", Ending::Skipped) });
    runs.push(run(4, "convex", "", Ending::Skipped));
    let right = "Converged, or proved that there is no solution, in all of their runs: cg (1; 1 skipped).";
    assert_eq!(answered(&runs)[1], right);
    runs[0].status = Ending::Diverged;
    assert!(answered(&runs)[1].starts_with("No method converged"), "{:?}", answered(&runs));
}
