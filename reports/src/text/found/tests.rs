use results::schema::Run;
use serde_json::json;

use super::*;
use crate::tests::fixture::{end, object, run, sample, tables, whole};

fn told(runs: &[Run]) -> Vec<String> {
    let [_, told] = found(&whole(&tables(runs, &[])), false);
    told
}

fn answered(runs: &[Run]) -> Vec<String> {
    let [answer, _] = found(&whole(&tables(runs, &[])), true);
    answer
}

fn study() -> Vec<Run> {
    vec![
        Run { iterations: 40, iterating_s: 0.5, ..run(0, "cg", "", Ending::Converged) },
        Run { iterations: 900, iterating_s: 0.2, ..run(1, "nsgs", "", Ending::Converged) },
        Run { iterations: 7, ..run(2, "jacobi", "", Ending::Diverged) },
    ]
}

#[test]
fn sentences_say_what_the_rows_say() {
    let expected = [
        "3\u{a0}runs of 3\u{a0}methods on 1\u{a0}problem: 2 converged, 1 diverged.",
        "jacobi: 1 of 1\u{a0}run failed (1 diverged).",
    ];
    assert_eq!(told(&study()), expected);
}

#[test]
fn proof_that_there_is_no_solution_is_no_failure_unless_a_run_finds_one() {
    let on = |i, method: &str, status: Ending| {
        let unknown = end(sample(9, 1.0, f64::NAN));
        Run { problem: "wedge".into(), end: unknown, ..run(i, method, "", status) }
    };
    let mut runs = vec![on(0, "cg", Ending::Infeasible), on(1, "nsgs", Ending::IterationLimit)];
    let expected = [
        "2\u{a0}runs of 2\u{a0}methods on 1\u{a0}problem: 1 iteration limit, 1 proved that there is no solution.",
        "nsgs: 1 of 1\u{a0}run failed (1 iteration limit).",
    ];
    assert_eq!(told(&runs), expected);
    runs[1].status = Ending::Converged;
    assert_eq!(told(&runs)[1], "cg: 1 of 1\u{a0}run failed (1 claimed wrongly that there is no solution).");
    // The reference is certified: the velocity error is known.
    runs[1].status = Ending::IterationLimit;
    runs[0].end = end(sample(9, 1.0, 0.5));
    assert!(told(&runs)[1].starts_with("cg: 1 of 1\u{a0}run failed"), "{:?}", told(&runs));
}

#[test]
fn run_that_was_skipped_is_no_failure() {
    let runs = [
        run(0, "nsgs", "", Ending::Converged),
        run(1, "piqp", "", Ending::Skipped),
        run(2, "osqp", "", Ending::Skipped),
        run(3, "osqp", "", Ending::Failed),
    ];
    let told = told(&runs);
    assert!(told.contains(&"piqp: 1 of 1\u{a0}run skipped.".to_owned()), "{told:?}");
    assert!(told.contains(&"osqp: 1 of 2\u{a0}runs failed (1 failed), 1 skipped.".to_owned()), "{told:?}");
}

fn with(i: u32, method: &str, subdomains: u32, iterations: u64, status: Ending) -> Run {
    let settings = object(&json!({ "subdomains": format!("{subdomains}x1") }));
    Run { settings, subdomains, iterations, ..run(i, method, &format!("{subdomains}x1"), status) }
}

#[test]
fn subdomains_cost_what_the_ratio_of_iterations_says() {
    let mut runs =
        vec![with(0, "nsgs-dd", 1, 100, Ending::Converged), with(1, "nsgs-dd", 8, 128, Ending::Converged)];
    let expected = "From 1 to 8 subdomains nsgs-dd needs 1.28 times the iterations to natural map ≤ 10⁻⁴ (1\u{a0}problem).";
    assert_eq!(answered(&runs), [expected]);
    runs.push(with(2, "nsgs-dd", 2, 900, Ending::IterationLimit));
    assert!(
        answered(&runs)[0].ends_with("(1\u{a0}problem; 1\u{a0}run did not converge)."),
        "{:?}",
        answered(&runs)
    );
    runs[1].status = Ending::Diverged;
    assert_eq!(answered(&runs), [""; 0], "nothing is left to compare, and one method alone");
}

#[test]
fn problems_make_a_range_and_other_settings_no_pair() {
    let on = |problem: &str, run: Run| Run { problem: problem.into(), ..run };
    let mut runs = vec![
        on("a", with(0, "latin-dd", 1, 100, Ending::Converged)),
        on("a", with(1, "latin-dd", 4, 90, Ending::Converged)),
        on("b", with(2, "latin-dd", 1, 100, Ending::Converged)),
        on("b", with(3, "latin-dd", 4, 150, Ending::Converged)),
    ];
    let range = "needs 0.900 to 1.50 times the iterations to natural map ≤ 10⁻⁴ (2\u{a0}problems).";
    assert!(answered(&runs)[0].ends_with(range), "{:?}", answered(&runs));
    runs[3].settings.insert("relaxation".into(), json!(0.5));
    assert!(answered(&runs)[0].contains("needs 0.900 to 1.00 times"), "{:?}", answered(&runs));
}

#[test]
fn methods_that_are_right_in_all_runs_are_named() {
    let mut runs = vec![run(0, "cg", "", Ending::Converged), run(1, "nsgs", "", Ending::Converged)];
    runs.push(run(2, "nsgs", "slow", Ending::IterationLimit));
    runs.push(Run { problem: "b".into(), ..run(3, "cg", "", Ending::Skipped) });
    runs.push(run(4, "convex", "", Ending::Skipped));
    let right = "Converged, or proved that there is no solution, in all of their runs: cg (1; 1 skipped).";
    assert_eq!(answered(&runs), [right]);
    runs[0].status = Ending::Diverged;
    assert!(answered(&runs)[0].starts_with("No method converged"), "{:?}", answered(&runs));
}
