//! The law at one contact, and methods on problems with known answers.

use super::{LocalProblem, Method, Preconditioner, graph};
use contact::acceleration::{Acceleration, LAG};
use proptest::prelude::*;

/// Gauss-Seidel as it is.
const PLAIN: Method = Method::Nsgs { subdomains: 1, momentum: None };

/// The impulses after so many iterations.
fn after(method: Method, problem: &LocalProblem, iterations: u32) -> Vec<f64> {
    let mut run = method.start(problem).unwrap();
    for _ in 0..iterations {
        run.advance();
    }
    let mut r = vec![0.0; problem.q().len()];
    run.impulses(&mut r);
    r
}

/// W = A Aᵗ + 0.05 I with a band of A, so that contacts have neighbours.
fn chain(dimension: usize, contacts: usize, a: &[f64], q: &[f64], friction: f64) -> LocalProblem {
    let (size, width) = (dimension * contacts, 2 * dimension);
    let a = |row: usize, k: usize| if k < width { a[(7 * row + 3 * k) % a.len()] } else { 0.0 };
    let entry = |row: usize, column: usize| {
        let least = row.max(column);
        let product: f64 =
            (least..row.min(column) + width).map(|k| a(row, k - row) * a(column, k - column)).sum();
        (row, column, product + if row == column { 0.05 } else { 0.0 })
    };
    let near = |row: usize| row.saturating_sub(width)..(row + width).min(size);
    let entries = (0..size).flat_map(|row| near(row).map(move |column| entry(row, column)));
    let q = (0..size).map(|k| q[k % q.len()]).collect();
    LocalProblem::new(dimension, entries, q, vec![friction; contacts]).unwrap()
}

/// q(r) = ½ rᵗ W r + qᵗ r.
fn energy(problem: &LocalProblem, r: &[f64]) -> f64 {
    let v = problem.velocity(r);
    r.iter().zip(v.iter().zip(problem.q())).map(|(r, (v, q))| 0.5 * r * (v + q)).sum()
}

/// One contact of W = A Aᵗ + 0.05 I.
fn one(dimension: usize, a: &[f64], q: &[f64], friction: f64) -> LocalProblem {
    let entry = |row: usize, column: usize| {
        let product: f64 = (0..dimension).map(|k| a[3 * row + k] * a[3 * column + k]).sum();
        (row, column, product + if row == column { 0.05 } else { 0.0 })
    };
    let entries = (0..dimension).flat_map(|row| (0..dimension).map(move |column| entry(row, column)));
    LocalProblem::new(dimension, entries, q[..dimension].to_vec(), vec![friction]).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn one_sweep_solves_one_contact_whatever_its_block(
        a in prop::array::uniform9(-1.0..1.0f64),
        q in prop::array::uniform3(-1.0..1.0f64),
        friction in 0.0..1.2f64,
        dimension in 1usize..4,
    ) {
        let problem = one(dimension, &a, &q, friction);
        let r = after(PLAIN, &problem, 1);
        // Relative to what acts, not to the impulse that solves it: that is large where W is nearly singular.
        let size: f64 = r.iter().map(|r| r.abs()).sum();
        let left = problem.natural_map(&r) * -q[0].min(-f64::MIN_POSITIVE) / (1.0 + size);
        prop_assert!(q[0] >= 0.0 || left < 1e-10, "{left:e} of {r:?}");
        prop_assert!(r[0] >= 0.0 && r[1..].iter().map(|r| r * r).sum::<f64>().sqrt() <= friction * r[0] * (1.0 + 1e-12) + 1e-300);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn energy_never_grows_on_any_number_of_subdomains(
        a in prop::collection::vec(-1.0..1.0f64, 29),
        q in prop::collection::vec(-1.0..0.5f64, 23),
        subdomains in 1usize..9,
    ) {
        let problem = chain(1, 24, &a, &q, 0.0);
        let mut before = 0.0;
        for iterations in 1..12 {
            let energy = energy(&problem, &after(Method::Nsgs { subdomains, momentum: None }, &problem, iterations));
            prop_assert!(energy <= before + 1e-14, "{before:e} to {energy:e}");
            before = energy;
        }
    }

    #[test]
    fn active_set_solves_to_round_off_in_every_dimension(
        a in prop::collection::vec(-1.0..1.0f64, 29),
        q in prop::collection::vec(-1.0..0.5f64, 23),
        friction in 0.05..0.4f64,
        dimension in 1usize..4,
    ) {
        let problem = chain(dimension, 12, &a, &q, friction);
        prop_assume!(problem.scale() > 1e-3);
        let mut run = Method::ActiveSet { start_accuracy: 1e-2 }.start(&problem).unwrap();
        let mut iterations = 0;
        while !run.stalled() && iterations < 30_000 {
            run.advance();
            iterations += 1;
        }
        let mut r = vec![0.0; problem.q().len()];
        run.impulses(&mut r);
        // W is nearly singular at times, and impulses are large then.
        let size = r.iter().map(|r| r.abs()).fold(1.0, f64::max);
        prop_assert!(problem.natural_map(&r) < 1e-12 * size, "{:e}", problem.natural_map(&r));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A W that contacts feel much or hardly, with q of all signs and sizes, zeros among them.
    #[test]
    fn every_iteration_of_every_method_ends(
        a in prop::collection::vec(prop_oneof![Just(0.0), -1.0..1.0f64, -1e-8..1e-8f64], 29),
        q in prop::collection::vec(prop_oneof![Just(0.0), Just(-1.0), -1.0..1.0f64, -1e-300..1e-300f64, -1e150..1e150f64], 1..23),
        friction in prop_oneof![Just(0.0), 0.0..1.5f64],
        dimension in 1usize..4,
        contacts in 1usize..40,
        start_accuracy in prop_oneof![Just(0.0), Just(3e-3), Just(1.0), Just(f64::MAX)],
    ) {
        let problem = chain(dimension, contacts, &a, &q, friction);
        let two = Method::Nsgs { subdomains: contacts.min(2), momentum: None };
        let [none, diagonal] = [Preconditioner::None, Preconditioner::Diagonal].map(|preconditioner| Method::Cg { preconditioner });
        for method in [PLAIN, two, none, diagonal, Method::ActiveSet { start_accuracy }] {
            let r = after(method, &problem, 60);
            prop_assert_eq!(r.len(), problem.q().len());
        }
    }
}

#[test]
fn start_that_solves_the_problem_exactly_is_the_end() {
    for (dimension, contacts, friction) in
        [(1, 1, 0.0), (2, 1, 0.3), (2, 300, 0.0), (3, 7, 0.8), (3, 300, 0.3)]
    {
        // Powers of two, so that nothing is rounded; tangents are at rest.
        let size = dimension * contacts;
        let entries = (0..size).map(|k| (k, k, f64::from(1 << (k % 3))));
        let q = (0..size).map(|k| if k % dimension == 0 { -0.5 } else { 0.0 }).collect();
        let problem = LocalProblem::new(dimension, entries, q, vec![friction; contacts]).unwrap();
        for start_accuracy in [0.0, 3e-3, 1.0, f64::MAX] {
            let mut run = Method::ActiveSet { start_accuracy }.start(&problem).unwrap();
            let ends = (0..500).any(|_| {
                run.advance();
                run.stalled()
            });
            let mut r = vec![0.0; size];
            run.impulses(&mut r);
            assert!(ends && problem.natural_map(&r) < 1e-15, "{:e}", problem.natural_map(&r));
        }
    }
}

#[test]
fn methods_without_friction_end_at_one_velocity() {
    let a: Vec<f64> = (0..29).map(|k| f64::from(k * k % 13) / 13.0 - 0.4).collect();
    let problem = chain(1, 40, &a, &[-1.0, 0.3, -0.2, -0.7, 0.1], 0.0);
    let expected = problem.velocity(&after(Method::ActiveSet { start_accuracy: 1e-3 }, &problem, 300));
    let diagonal = Method::Cg { preconditioner: Preconditioner::Diagonal };
    let none = Method::Cg { preconditioner: Preconditioner::None };
    for method in [PLAIN, Method::Nsgs { subdomains: 5, momentum: None }, diagonal, none] {
        let v = problem.velocity(&after(method, &problem, 20_000));
        let off = v.iter().zip(&expected).map(|(v, expected)| (v - expected).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{method:?}: {off:e}");
    }
}

#[test]
fn subdomains_of_a_chain_are_its_pieces() {
    let entries = (0..12usize).flat_map(|k| {
        [
            Some((k, k, 2.0)),
            (k > 0).then_some((k, k.wrapping_sub(1), -1.0)),
            (k < 11).then_some((k, k + 1, -1.0)),
        ]
    });
    let problem = LocalProblem::new(1, entries.flatten(), vec![0.0; 12], vec![0.0; 12]).unwrap();
    for count in [1, 2, 3, 5, 12] {
        let subdomain = graph::subdomains(&problem, count).unwrap();
        let parted = subdomain.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert_eq!(parted, count - 1, "{subdomain:?}");
        let sizes: Vec<_> =
            (0..count as u32).map(|own| subdomain.iter().filter(|of| **of == own).count()).collect();
        assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1, "{sizes:?}");
    }
    assert!(graph::subdomains(&problem, 13).unwrap_err().to_string().contains("1 to 12"));
    assert!(graph::subdomains(&problem, 0).is_err());
}

#[test]
fn sliding_contact_with_a_diagonal_block_has_the_impulse_of_two_lines() {
    // r_n = −q_n/w_n; the velocity along the tangents stays parallel to q_t, so r_t = −μ r_n q_t/|q_t|.
    let entries = [(0, 0, 2.0), (1, 1, 7.0), (2, 2, 7.0)];
    let problem = LocalProblem::new(3, entries, vec![-1.0, 3.0, -4.0], vec![0.3]).unwrap();
    for (r, expected) in after(PLAIN, &problem, 1).iter().zip([0.5, -0.15 * 0.6, 0.15 * 0.8]) {
        assert!((r - expected).abs() < 1e-15, "{r}");
    }
}

#[test]
fn block_that_is_missing_or_indefinite_is_refused() {
    let refused = |entries: &[(usize, usize, f64)]| {
        let entries = entries.iter().copied();
        LocalProblem::new(1, entries, vec![0.0; 2], vec![0.0; 2]).unwrap_err().to_string()
    };
    assert!(refused(&[(0, 0, 1.0)]).contains("`W[1]` is missing"));
    assert!(refused(&[(1, 1, 1.0), (0, 1, 1.0)]).contains("`W[0]` is missing"));
    assert!(refused(&[(0, 0, 1.0), (1, 1, -1.0)]).contains("`W[1]` is [-1.0]"));
    assert!(refused(&[(0, 2, 1.0)]).contains("row 0, column 2"));
    assert!(refused(&[(0, 0, f64::NAN)]).contains("NaN"));
}

/// Iterations until the natural map is at most 1e-9, of at most 20,000.
fn iterations_to_solve(method: Method, problem: &LocalProblem) -> usize {
    let (mut run, mut r) = (method.start(problem).unwrap(), vec![0.0; problem.q().len()]);
    let mut is_left = || {
        run.advance();
        run.impulses(&mut r);
        problem.natural_map(&r) > 1e-9
    };
    (0..20_000).take_while(|_| is_left()).count()
}

#[test]
fn accelerated_sweeps_solve_in_fewer_iterations_on_any_number_of_subdomains() {
    let smooth = |row: usize, column: usize| match row.abs_diff(column) {
        0 => 2.001,
        1 => -1.0,
        _ => 0.0,
    };
    // A beam of masses between springs: its stiffness has a small least eigenvalue.
    let near = |row: usize| row.saturating_sub(1)..(row + 2).min(400);
    let entries = (0..400).flat_map(|row| near(row).map(move |column| (row, column, smooth(row, column))));
    let line = LocalProblem::new(1, entries, vec![-1.0; 400], vec![0.0; 400]).unwrap();
    let a: Vec<f64> = (0..29).map(|k| (f64::from(k) * 2.3).sin()).collect();
    let q: Vec<f64> = (0..23).map(|k| (f64::from(k) * 1.7).sin() - 0.4).collect();
    let momentum = Acceleration::Nesterov.momentum(LAG, None).unwrap();
    for (problem, gain) in [(line, 5), (chain(2, 60, &a, &q, 0.2), 1), (chain(3, 60, &a, &q, 0.2), 1)] {
        for subdomains in [1, 4] {
            let [plain, accelerated] = [None, momentum]
                .map(|momentum| iterations_to_solve(Method::Nsgs { subdomains, momentum }, &problem));
            assert!(gain * accelerated < plain, "{subdomains} subdomains: {accelerated}, plain {plain}");
        }
    }
}
