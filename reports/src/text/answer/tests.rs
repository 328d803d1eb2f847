use results::schema::Run;
use serde_json::json;

use super::*;
use crate::read::Study;
use crate::tests::fixture::{object, run, tables, whole};

fn with(i: u32, method: &str, subdomains: u32, iterations: u64, status: &str) -> Run {
    let settings = object(&json!({ "subdomains": format!("{subdomains}x1") }));
    let variant = format!("{subdomains}x1");
    Run {
        settings,
        subdomains,
        iterations,
        iterations_to_zeta_1e_4: None,
        ..run(i, method, &variant, status)
    }
}

fn answered(runs: &[Run]) -> Vec<String> {
    let Study::Problems(study) = whole(&tables(runs, &[])) else { panic!("runs on problems") };
    answer(&study, true)
}

#[test]
fn subdomains_cost_what_the_ratio_of_iterations_says() {
    let mut runs = vec![with(0, "nsgs-dd", 1, 100, "converged"), with(1, "nsgs-dd", 8, 128, "converged")];
    runs[1].iterations_to_zeta_1e_4 = Some(44);
    runs[0].iterations_to_zeta_1e_4 = Some(40);
    let expected = "From 1 to 8 subdomains nsgs-dd needs 28\u{a0}% more iterations to natural map ≤ 10⁻⁴, and 10\u{a0}% \
                    more iterations to ζ ≤ 10⁻⁴ (1\u{a0}problem).";
    assert_eq!(answered(&runs), [expected]);
    runs[1].status = "diverged".into();
    assert_eq!(answered(&runs), [""; 0], "nothing is left to compare, and one method alone");
}

#[test]
fn what_fails_between_the_fewest_and_the_most_is_told() {
    let mut runs = vec![with(0, "latin-dd", 1, 200, "converged"), with(1, "latin-dd", 8, 100, "converged")];
    assert!(answered(&runs)[0].ends_with("(1\u{a0}problem)."), "{:?}", answered(&runs));
    runs.extend([with(2, "latin-dd", 2, 900, "iteration-limit"), with(3, "latin-dd", 4, 300, "converged")]);
    let told = "needs 50\u{a0}% fewer iterations to natural map ≤ 10⁻⁴ (1\u{a0}problem); 1\u{a0}run in between did not converge.";
    assert!(answered(&runs)[0].ends_with(told), "{:?}", answered(&runs));
}

#[test]
fn problems_make_a_range_and_other_settings_no_pair() {
    let on = |problem: &str, run: Run| Run { problem: problem.into(), ..run };
    let mut runs = vec![
        on("a", with(0, "latin-dd", 1, 100, "converged")),
        on("a", with(1, "latin-dd", 4, 90, "converged")),
        on("b", with(2, "latin-dd", 1, 100, "converged")),
        on("b", with(3, "latin-dd", 4, 150, "converged")),
    ];
    let range = "needs between 10\u{a0}% fewer and 50\u{a0}% more iterations to natural map ≤ 10⁻⁴ (2\u{a0}problems).";
    assert!(answered(&runs)[0].ends_with(range), "{:?}", answered(&runs));
    runs[3].settings.insert("relaxation".into(), json!(0.5));
    assert!(answered(&runs)[0].contains("10\u{a0}% fewer iterations"), "{:?}", answered(&runs));
}

#[test]
fn who_is_first_in_time_is_said_where_methods_meet() {
    let mut runs = vec![with(0, "nsgs-dd", 1, 100, "converged"), with(1, "nsgs-dd", 2, 100, "converged")];
    assert_eq!(answered(&runs).len(), 1);
    runs.push(Run { iterating_s: 1e-9, setup_s: 0.0, ..run(2, "cg", "", "converged") });
    let told = answered(&runs);
    let [subdomains, time] = &told[..] else { panic!("two sentences") };
    assert!(subdomains.contains("needs as many iterations"));
    assert_eq!(time, "Fastest to the tolerance: cg on 1 of 1\u{a0}problem.");
    // Also where no other method came there.
    runs[0].status = "iteration-limit".into();
    runs[1].status = "iteration-limit".into();
    assert_eq!(answered(&runs).last(), Some(time));
}

#[test]
fn methods_are_ranked_by_the_runs_in_which_they_are_right() {
    let mut runs = vec![run(0, "cg", "", "converged"), run(1, "nsgs", "", "converged")];
    runs.push(run(2, "nsgs", "slow", "iteration-limit"));
    let [right, wrong, _time] = &answered(&runs)[..] else {
        panic!("three sentences: {:?}", answered(&runs))
    };
    assert_eq!(right, "Converged, or proved that there is no solution, in all of their runs: cg (1).");
    assert_eq!(wrong, "Most often not: nsgs, in 1 of 2\u{a0}runs.");
    runs[0].status = "diverged".into();
    assert!(answered(&runs)[0].starts_with("No method converged"), "{:?}", answered(&runs));
    assert!(answered(&runs)[1].contains("cg, in 1 of 1\u{a0}run"), "{:?}", answered(&runs));
}

#[test]
fn a_run_that_was_skipped_did_not_fail() {
    let on = |i: u32, problem: &str, method: &str, status: &str| Run {
        problem: problem.into(),
        ..run(i, method, "", status)
    };
    let runs = [
        on(0, "a", "mprgp", "converged"),
        on(1, "b", "mprgp", "skipped"),
        on(2, "a", "nsgs", "converged"),
        on(3, "b", "nsgs", "iteration-limit"),
        on(4, "a", "convex", "skipped"),
    ];
    let told = answered(&runs);
    assert_eq!(
        told[0],
        "Converged, or proved that there is no solution, in all of their runs: mprgp (1; 1 skipped)."
    );
    assert_eq!(told[1], "Most often not: nsgs, in 1 of 2\u{a0}runs.");
}

#[test]
fn where_nothing_was_to_be_reached_an_iteration_is_timed() {
    let endless = |i: u32, method: &str, ranks: u32| {
        let mut run =
            Run { iterations: 10, iterating_s: 0.5, tolerance: 0.0, ..run(i, method, "", "iteration-limit") };
        run.exchange.ranks = ranks;
        run
    };
    let mut runs = vec![endless(0, "cg", 1), endless(1, "nsgs-dd", 4)];
    runs.push(Run { problem: "small".into(), contacts: 0, ..endless(2, "cg", 1) });
    let problem = runs[0].problem.clone();
    let expected = format!(
        "An iteration on {problem}: 0.050 s with cg on 1\u{a0}thread, 0.050 s with nsgs-dd on 4\u{a0}ranks."
    );
    assert_eq!(answered(&runs), [expected]);
}
