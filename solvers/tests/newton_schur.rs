//! Newton by subdomains: the iterates of the active set, whoever solves with its matrices, and what that costs.

use crate::active_set::distance;
use crate::problems::{PACKINGS, frozen, impulses, start};
use active_set::{ActiveSet, Start};
use contact::{Iteration, Packing, Solver};
use newton_schur::{Interface, NewtonSchur, Preconditioner};
use partition::{Decomposition, Grid, Partition, Scheme};
use reference::certify;

const GRIDS: [Grid; 4] = [Grid::ONE, Grid::of(2, 1), Grid::of(4, 2), Grid::of(8, 8)];

fn method(subdomains: Grid, interface: Interface) -> NewtonSchur {
    NewtonSchur { subdomains, interface, ..NewtonSchur::default() }
}

/// Advances both until both have ended; the greatest distance of two iterates.
fn apart(problem: &Packing, a: &NewtonSchur, b: &dyn Solver) -> f64 {
    let (mut one, mut other) = (start(a, problem), start(b, problem));
    let mut greatest = 0.0_f64;
    for _ in 0..2000 {
        let ended = one.stalled();
        assert_eq!(ended, other.stalled(), "{a:?}");
        if ended {
            return greatest;
        }
        one.advance();
        other.advance();
        let (r, s) = (impulses(&*one, problem), impulses(&*other, problem));
        greatest = greatest.max(distance(problem, &r, &s));
    }
    panic!("{a:?} does not end");
}

/// A solve with K loses the digits of κ to round-off.
#[test]
fn with_a_factor_of_the_interface_iterates_are_those_of_the_active_set() {
    let tolerance = f64::EPSILON * active_set::PENALTY;
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for partition in [Scheme::Boxes, Scheme::Balanced] {
            for grid in GRIDS {
                let settings = NewtonSchur {
                    partition,
                    penalty: active_set::PENALTY,
                    ..method(grid, Interface::Direct)
                };
                let apart =
                    apart(&problem, &settings, &ActiveSet { start: Some(Start::Cg), ..ActiveSet::default() });
                assert!(apart < tolerance, "{name}, {settings:?}: {apart:e}");
            }
        }
    }
}

/// What conjugate gradients leave counts κ times, and solves follow until a hundredth of it is left.
#[test]
fn with_conjugate_gradients_on_the_interface_iterates_are_those_with_its_factor() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for grid in [Grid::ONE, Grid::of(2, 1), Grid::of(4, 2)] {
            for preconditioner in [Preconditioner::None, Preconditioner::NeumannNeumann] {
                let settings =
                    NewtonSchur { preconditioner, inner_accuracy: 1e-9, ..method(grid, Interface::Cg) };
                let apart = apart(&problem, &settings, &method(grid, Interface::Direct));
                assert!(
                    apart < settings.inner_accuracy * settings.penalty,
                    "{name}, {settings:?}: {apart:e}"
                );
            }
        }
    }
}

fn to_its_end(run: &mut dyn Iteration, r: &mut [f64]) {
    for _ in 0..2000 {
        if run.stalled() {
            return run.impulses(r);
        }
        run.advance();
    }
    panic!("it does not end");
}

#[test]
fn newton_by_subdomains_ends_certified_on_every_frozen_problem_without_friction() {
    for name in PACKINGS.into_iter().chain(["settled-60", "settled-250"]) {
        let problem = frozen(name).problem;
        let grids: &[Grid] = if problem.grain_count() < 100 { &GRIDS[..3] } else { &GRIDS };
        for grid in grids {
            for interface in [Interface::Direct, Interface::Cg] {
                let mut r = vec![0.0; problem.contact_count()];
                to_its_end(&mut *start(&method(*grid, interface), &problem), &mut r);
                let certificate = certify(&problem, &r);
                assert!(certificate.certified(), "{name}, {grid}, {interface:?}: {certificate}");
            }
        }
    }
}

/// Whether subdomains go to threads or not.
#[test]
fn newton_by_subdomains_has_the_same_bits_with_any_number_of_threads() {
    let problem = frozen("settled-991").problem;
    for grid in [Grid::of(2, 1), Grid::of(4, 2)] {
        for interface in [Interface::Direct, Interface::Cg] {
            let with = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let (mut run, mut r) =
                        (start(&method(grid, interface), &problem), vec![0.0; problem.contact_count()]);
                    to_its_end(&mut *run, &mut r);
                    (r, run.work(), run.derived())
                })
            };
            let one = with(1);
            assert!(one.1.factorisations > 0);
            assert!(with(4) == one, "{grid}, {interface:?}");
        }
    }
}

/// Each product with W and each solve is an exchange of all copies, each inner iteration one or, with the preconditioner, two; with
/// each factorisation shares by stiffness send their symmetric blocks, and the factor of the interface the triangle of each S_E.
#[test]
fn what_copies_send_is_counted() {
    let problem = frozen("settled-991").problem;
    let grid = Grid::of(4, 2);
    let partition = Partition::of_contacts(&problem, Scheme::Boxes, grid).unwrap();
    let decomposition = Decomposition::new(&problem, &partition);
    let copies = decomposition.copy_count() as u64;
    let triangles: u64 =
        decomposition.subdomains.iter().map(|e| 2 * e.boundary.len() as u64).map(|n| n * (n + 1) / 2).sum();
    // Two translations of each subdomain are an exchange each.
    let coarse = 2 * copies * 2 * 8;
    let cases = [
        (Interface::Direct, Preconditioner::None, false, 8 + 1, 0, triangles),
        (Interface::Cg, Preconditioner::None, false, 8, 1, 0),
        (Interface::Cg, Preconditioner::None, true, 8, 1, 3 * copies + coarse),
        (Interface::Cg, Preconditioner::NeumannNeumann, false, 16, 2, 3 * copies),
        (Interface::Cg, Preconditioner::NeumannNeumann, true, 16, 2, 3 * copies + coarse),
    ];
    for (interface, preconditioner, coarse, factorisations, exchanges, sent) in cases {
        let settings = NewtonSchur { preconditioner, coarse, ..method(grid, interface) };
        let mut run = start(&settings, &problem);
        while run.work().factorisations == 0 {
            run.advance();
        }
        let (before, inner) = (run.work(), run.derived()[0].1);
        assert_eq!(before.factorisations, factorisations);
        run.advance();
        let (after, inner) = (run.work(), (run.derived()[0].1 - inner) as u64);
        assert_eq!(after.factorisations, 2 * factorisations, "another set");
        let solves = after.delassus_products - before.delassus_products;
        let expected = 2 * copies * (2 * solves + exchanges * inner) + sent;
        assert_eq!(after.interface_values - before.interface_values, expected, "{settings:?}");
        assert_eq!(inner > 0, interface == Interface::Cg);
    }
}

#[test]
fn conjugate_gradients_on_the_interface_take_no_more_iterations_than_unknowns() {
    let problem = frozen("shear-box-991-sheared").problem;
    let grid = Grid::of(4, 2);
    let partition = Partition::of_contacts(&problem, Scheme::Boxes, grid).unwrap();
    let unknowns = 2.0 * Decomposition::new(&problem, &partition).boundary.len() as f64;
    let mut run = start(&NewtonSchur { inner_accuracy: 1e-16, ..method(grid, Interface::Cg) }, &problem);
    while run.work().factorisations == 0 {
        run.advance();
    }
    let inner = run.derived()[0].1;
    assert!(inner > 0.0 && inner <= unknowns, "{inner} of {unknowns}");
}

#[test]
fn newton_by_subdomains_refuses_senseless_settings_by_name() {
    let problem = frozen("settled-60").problem;
    let r0 = vec![0.0; problem.contact_count()];
    let refused = |settings: NewtonSchur| match settings.start(&problem, &r0) {
        Ok(_) => panic!("{settings:?} was accepted"),
        Err(error) => error.to_string(),
    };
    for bad in [0.0, -1.0, f64::NAN] {
        assert!(
            refused(NewtonSchur { inner_accuracy: bad, ..NewtonSchur::default() })
                .contains("`inner_accuracy`")
        );
        assert!(refused(NewtonSchur { penalty: bad, ..NewtonSchur::default() }).contains("`penalty`"));
    }
    assert!(refused(method(Grid::of(999, 1), Interface::Cg)).contains("`subdomains`"));
}
