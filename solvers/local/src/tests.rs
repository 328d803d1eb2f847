//! The law at one contact, and sweeps over problems with known answers.

use super::{LocalProblem, Nsgs};
use proptest::prelude::*;

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
        let mut nsgs = Nsgs::new(&problem);
        nsgs.sweep();
        let r = nsgs.impulses();
        // Relative to what acts, not to the impulse that solves it: that is large where W is nearly singular.
        let size: f64 = r.iter().map(|r| r.abs()).sum();
        let left = problem.natural_map(r) * -q[0].min(-f64::MIN_POSITIVE) / (1.0 + size);
        prop_assert!(q[0] >= 0.0 || left < 1e-10, "{left:e} of {r:?}");
        prop_assert!(r[0] >= 0.0 && r[1..].iter().map(|r| r * r).sum::<f64>().sqrt() <= friction * r[0] * (1.0 + 1e-12) + 1e-300);
    }
}

#[test]
fn sliding_contact_with_a_diagonal_block_has_the_impulse_of_two_lines() {
    // r_n = −q_n/w_n; the velocity along the tangents stays parallel to q_t, so r_t = −μ r_n q_t/|q_t|.
    let entries = [(0, 0, 2.0), (1, 1, 7.0), (2, 2, 7.0)];
    let problem = LocalProblem::new(3, entries, vec![-1.0, 3.0, -4.0], vec![0.3]).unwrap();
    let mut nsgs = Nsgs::new(&problem);
    nsgs.sweep();
    for (r, expected) in nsgs.impulses().iter().zip([0.5, -0.15 * 0.6, 0.15 * 0.8]) {
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
