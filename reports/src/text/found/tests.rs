use results::schema::{KnownSolutions, Run};
use results::simulation::Energy;

use super::*;
use crate::read::Simulation;
use crate::tests::fixture::{end, run, sample, tables, whole};
use crate::tests::fixture_in_time as in_time;

fn told(runs: &[Run]) -> Vec<String> {
    found(&whole(&tables(runs, &[])))
}

fn study() -> Vec<Run> {
    vec![
        Run { iterations: 40, iterating_s: 0.5, ..run(0, "cg", "", "converged") },
        Run { iterations: 900, iterating_s: 0.2, ..run(1, "nsgs", "", "converged") },
        Run { iterations: 7, ..run(2, "jacobi", "", "diverged") },
    ]
}

#[test]
fn sentences_say_what_the_rows_say() {
    let expected = [
        "3\u{a0}runs of 3\u{a0}methods on 1\u{a0}problem: 2 converged, 1 diverged.",
        "column: cg (40) has the fewest iterations to natural map ≤ 10⁻⁴, nsgs (900) the most; nsgs is the fastest (0.20 s).",
        "jacobi: 1 of 1\u{a0}run failed (1 diverged).",
    ];
    assert_eq!(told(&study()), expected);
}

#[test]
fn other_rows_make_other_sentences() {
    let mut other = study();
    other[0].iterations = 1000;
    other[1].iterating_s = 0.9;
    other[2].status = "converged".into();
    let expected = [
        "3\u{a0}runs of 3\u{a0}methods on 1\u{a0}problem: 3 converged.",
        "column: jacobi (7) has the fewest iterations to natural map ≤ 10⁻⁴, cg (1\u{202f}000) the most; jacobi is the fastest (0.012 s).",
    ];
    assert_eq!(told(&other), expected);
}

#[test]
fn proof_that_there_is_no_solution_is_no_failure_unless_a_run_finds_one() {
    let on = |i, method: &str, status: &str| {
        let unknown = end(sample(9, 1.0, f64::NAN));
        Run { problem: "wedge".into(), end: unknown, ..run(i, method, "", status) }
    };
    let mut runs = vec![on(0, "cg", "infeasible"), on(1, "nsgs", "iteration-limit")];
    let expected = [
        "2\u{a0}runs of 2\u{a0}methods on 1\u{a0}problem: 1 iteration limit, 1 proved that there is no solution.",
        "wedge: no solution, as 1\u{a0}run proved.",
        "nsgs: 1 of 1\u{a0}run failed (1 iteration limit).",
    ];
    assert_eq!(told(&runs), expected);
    runs[1].status = "converged".into();
    assert_eq!(told(&runs)[2], "cg: 1 of 1\u{a0}run failed (1 claimed wrongly that there is no solution).");
    // The reference is certified: the velocity error is known.
    runs[1].status = "iteration-limit".into();
    runs[0].end = end(sample(9, 1.0, 0.5));
    assert!(told(&runs)[2].starts_with("cg: 1 of 1\u{a0}run failed"), "{:?}", told(&runs));
}

#[test]
fn interior_point_has_no_rank_by_iterations_and_one_in_time() {
    let mut runs = study();
    runs.push(Run { iterations: 2, iterating_s: 0.1, ..run(3, "interior-point", "", "converged") });
    let sentence = &told(&runs)[1];
    assert!(sentence.starts_with("column: cg (40) has the fewest iterations"), "{sentence}");
    assert!(sentence.ends_with("interior-point is the fastest (0.10 s)."), "{sentence}");
    assert_eq!(told(&runs[3..])[1], "column: interior-point alone converged.");
}

#[test]
fn runs_with_another_stop_rule_are_not_compared() {
    let mut runs = study();
    runs.push(Run { iterations: 600, ..run(3, "apgd", "", "converged") });
    runs[0].tolerance = 1e-1;
    assert!(told(&runs)[1].starts_with("column: apgd (600) has the fewest"), "{:?}", told(&runs));
}

#[test]
fn many_problems_are_counted_and_no_run_is_said() {
    let on = |i: u32, method: &str, iterations| Run {
        problem: format!("problem {}", i / 2),
        iterations,
        ..run(i, method, "", "converged")
    };
    let runs: Vec<Run> =
        (0..20).map(|i| if i % 2 == 0 { on(i, "cg", 10) } else { on(i, "nsgs", 5 + u64::from(i)) }).collect();
    assert_eq!(told(&runs)[1], "cg: fewest iterations on 8 of 10 problems; 10\u{a0}runs converged.");
    assert_eq!(told(&[]), ["No run of this study is stored."]);
}

#[test]
fn solutions_with_friction_are_told_where_there_are_several() {
    let mut runs = study();
    let known = |to: &str| KnownSolutions {
        solutions: Some(4),
        spread: 0.4712,
        polished_to: to.into(),
        polished_by: 1e-5,
    };
    for (run, to) in runs.iter_mut().zip(["known", "new", ""]) {
        run.known = known(to);
    }
    let sentence = &told(&runs)[1];
    assert_eq!(
        sentence,
        "column: 4\u{a0}certified solutions known, up to 0.47 apart in velocity; Newton's method leads from where 1\u{a0}run \
         ended to one of them, from where 1\u{a0}run ended to another."
    );
    for run in &mut runs {
        run.known = known("");
    }
    assert!(
        told(&runs)[1].ends_with("; Newton's method leads nowhere from where runs ended."),
        "{}",
        told(&runs)[1]
    );
    // Without friction there is one, and nothing to be said.
    for run in &mut runs {
        run.known = KnownSolutions { solutions: Some(1), spread: 0.0, ..KnownSolutions::default() };
    }
    assert!(told(&runs).iter().all(|sentence| !sentence.contains("certified")));
}

#[test]
fn energies_are_those_of_the_simulation_in_which_most_moved() {
    let with = |moved: f64, left: f64| {
        let mut one = in_time::simulated("run", 0.1, 1e-3);
        one.simulation.totals.energy = Energy {
            walls_work_j: moved / 2.0,
            sliding_work_j: -moved / 4.0,
            energy_moved_j: moved,
            energy_left_over_j: left,
            ..Energy::default()
        };
        Simulation::of(&one)
    };
    assert_eq!(energy(&[with(0.0, 0.0)]), None);
    let sentence = energy(&[with(8.0, 1e-15), with(4.0, 2e-12)]).unwrap();
    assert!(
        sentence.contains("walls gave 4.00 J, gaps that closed 0 J, shocks 0 J and sliding -2.00 J"),
        "{sentence}"
    );
    assert!(sentence.contains("at most 5·10⁻¹³ of what changed hands"), "{sentence}");
}

#[test]
fn runs_that_end_in_a_drift_are_counted() {
    let mut runs = study();
    for run in &mut runs {
        run.status = "iteration-limit".into();
        (run.iterations, run.last_change_moves) = (1000, 1e-7);
    }
    (runs[1].last_change_moves, runs[2].last_change_moves) = (f64::NAN, 1e-3);
    let sentence = floors_of(&runs).unwrap();
    assert!(sentence.contains("at the end of 1\u{a0}run impulses drift"), "{sentence}");
    for run in &mut runs {
        run.status = "converged".into();
    }
    assert_eq!(floors_of(&runs), None);
}

fn floors_of(runs: &[Run]) -> Option<String> {
    told(runs).into_iter().find(|sentence| sentence.starts_with("Next to nothing moves"))
}

#[test]
fn runs_that_go_round_are_counted_with_the_lengths_of_their_cycles() {
    let mut runs = study();
    let cycles = |runs: &[Run]| told(runs).into_iter().find(|sentence| sentence.contains("cycle"));
    assert_eq!(cycles(&runs), None);
    runs[0].cycle_iterations = Some(2);
    assert_eq!(cycles(&runs).unwrap(), "1\u{a0}run goes round in a cycle of 2 iterations at the end.");
    runs[1].cycle_iterations = Some(14);
    assert_eq!(cycles(&runs).unwrap(), "2\u{a0}runs go round in cycles of 2 to 14 iterations at the end.");
}

#[test]
fn run_that_was_skipped_is_no_failure() {
    let runs = [
        run(0, "nsgs", "", "converged"),
        run(1, "piqp", "", "skipped"),
        run(2, "osqp", "", "skipped"),
        run(3, "osqp", "", "failed"),
    ];
    let told = told(&runs);
    assert!(told.contains(&"piqp: 1 of 1\u{a0}run skipped.".to_owned()), "{told:?}");
    assert!(told.contains(&"osqp: 1 of 2\u{a0}runs failed (1 failed), 1 skipped.".to_owned()), "{told:?}");
}
