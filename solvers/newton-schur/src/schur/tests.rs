//! Schur complements and solves against dense matrices.

use super::*;
use crate::{Interface, NewtonSchur};
use nalgebra::{DMatrix, DVector, SMatrix, Vector2};
use partition::Grid;
use std::path::Path;

fn problem() -> Packing {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/frozen");
    cases::Frozen::read(&folder.join("settled-60.json")).unwrap().problem
}

/// Every third contact is open; weights of the others differ.
fn coupling(problem: &Packing, k: usize) -> Option<Coupling<2>> {
    let normal = problem.contacts()[k].normal;
    (!k.is_multiple_of(3)).then(|| Coupling::dyad(10.0 + k as f64, normal, -0.7 * normal))
}

/// K, with two rows per grain.
fn dense(problem: &Packing) -> DMatrix<f64> {
    let grains = problem.grain_count();
    let mut k = DMatrix::identity(2 * grains, 2 * grains);
    let mut add = |i: usize, j: usize, block: SMatrix<f64, 2, 2>| {
        let mut at = k.fixed_view_mut::<2, 2>(2 * i, 2 * j);
        at += block;
    };
    for (index, contact) in problem.contacts().iter().enumerate() {
        let Some(coupling) = coupling(problem, index) else { continue };
        let i = contact.candidate as usize;
        add(i, i, coupling.first);
        if let Some(j) = contact.antagonist {
            let j = j as usize;
            add(j, j, coupling.second);
            add(i, j, coupling.between);
            add(j, i, coupling.between.transpose());
        }
    }
    k
}

fn schur(problem: &Packing, settings: NewtonSchur) -> Schur {
    let mut schur = Schur::new(&settings, problem).unwrap();
    assert!(schur.factorise(|k| coupling(problem, k)));
    schur
}

const GRIDS: [Grid; 4] = [Grid::ONE, Grid::of(2, 1), Grid::of(3, 2), Grid::of(6, 6)];

fn assert_close(a: &DMatrix<f64>, b: &DMatrix<f64>, what: &str) {
    let distance = (a - b).amax() / b.amax();
    assert!(distance < 1e-13, "{what}: {distance:e}");
}

#[test]
fn schur_complements_of_subdomains_add_up_to_that_of_the_whole() {
    let problem = problem();
    let k = dense(&problem);
    for subdomains in GRIDS {
        let mut schur = schur(&problem, NewtonSchur { subdomains, ..NewtonSchur::default() });
        let count = schur.boundary.len();
        let mut sum = DMatrix::zeros(2 * count, 2 * count);
        for subdomain in &mut schur.subdomains.own {
            let blocks = subdomain.assembled();
            for (column, j) in subdomain.boundary.iter().enumerate() {
                for (row, i) in subdomain.boundary.iter().enumerate() {
                    let block = blocks[column * subdomain.boundary.len() + row];
                    let mut at = sum.fixed_view_mut::<2, 2>(2 * *i as usize, 2 * *j as usize);
                    at += block;
                }
            }
        }
        if count == 0 {
            assert_eq!(subdomains, Grid::ONE);
            continue;
        }
        // The Schur complement is the inverse of the boundary's part of K⁻¹.
        let inverse = k.clone().try_inverse().unwrap();
        let rows: Vec<usize> =
            schur.boundary.iter().flat_map(|i| [2 * *i as usize, 2 * *i as usize + 1]).collect();
        let expected = inverse.select_rows(&rows).select_columns(&rows).try_inverse().unwrap();
        assert_close(&sum, &expected, &subdomains.to_string());
    }
}

#[test]
fn solves_by_subdomains_are_those_of_the_whole() {
    let problem = problem();
    let factor = dense(&problem).cholesky().unwrap();
    let given: Vec<_> =
        (0..problem.grain_count()).map(|i| Vector2::new((i as f64).sin(), (3.0 * i as f64).cos())).collect();
    let expected =
        factor.solve(&DVector::from_iterator(2 * given.len(), given.iter().flat_map(|x| [x.x, x.y])));
    for subdomains in GRIDS {
        for interface in [Interface::Direct, Interface::Cg] {
            for (preconditioner, coarse) in [
                (Preconditioner::None, false),
                (Preconditioner::None, true),
                (Preconditioner::NeumannNeumann, false),
                (Preconditioner::NeumannNeumann, true),
            ] {
                let inner_accuracy = 1e-14;
                let settings = NewtonSchur {
                    subdomains,
                    interface,
                    preconditioner,
                    coarse,
                    inner_accuracy,
                    penalty: 1.0,
                    ..NewtonSchur::default()
                };
                let (mut schur, mut x) = (schur(&problem, settings), given.clone());
                schur.solve(&mut x);
                let x = DVector::from_iterator(2 * x.len(), x.iter().flat_map(|x| [x.x, x.y]));
                let distance = (x - &expected).amax() / expected.amax();
                assert!(distance < 1e-13, "{settings:?}: {distance:e}");
                // With the directions of the first, the same solve needs no further one.
                let before = schur.inner_iterations();
                schur.solve(&mut given.clone());
                assert!(schur.inner_iterations() - before <= 1, "{settings:?}");
            }
        }
    }
}

#[test]
fn parts_of_a_boundary_grain_add_up_to_one() {
    let problem = problem();
    let schur = schur(&problem, NewtonSchur { subdomains: Grid::of(3, 2), ..NewtonSchur::default() });
    let mut sums = vec![SMatrix::<f64, 2, 2>::zeros(); schur.boundary.len()];
    for subdomain in &schur.subdomains.own {
        for (k, weight) in subdomain.boundary.iter().zip(&subdomain.weight) {
            sums[*k as usize] += weight;
        }
    }
    assert!(!sums.is_empty());
    assert!(sums.iter().all(|sum| (sum - SMatrix::identity()).amax() < 1e-13));
}
