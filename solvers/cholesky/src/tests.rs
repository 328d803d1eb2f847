//! Factors against dense solves.

use super::*;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// 1 + Σ κ h hᵗ of unit vectors between neighbours on a ring, as its lower triangle; and dense.
fn ring(grains: usize) -> (Vec<Triplet<usize, usize, f64>>, DMatrix<f64>) {
    let mut dense = DMatrix::identity(2 * grains, 2 * grains);
    for i in 0..grains {
        let (sin, cos) = (i as f64).sin_cos();
        let mut h = DVector::zeros(2 * grains);
        for (grain, sign) in [(i, 1.0), ((i + 1) % grains, -1.0)] {
            (h[2 * grain], h[2 * grain + 1]) = (sign * cos, sign * sin);
        }
        dense += 10.0 * &h * h.transpose();
    }
    let places = (0..2 * grains).flat_map(|i| (0..=i).map(move |j| (i, j)));
    let lower = places.filter(|place| dense[*place] != 0.0).map(|(i, j)| Triplet::new(i, j, dense[(i, j)]));
    (lower.collect(), dense)
}

fn right_hand_side(n: usize) -> DVector<f64> {
    DVector::from_fn(n, |k, _| (1.3 * k as f64).cos())
}

#[test]
fn factor_by_entries_solves() {
    let (lower, dense) = ring(9);
    let order = Order::minimum_degree(18, lower.iter().map(|entry| (entry.row, entry.col))).unwrap();
    let mut factor = Factor::new(18, &lower, &order).unwrap();
    let mut x = right_hand_side(18);
    factor.solve(x.as_mut_slice());
    // The condition of the matrix is below 50.
    assert!((dense * x - right_hand_side(18)).norm() < 1e-13);
    assert!(factor.entries() < 18 * 19 / 2, "it is sparse: {}", factor.entries());
}

#[test]
fn factor_in_blocks_solves_with_the_same_entries_twice() {
    let (_, dense) = ring(9);
    let pairs = (0..9).map(|i| (i, (i + 1) % 9));
    let structure = BlockStructure::new(9, pairs).unwrap();
    let place = |grain: usize| structure.position()[grain] as usize;
    let coupled = (0..9).flat_map(|i| [(i, i), (i, (i + 1) % 9), ((i + 1) % 9, i)]);
    let block =
        |(i, j): (usize, usize)| (place(i), place(j), dense.fixed_view::<2, 2>(2 * i, 2 * j).into_owned());
    let blocks = coupled.map(block).filter(|(i, j, _)| i <= j);
    let twice = blocks.flat_map(|(i, j, block)| [0.25, 0.75].map(|share| (i, j, share * block)));
    let factor = structure.factorise(twice).unwrap();
    let mut x = vec![Vector2::zeros(); 9];
    let b = right_hand_side(18);
    for k in 0..9 {
        x[structure.position()[k] as usize] = Vector2::new(b[2 * k], b[2 * k + 1]);
    }
    factor.solve(&mut x);
    let x = DVector::from_fn(18, |k, _| x[structure.position()[k / 2] as usize][k % 2]);
    assert!((dense * x - b).norm() < 1e-13);
    // A ring fills one block per grain that is eliminated between two others.
    assert_eq!(factor.entries(), 3 * 9 + 4 * (9 + 6));
}

#[test]
fn matrix_that_is_not_positive_definite_has_no_factor() {
    let entries = [Triplet::new(0, 0, 1.0), Triplet::new(1, 1, -1.0)];
    let order = Order::minimum_degree(2, std::iter::empty()).unwrap();
    assert!(Factor::new(2, &entries, &order).is_err());
    let block = (0, 0, Matrix2::new(1.0, 0.0, 0.0, -1.0));
    assert!(BlockStructure::new(1, std::iter::empty()).unwrap().factorise(std::iter::once(block)).is_err());
}
