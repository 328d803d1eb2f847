//! Factors against dense ones.

use super::*;
use crate::supernodes::{Growing, fundamental, pairs};
use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector2};
use std::sync::Arc;

type Ends = Vec<(u32, Option<u32>)>;

/// Grains on a bent grid, each coupled to its right and upper neighbour, and the lowest row to a wall: positions and ends.
fn grid(columns: u32, rows: u32) -> (Vec<Vector2<f64>>, Ends) {
    let grain = |i: u32, j: u32| j * columns + i;
    let position =
        |k: u32| Vector2::new(f64::from(k % columns), f64::from(k / columns) + 0.1 * f64::from(k).sin());
    let mut ends: Ends = (0..columns).map(|i| (grain(i, 0), None)).collect();
    for j in 0..rows {
        for i in 0..columns {
            ends.extend((i + 1 < columns).then(|| (grain(i, j), Some(grain(i + 1, j)))));
            ends.extend((j + 1 < rows).then(|| (grain(i, j + 1), Some(grain(i, j)))));
        }
    }
    ((0..columns * rows).map(position).collect(), ends)
}

/// w h hᵗ of vectors that turn from coupling to coupling; some couplings add nothing.
fn coupling<const D: usize>(k: usize, seed: f64) -> Option<Coupling<D>> {
    let (sin, cos) = (seed * k as f64).sin_cos();
    let first = SVector::from_fn(|c, _| [cos, sin, 0.3 - sin * cos][c]);
    let second = SVector::from_fn(|c, _| [-cos, 0.5 - sin, 0.2 + sin][c]);
    (k % 5 != 4).then(|| Coupling::dyad(10.0 + sin, first, second))
}

/// Entry for the first two unknowns of a grain; the third has half of it.
fn mass(grain: usize) -> f64 {
    1.0 + 0.01 * grain as f64
}

fn masses<const D: usize>(grain: usize) -> SVector<f64, D> {
    SVector::from_fn(|c, _| [1.0, 1.0, 0.5][c] * mass(grain))
}

/// Returns the matrix, dense, by grains.
fn dense<const D: usize>(grains: usize, ends: &[(u32, Option<u32>)], seed: f64) -> DMatrix<f64> {
    let mut dense = DMatrix::from_diagonal(&DVector::from_fn(D * grains, |k, _| masses::<D>(k / D)[k % D]));
    for (k, (i, j)) in ends.iter().enumerate() {
        let Some(coupling) = coupling::<D>(k, seed) else { continue };
        let mut add = |row: u32, column: u32, block: &SMatrix<f64, D, D>| {
            let mut view = dense.fixed_view_mut::<D, D>(D * row as usize, D * column as usize);
            view += block;
        };
        add(*i, *i, &coupling.first);
        if let Some(j) = j {
            add(*j, *j, &coupling.second);
            add(*i, *j, &coupling.between);
            add(*j, *i, &coupling.between.transpose());
        }
    }
    dense
}

fn factor<const D: usize>(structure: &Arc<Structure<D>>, grains: usize, seed: f64) -> Factor<D> {
    let mut at = vec![0; grains];
    (0..grains).for_each(|grain| at[structure.position()[grain] as usize] = grain);
    Factor::new(Arc::clone(structure), |place| masses(at[place]), |k| coupling(k, seed)).unwrap()
}

/// x by grains with K x = b, for b = cos.
fn solve<const D: usize>(factor: &Factor<D>, structure: &Structure<D>, grains: usize) -> DVector<f64> {
    let b = |k: usize| (1.3 * k as f64).cos();
    let mut x = vec![SVector::zeros(); grains];
    for grain in 0..grains {
        x[structure.position()[grain] as usize] = SVector::from_fn(|c, _| b(D * grain + c));
    }
    factor.solve(&mut x);
    DVector::from_fn(D * grains, |k, _| x[structure.position()[k / D] as usize][k % D])
}

fn both_orders(position: &[Vector2<f64>], ends: &[(u32, Option<u32>)]) -> [Order; 2] {
    [Order::minimum_degree(position.len(), ends).unwrap(), Order::nested_dissection(position, ends)]
}

/// From one grain, whose tree is a leaf, to many, whose fronts are cut into panels and go to threads.
fn assert_solves_what_a_dense_one_does<const D: usize>() {
    for (columns, rows) in [(1, 1), (2, 1), (9, 1), (5, 4), (13, 11), (40, 35)] {
        let (position, ends) = grid(columns, rows);
        let grains = position.len();
        let dense = dense::<D>(grains, &ends, 0.7);
        let expected = DVector::from_fn(D * grains, |k, _| (1.3 * k as f64).cos());
        for order in both_orders(&position, &ends) {
            let structure = Structure::<D>::new(&ends, &order).unwrap();
            let x = solve(&factor(&structure, grains, 0.7), &structure, grains);
            // The condition of the matrix is below 1000.
            let residual = (&dense * x - &expected).amax();
            assert!(residual < 1e-12, "{columns}x{rows}: {residual}");
        }
    }
}

#[test]
fn factors_of_either_order_solve_what_dense_ones_do() {
    assert_solves_what_a_dense_one_does::<2>();
}

#[test]
fn factors_with_three_unknowns_per_grain_solve_what_dense_ones_do() {
    assert_solves_what_a_dense_one_does::<3>();
}

#[test]
fn third_unknown_that_nothing_couples_leaves_the_others_as_they_are() {
    let (position, ends) = grid(12, 9);
    let flat = |k: usize| {
        coupling::<2>(k, 0.7).map(|of| {
            let larger = |block: SMatrix<f64, 2, 2>| block.fixed_resize::<3, 3>(0.0);
            Coupling { first: larger(of.first), second: larger(of.second), between: larger(of.between) }
        })
    };
    for order in both_orders(&position, &ends) {
        let (two, three) =
            (Structure::<2>::new(&ends, &order).unwrap(), Structure::<3>::new(&ends, &order).unwrap());
        let mut x = vec![SVector::from([1.0, -2.0]); position.len()];
        let mut larger = vec![SVector::from([1.0, -2.0, 3.0]); position.len()];
        Factor::new(two, masses, |k| coupling(k, 0.7)).unwrap().solve(&mut x);
        Factor::new(three, masses, flat).unwrap().solve(&mut larger);
        for (place, (x, larger)) in x.iter().zip(&larger).enumerate() {
            assert!((x - larger.xy()).amax() < 1e-13, "{place}: {x} and {larger}");
            assert!((larger.z - 3.0 / masses::<3>(place).z).abs() < 1e-13, "{place}: {larger}");
        }
    }
}

/// A ring fills one block per grain that is eliminated between two others.
#[test]
fn supernodes_of_a_ring_have_its_entries_before_any_are_joined() {
    let ends: Ends = (0..9).map(|i| (i, Some((i + 1) % 9))).collect();
    let order = Order::minimum_degree(9, &ends).unwrap();
    let blocks = |node: &Growing| {
        let own = node.own.len();
        own * (own - 1) / 2 + own * node.rows.len()
    };
    let structure = Structure::<2>::new(&ends, &order).unwrap();
    let supernodes = fundamental(pairs(&ends, structure.position()), 9);
    let below: usize = supernodes.iter().map(blocks).sum();
    assert_eq!(3 * 9 + 4 * below, 3 * 9 + 4 * (9 + 6));
    assert!(structure.entries() >= 3 * 9 + 4 * (9 + 6), "joined, they store zeros too");
}

#[test]
fn grains_that_nothing_couples_have_their_masses() {
    let structure = Structure::<2>::new(&[], &Order::minimum_degree(3, &[]).unwrap()).unwrap();
    let x = solve(&factor(&structure, 3, 0.0), &structure, 3);
    let expected = DVector::from_fn(6, |k, _| (1.3 * k as f64).cos() / mass(k / 2));
    assert!((x - expected).amax() < 1e-15);
    assert_eq!(structure.entries(), 3 * 3);
}

#[test]
fn couplings_of_the_same_grains_add_up() {
    let ends = [(0, Some(1)), (1, Some(0)), (0, None), (0, Some(1))];
    let structure = Structure::<2>::new(&ends, &Order::minimum_degree(2, &ends).unwrap()).unwrap();
    let x = solve(&factor(&structure, 2, 0.3), &structure, 2);
    let expected = DVector::from_fn(4, |k, _| (1.3 * k as f64).cos());
    assert!((dense::<2>(2, &ends, 0.3) * x - expected).amax() < 1e-13);
}

#[test]
fn factor_in_the_memory_of_another_is_that_of_a_new_one() {
    let (position, ends) = grid(12, 9);
    for order in both_orders(&position, &ends) {
        let structure = Structure::<2>::new(&ends, &order).unwrap();
        let mut again = factor(&structure, position.len(), 0.7);
        again.renew(|_| Vector2::repeat(2.0), |k| coupling(k, 1.1)).unwrap();
        let new =
            Factor::new(Arc::clone(&structure), |_| Vector2::repeat(2.0), |k| coupling(k, 1.1)).unwrap();
        assert_eq!(
            solve(&again, &structure, position.len()),
            solve(&new, &structure, position.len()),
            "bit by bit"
        );
    }
}

/// Checks factors, of either kind, whose subtrees and products go to threads, and others.
#[test]
fn factors_have_the_same_bits_with_any_number_of_threads() {
    let (position, ends) = grid(90, 80);
    let order = Order::nested_dissection(&position, &ends);
    let structure = Structure::<2>::new(&ends, &order).unwrap();
    assert!(structure.work() > 10_000_000, "there is work for several");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let symmetric = solve(&factor(&structure, position.len(), 0.7), &structure, position.len());
            let mut x = vec![Vector2::new(1.0, -0.5); position.len()];
            lu(&structure, position.len()).solve(&mut x);
            (symmetric, x)
        })
    };
    let one = with(1);
    assert!([2, 3, 8].into_iter().all(|threads| with(threads) == one));
}

/// On a square of n grains a side a nested dissection has some n² log n entries; in the order of rows it has n³.
#[test]
fn entries_per_grain_grow_by_as_much_each_time_the_sides_are_doubled() {
    let entries = |n: u32| {
        let (position, ends) = grid(n, n);
        let structure = Structure::<2>::new(&ends, &Order::nested_dissection(&position, &ends)).unwrap();
        structure.entries() as f64 / f64::from(n * n)
    };
    let of = [40, 80, 160].map(entries);
    assert!(of[2] - of[1] < 1.2 * (of[1] - of[0]), "{of:?} entries per grain");
}

#[test]
fn matrix_that_is_not_positive_definite_has_no_factor() {
    let structure = Structure::<2>::new(&[], &Order::minimum_degree(1, &[]).unwrap()).unwrap();
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let failed = Factor::new(Arc::clone(&structure), |_| Vector2::repeat(mass), |_| None).err();
        assert_eq!(failed.unwrap().to_string(), "it is not positive definite in double precision");
    }
}

/// push pullᵗ of vectors that turn from coupling to coupling.
fn one_way<const D: usize>(k: usize, seed: f64) -> Option<OneWay<D>> {
    let Coupling { first, second, between } = coupling::<D>(k, seed)?;
    let turned = coupling::<D>(k, 1.7 * seed).map_or(between, |turned| turned.between);
    Some(OneWay { first: first - 0.5 * turned, second, between: turned, back: -between.transpose() })
}

fn lu<const D: usize>(structure: &Arc<Structure<D>>, grains: usize) -> Lu<D> {
    let mut at = vec![0; grains];
    (0..grains).for_each(|grain| at[structure.position()[grain] as usize] = grain);
    let mut lu = Lu::new(Arc::clone(structure)).unwrap();
    lu.renew(|place| masses(at[place]), |k| one_way(k, 0.7)).unwrap();
    lu
}

fn assert_solves_what_is_not_symmetric<const D: usize>() {
    for (columns, rows) in [(1, 1), (2, 1), (9, 1), (5, 4), (13, 11), (40, 35)] {
        let (position, ends) = grid(columns, rows);
        let grains = position.len();
        let mut dense =
            DMatrix::from_diagonal(&DVector::from_fn(D * grains, |k, _| masses::<D>(k / D)[k % D]));
        for (k, (i, j)) in ends.iter().enumerate() {
            let Some(coupling) = one_way::<D>(k, 0.7) else { continue };
            let mut add = |row: u32, column: u32, block: &SMatrix<f64, D, D>| {
                let mut view = dense.fixed_view_mut::<D, D>(D * row as usize, D * column as usize);
                view += block;
            };
            add(*i, *i, &coupling.first);
            if let Some(j) = *j {
                add(j, j, &coupling.second);
                add(*i, j, &coupling.between);
                add(j, *i, &coupling.back);
            }
        }
        let b = DVector::from_fn(D * grains, |k, _| (1.3 * k as f64).cos());
        for order in both_orders(&position, &ends) {
            let structure = Structure::<D>::new(&ends, &order).unwrap();
            let mut at = vec![0; grains];
            (0..grains).for_each(|grain| at[structure.position()[grain] as usize] = grain);
            let lu = lu(&structure, grains);
            let mut x: Vec<_> = at.iter().map(|grain| b.fixed_rows::<D>(D * grain).into_owned()).collect();
            lu.solve(&mut x);
            let x = DVector::from_fn(D * grains, |k, _| x[structure.position()[k / D] as usize][k % D]);
            let left = (&dense * &x - &b).norm() / (dense.norm() * x.norm());
            assert!(left < 1e-13, "{columns}×{rows}: {left}");
        }
    }
}

#[test]
fn factors_l_and_u_solve_what_is_not_symmetric() {
    assert_solves_what_is_not_symmetric::<2>();
    assert_solves_what_is_not_symmetric::<3>();
}

#[test]
fn what_has_no_pivot_has_no_factors() {
    let structure =
        Structure::<2>::new(&[(0, None)], &Order::minimum_degree(1, &[(0, None)]).unwrap()).unwrap();
    let mut lu = Lu::new(structure).unwrap();
    assert!(lu.renew(|_| SVector::zeros(), |_| None).is_err());
    assert!(lu.renew(|_| SVector::repeat(1.0), |_| None).is_ok());
}

#[test]
fn factors_of_any_matrix_solve_what_dense_ones_do() {
    for size in (1..40).chain([150]) {
        // Nothing on the diagonal of the first half, so that rows must be exchanged; some places twice, and one row that couples all.
        let mut entries: Vec<(usize, usize, f64)> = Vec::new();
        for k in 0..size {
            let at = k as f64;
            if 2 * k >= size {
                entries.push((k, k, 2.0 + at.sin()));
            }
            for step in [1, 7] {
                let other = (k + step) % size;
                entries.push((k, other, (3.0 * at).cos() + 1.5));
                entries.push((other, k, (2.0 * at).sin() - 1.2));
            }
            entries.push((size / 3, k, 0.1 * at.cos()));
        }
        let mut dense = DMatrix::zeros(size, size);
        for (row, column, value) in &entries {
            dense[(*row, *column)] += value;
        }
        let factors = General::new(size, entries).unwrap();
        let b = DVector::from_fn(size, |k, _| (0.7 * k as f64).cos());
        let (mut x, mut transposed) = (b.clone(), b.clone());
        factors.solve(x.as_mut_slice());
        factors.solve_transposed(transposed.as_mut_slice());
        for (matrix, x) in [(&dense, x), (&dense.transpose(), transposed)] {
            let left = (matrix * &x - &b).norm();
            assert!(left <= 1e-13 * dense.norm() * x.norm(), "{size} rows: {left:e}");
        }
    }
}

#[test]
fn a_singular_matrix_has_no_factors() {
    let identity = |size: usize| (0..size).map(|k| (k, k, 1.0)).collect::<Vec<_>>();
    for (size, entries) in [(1, vec![(0, 0, 0.0)]), (3, Vec::new()), (4, identity(3)), (9, identity(8))] {
        assert!(General::new(size, entries).is_err(), "{size} rows");
    }
}

#[test]
fn multiply_adds_are_those_of_elimination() {
    let count = |size: usize, is_there: fn(usize, usize) -> bool| {
        let places = (0..size).flat_map(|i| (0..size).map(move |j| (i, j))).filter(|(i, j)| is_there(*i, *j));
        let entries = places.map(|(i, j)| (i, j, if i == j { 4.0 } else { 1.0 / (1 + i + j) as f64 }));
        General::new(size, entries.collect()).unwrap().multiply_adds()
    };
    // Of a full matrix Σ k², of three diagonals one for each pivot but the last.
    assert_eq!(count(7, |_, _| true), (0..7).map(|k| k * k).sum::<u64>());
    assert_eq!(count(7, |i, j| i.abs_diff(j) < 2), 6);
    assert_eq!(count(7, |i, j| i == j), 0);
}
