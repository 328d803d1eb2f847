//! The reference against exact solutions, brute force and the other methods; its certificates.

use crate::problems::{PACKINGS, any_contact, first_problem, frozen};
use analysis::Meter;
use analysis::proves_infeasible;
use cg::Cg;
use contact::{Contact, Measure, Packing, Solver, Truth};
use nalgebra::{DMatrix, DVector, Vector2};
use nsgs::Nsgs;
use proptest::prelude::*;
use reference::{Answer, Certificate, InteriorPoint, certify};
use runner::{Measured, Status, Stop, solve_against};
use std::ops::ControlFlow;

fn certified(problem: &Packing) -> (Vec<f64>, Certificate) {
    match reference::solve(problem) {
        Answer::Solution { impulses, certificate } => (impulses, certificate),
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_frozen_problem_has_a_certificate() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        let (r, certificate) = certified(&problem);
        assert!(certificate.certified() && certificate.worst() <= 1e-12, "{name}: {certificate}");
        assert_eq!(certificate, certify(&problem, &r), "the certificate is that of the impulses");
        // The same, told by the measures of the loop.
        let measures = Meter::new(&problem).measure(&r, 0.0);
        assert!(measures.natural_map <= 1e-12, "{name}: {:e}", measures.natural_map);
    }
}

#[test]
fn reference_of_a_column_carries_its_weight() {
    for n in [1, 2, 12, 100] {
        let frozen = first_problem("column", &[("sample.grains", &n.to_string())]);
        let weight = frozen.problem.mass()[0] * 9.81 * frozen.time_step;
        let (r, _) = certified(&frozen.problem);
        for (contact, r) in frozen.problem.contacts().iter().zip(&r) {
            let below = contact.antagonist.map_or(0, |j| j.min(contact.candidate) as usize + 1);
            let expected = (n - below) as f64 * weight;
            // The condition of the column is n², and the residual some n units of round-off.
            assert!((r / expected - 1.0).abs() < 1e-12 * n as f64, "{n} discs: {r} N·s of {expected}");
        }
    }
}

/// More contacts than equilibrium needs: the active set alone is singular.
#[test]
fn reference_of_a_crystal_is_at_rest_on_its_floor() {
    let frozen = first_problem("triangular", &[]);
    let problem = &frozen.problem;
    let (r, _) = certified(problem);
    let truth = Truth::new(problem, &r);
    // Gaps are a few 1e-15 m by rounding, and c is the gap over a time step of 5e-3 s.
    let fastest = truth.velocity().iter().map(Vector2::norm).fold(0.0, f64::max);
    assert!(fastest < 1e-12, "{fastest:e} m/s");
    let is_floor = |contact: &Contact| contact.antagonist.is_none() && contact.normal.y > 0.5;
    let floor = problem.contacts().iter().zip(&r).filter(|(contact, _)| is_floor(contact));
    let weight = problem.mass().iter().sum::<f64>() * 9.81 * frozen.time_step;
    let carried = floor.map(|(_, r)| r).sum::<f64>();
    // What moves at 1e-12 m/s, of the 0.05 m/s that the floor stops, is not carried.
    assert!((carried / weight - 1.0).abs() < 1e-10, "{carried} N·s of {weight}");
}

#[test]
fn corrupted_impulses_have_no_certificate() {
    let problem = frozen("shear-box-991-sheared").problem;
    let (r, _) = certified(&problem);
    let strongest = (0..r.len()).max_by(|a, b| r[*a].total_cmp(&r[*b])).unwrap();
    let idle = (0..r.len()).find(|k| r[*k] == 0.0).unwrap();
    let corrupted = |contact: usize, value: f64| {
        let mut r = r.clone();
        r[contact] = value;
        certify(&problem, &r)
    };
    assert!(corrupted(strongest, r[strongest]).certified());
    for value in [r[strongest] * (1.0 + 1e-9), r[strongest] * (1.0 - 1e-9), 0.0, f64::NAN, f64::INFINITY] {
        assert!(!corrupted(strongest, value).certified(), "{value}");
    }
    for value in [1e-9 * r[strongest], -1e-9 * r[strongest], f64::NAN] {
        assert!(!corrupted(idle, value).certified(), "{value}");
    }
    assert!(corrupted(idle, -1.0).pull.absolute == 1.0);
}

/// q* = −½ ‖V* − `V_free`‖²_M, so q(r) − q* = ½ ‖V − V*‖²_M + rᵗ v*: the gap is no less than the error squared.
#[test]
fn methods_run_to_round_off_reach_the_velocity_of_the_reference() {
    for name in ["shear-box-991-rest", "shear-box-991-onset", "shear-box-991-sheared"] {
        let problem = frozen(name).problem;
        let truth = Truth::new(&problem, &certified(&problem).0);
        let methods: [(&str, &dyn Solver, f64); 3] = [
            ("cg", &Cg::default(), 1e-13),
            ("cg, preconditioned", &Cg::preconditioned(), 1e-13),
            ("nsgs", &Nsgs::default(), 1e-12),
        ];
        // Non-linear Gauss-Seidel needs more than 200,000 sweeps at rest.
        let methods = if name.ends_with("sheared") { &methods[..] } else { &methods[..2] };
        for &(method, solver, tolerance) in methods {
            let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: 200_000 };
            let r0 = vec![0.0; problem.contact_count()];
            let mut least_gap = f64::INFINITY;
            let outcome =
                solve_against(Some(&truth), solver, &problem, &r0, &stop, Measured::Every, &mut |progress| {
                    let measures = progress.measures.unwrap();
                    least_gap = least_gap.min(measures.energy_gap - measures.velocity_error.powi(2));
                    ControlFlow::Continue(())
                });
            let outcome = outcome.unwrap();
            assert_eq!(outcome.status, Status::Converged, "{name}, {method}");
            let error = outcome.measures.velocity_error;
            assert!(error < 1e-9, "{name}, {method}: {error:e}");
            assert!(least_gap > -1e-12, "{name}, {method}: {least_gap:e}");
        }
    }
}

#[test]
fn interior_point_ends_in_its_first_iteration_and_its_polish_at_round_off() {
    let problem = frozen("shear-box-991-onset").problem;
    let truth = Truth::new(&problem, &certified(&problem).0);
    let run = |polish| {
        let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-13, max_iterations: 6 };
        let r0 = vec![0.0; problem.contact_count()];
        let solver = InteriorPoint { polish };
        let mut errors = Vec::new();
        let outcome =
            solve_against(Some(&truth), &solver, &problem, &r0, &stop, Measured::Every, &mut |progress| {
                errors.push((progress.measures.unwrap().velocity_error, progress.work.factorisations));
                ControlFlow::Continue(())
            });
        (outcome.unwrap(), errors)
    };
    let (polished, errors) = run(true);
    assert_eq!(polished.status, Status::Converged);
    assert!(errors[1].0 < 1e-3, "{errors:?}");
    assert!(errors[2..].windows(2).all(|pair| pair[1].1 == pair[0].1 + 1), "one factorisation each");
    let (raw, errors) = run(false);
    assert_eq!((raw.status, errors.len()), (Status::Stalled, 2), "its whole run is its first iteration");
    assert_eq!(errors[1].0, raw.measures.velocity_error);
}

/// Up to 4 grains and 7 contacts, of which some have no solution.
fn small_problem() -> impl Strategy<Value = Packing> {
    let vector = |size: f64| (-size..size, -size..size).prop_map(|(x, y)| Vector2::new(x, y));
    (1..5_u32, 1..8_usize).prop_flat_map(move |(grains, contacts)| {
        let n = grains as usize;
        let contact = any_contact(grains);
        let masses = prop::collection::vec(0.1..10.0_f64, n);
        let velocities = prop::collection::vec(vector(1.0), n);
        (masses, velocities, prop::collection::vec(contact, contacts)).prop_map(
            |(masses, velocities, contacts)| {
                let position = vec![Vector2::zeros(); masses.len()];
                Packing::new(masses, position, velocities, contacts).unwrap()
            },
        )
    })
}

/// The impulses that solve (2) with some set of contacts closed, found by trying every set. A solution with independent
/// rows of Hᵗ exists wherever there is one.
fn brute_force(problem: &Packing) -> Option<Vec<f64>> {
    let n = problem.contact_count();
    let mut w = DMatrix::zeros(n, n);
    let mut scratch = vec![Vector2::zeros(); problem.grain_count()];
    for k in 0..n {
        let mut unit = vec![0.0; n];
        unit[k] = 1.0;
        problem.delassus_product(&unit, w.column_mut(k).as_mut_slice(), &mut scratch);
    }
    let b = DVector::from_vec(problem.b());
    (0..1_u32 << n).find_map(|set| {
        let closed: Vec<usize> = (0..n).filter(|k| set >> k & 1 == 1).collect();
        let factor = w.select_rows(&closed).select_columns(&closed).cholesky()?;
        let solved = factor.solve(&-b.select_rows(&closed));
        let mut r = DVector::zeros(n);
        closed.iter().zip(solved.iter()).for_each(|(k, value)| r[*k] = *value);
        let v = &w * &r + &b;
        let solves = closed.iter().all(|k| v[*k].abs() < 1e-10) && r.min() >= 0.0 && v.min() > -1e-10;
        solves.then(|| r.as_slice().to_vec())
    })
}

proptest! {
    // An unknown answer is drawn again: an honest one, but a rare one.
    #![proptest_config(ProptestConfig { max_global_rejects: 8, ..ProptestConfig::default() })]

    #[test]
    fn reference_is_the_solution_that_trying_every_active_set_finds(problem in small_problem()) {
        match (reference::solve(&problem), brute_force(&problem)) {
            (Answer::Solution { impulses, certificate }, Some(r)) => {
                prop_assert!(certificate.certified());
                let (truth, found) = (Truth::new(&problem, &impulses), Truth::new(&problem, &r));
                let distance = problem.velocity_distance(truth.velocity(), found.velocity());
                let scale = problem.velocity_distance(found.velocity(), problem.free_velocity());
                // ‖V − U‖²_M ≤ 1e-10 times the impulses, see `agreement`.
                let allowed = 1e-5 * (1.0 + r.iter().chain(&impulses).sum::<f64>()).sqrt();
                prop_assert!(distance <= allowed, "{distance:e} of {scale:e}");
            }
            // Two contacts may be so nearly opposite that their impulses drown the certificate in round-off, or that nothing
            // tells a solution far away from none.
            (Answer::Unknown { certificate, .. }, _) => {
                prop_assert!(!certificate.certified());
                return Err(TestCaseError::reject("neither a solution nor a proof that there is none"));
            }
            (Answer::Infeasible { ray }, None) => prop_assert!(proves_infeasible(&problem, &ray)),
            (answer, found) => prop_assert!(false, "{answer:?} where trying finds {found:?}"),
        }
    }
}
