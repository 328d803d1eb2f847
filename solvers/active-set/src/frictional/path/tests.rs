//! Properties of paths by their theory, and changes of the matrix.

use super::super::matrix::Matrix;
use super::{Change, Path};
use crate::layout::{Drawn, Layout, distance, norm};
use contact::law::admissible;
use contact::status::Status;
use contact::{Cone, Packing, RoughContact, RoughMass, Visited};
use nalgebra::{Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Discs of any mass and velocity, each with contacts to the two after it and to a wall: more than motion allows.
fn packing(seed: u64, grains: u32) -> Packing<contact::RoughDiscs> {
    let mut numbers = ChaCha8Rng::seed_from_u64(seed);
    let mut contacts = Vec::new();
    for i in 0..grains {
        let others = [Some(i + 1), Some(i + 2), None].map(|j| j.filter(|j| *j < grains));
        for antagonist in others {
            let angle = std::f64::consts::TAU * numbers.random::<f64>();
            contacts.push(RoughContact {
                candidate: i,
                antagonist,
                normal: Vector2::new(angle.cos(), angle.sin()),
                arms: Vector2::new(0.5, if antagonist.is_some() { 0.4 } else { 0.0 }),
                offset: Vector2::new(0.1 * numbers.random::<f64>(), 0.1 * (numbers.random::<f64>() - 0.5)),
                friction: numbers.random::<f64>(),
            });
        }
    }
    let mass = (0..grains).map(|_| {
        let mass = 0.2 + numbers.random::<f64>();
        RoughMass { mass, inertia: 0.125 * mass }
    });
    let mass: Vec<_> = mass.collect();
    let mut component = || 2.0 * numbers.random::<f64>() - 1.0;
    let free = (0..grains).map(|_| Vector3::new(component(), component(), component())).collect();
    let position = (0..grains).map(|i| Vector2::new(f64::from(i), 0.5)).collect();
    Packing::new(mass, position, free, contacts).unwrap()
}

/// From where all contacts are pushed open, which has no other solution, the path can only end at a solution: it stays within bounds
/// for any ε > 0, and does not come back.
#[test]
fn a_path_from_open_contacts_ends_at_a_solution_of_coulombs_law() {
    for seed in 0..200 {
        let problem = packing(seed, 3 + (seed % 6) as u32);
        let layout = Layout::new(&problem);
        let mut matrix = Matrix::new(&layout).unwrap();
        let none = vec![Vector2::zeros(); layout.columns.len()];
        let b = layout.velocity(&none);
        let open = |(b, column): (&Vector2<f64>, &contact::RoughColumn)| {
            Vector2::new(b.x.abs() + column.friction() * b.y.abs() + 0.1, 0.0)
        };
        let perturbation: Vec<_> = b.iter().zip(&layout.columns).map(open).collect();
        for epsilon in [1e-1, 1e-4] {
            let drawn = Drawn { epsilon, centre: Some(&none) };
            let change = Change { layout: &layout, drawn, perturbation: &perturbation };
            let status = vec![Status::Open; none.len()];
            let mut path = Path { change, matrix: &mut matrix, status, s: none.clone() };
            path.follow().unwrap_or_else(|| panic!("seed {seed}, ε {epsilon}"));
            assert!(norm(&path.s) > 0.0, "seed {seed}: the packing would fly apart");
            let left = layout.left(&path.s, &change.velocity(&path.s, 0.0));
            assert!(left < 1e-10, "seed {seed}, ε {epsilon}: {left}");
            for (s, column) in path.s.iter().zip(&layout.columns) {
                assert!((s - admissible(*s, column.friction())).norm() < 1e-10, "seed {seed}: {s}");
            }
        }
    }
}

#[test]
fn a_matrix_that_followed_changes_solves_and_responds_as_one_made_anew() {
    let layout = Layout::new(&packing(7, 8));
    let columns = &layout.columns;
    let epsilon = 1e-3;
    let p: Vec<_> = (0..columns.len()).map(|k| Vector2::new(1.0 - 0.1 * k as f64, 0.3)).collect();
    let own = |ds: &[Vector2<f64>]| -> Vec<_> {
        let y = layout.pushed(vec![Vector3::zeros(); layout.grains()], ds);
        columns.iter().zip(&p).map(|(column, p)| column.relative(&y) + p).collect()
    };
    let respond = |matrix: &mut Matrix<2, 3>| {
        let mut ds = vec![Vector2::zeros(); columns.len()];
        let velocity = |ds: &[Vector2<f64>]| own(ds).iter().zip(ds).map(|(v, ds)| v + epsilon * ds).collect();
        matrix.settle(columns, &mut ds, velocity, |_, _, _| false);
        ds
    };
    let mut status = vec![Status::Stick; columns.len()];
    let mut followed = Matrix::new(&layout).unwrap();
    assert!(followed.factorise(columns, &status, epsilon));
    let mut ds = respond(&mut followed);
    let changes = [
        (3, Status::slide(1.0)),
        (5, Status::slide(-1.0)),
        (3, Status::Open),
        (11, Status::slide(1.0)),
        (3, Status::slide(-1.0)),
        (5, Status::Stick),
    ];
    for (contact, next) in changes {
        status[contact] = next;
        let v = own(&ds)[contact];
        assert!(followed.change(columns, contact, next, v, &mut ds));
    }
    let mut anew = Matrix::new(&layout).unwrap();
    assert!(anew.factorise(columns, &status, epsilon));
    let mut x: Vec<_> = (0..layout.grains()).map(|k| Vector3::new(1.0, k as f64, -0.5)).collect();
    let mut y = x.clone();
    followed.solve(columns, &mut x);
    anew.solve(columns, &mut y);
    let apart = x.iter().zip(&y).map(|(x, y)| (x - y).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart}");
    let expected = respond(&mut anew);
    assert!(distance(&ds, &expected) < 1e-9 * norm(&expected), "{}", distance(&ds, &expected));
    // From stick to open leads no product of one column: it is then the matrix of nothing.
    assert!(followed.is_of(&status, epsilon));
    let v = own(&ds)[0];
    assert!(!followed.change(columns, 0, Status::Open, v, &mut ds) && !followed.is_of(&status, epsilon));
}
