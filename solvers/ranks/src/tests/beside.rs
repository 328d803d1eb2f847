//! Data of ranks beside a problem, in parts: impulses to begin from, and solutions.

use super::{GRID, SIZES, bits, close, discs, on_ranks_beside, rough};
use crate::{simulated, whole};
use analysis::Bounded;
use cg::Cg;
use contact::{Discs, Measure, Measures, Mechanics, Packing, RoughDiscs, Truth};
use latin_dd::LatinDd;
use nsgs_dd::{Exchange, NsgsDd};
use partition::{Decomposition, Distributed, Partition, Scheme, Share, Team};
use reference::{Answer, solve_rough};
use runner::{Beside, Measured, Status, Stop, solve, solve_against};
use std::ops::ControlFlow;

const FEW: Stop = Stop { on: Measure::NaturalMap, tolerance: 0.0, max_iterations: 45 };

/// An iterate that presses at many contacts.
fn iterate<M: Mechanics>(problem: &Packing<M>, solver: &dyn Distributed<M>) -> Vec<f64> {
    let stop = Stop { max_iterations: 20, ..FEW };
    solve(solver, problem, &vec![0.0; problem.impulse_count()], &stop, &mut |_| {}).unwrap().impulses
}

fn begin_alike<M: Mechanics + Bounded>(problem: &Packing<M>, solver: &dyn Distributed<M>, name: &str) {
    let start = iterate(problem, solver);
    let alone = solve(solver, problem, &start, &FEW, &mut |_| {}).unwrap();
    let beside = Beside { start: &start, solutions: &[] };
    for size in SIZES {
        let end = on_ranks_beside(problem, solver, (GRID, size), beside, &FEW).unwrap().outcome;
        assert!(end.impulses == alone.impulses, "{name}, {size} ranks: other bits than on one machine");
    }
}

#[test]
fn a_start_in_parts_gives_the_bits_of_one_machine() {
    let nsgs = NsgsDd { subdomains: GRID, ..NsgsDd::default() };
    let turns = NsgsDd { exchange: Exchange::GaussSeidel, ..nsgs };
    let schwarz = NsgsDd { mass_splitting: false, relaxation: 0.5, ..nsgs };
    let latin = LatinDd { subdomains: GRID, ..LatinDd::default() };
    let coarse = LatinDd { coarse: true, ..latin };
    let (smooth, rough) = (discs("shear-box-991-sheared"), rough("rough-991-mu08"));
    for (name, solver) in [("jacobi", &nsgs), ("gauss-seidel", &turns), ("schwarz", &schwarz)] {
        begin_alike::<Discs>(&smooth, solver, name);
        begin_alike::<RoughDiscs>(&rough, solver, name);
    }
    for (name, solver) in [("latin", &latin), ("coarse", &coarse)] {
        begin_alike::<Discs>(&smooth, solver, name);
        begin_alike::<RoughDiscs>(&rough, solver, name);
    }
}

/// On one machine its blocks are others, so one rank is the measure.
#[test]
fn conjugate_gradients_begin_alike_on_any_number_of_ranks() {
    let problem = discs("shear-box-991-sheared");
    let start = iterate::<Discs>(&problem, &Cg::default());
    let beside = Beside { start: &start, solutions: &[] };
    let on = |size| {
        on_ranks_beside::<Discs>(&problem, &Cg::default(), (GRID, size), beside, &FEW).unwrap().outcome
    };
    let first = on(1);
    for size in SIZES {
        assert!(on(size).impulses == first.impulses, "{size} ranks");
    }
    // From where it was, not from r = 0.
    let alone = solve::<Discs>(&Cg::default(), &problem, &start, &FEW, &mut |_| {}).unwrap();
    assert!(close_to(first.measures.energy, alone.measures.energy, 1e-6));
}

fn close_to(found: f64, expected: f64, tolerance: f64) -> bool {
    (found - expected).abs() <= tolerance * expected.abs()
}

#[test]
fn velocities_are_added_up_in_the_order_of_the_whole() {
    let problem = rough("rough-991-mu08");
    let r = iterate::<RoughDiscs>(&problem, &NsgsDd::default());
    let mut expected = problem.free_velocity().to_vec();
    problem.velocity(&r, &mut expected);
    let decomposition =
        Decomposition::new(&problem, &Partition::of_contacts(&problem, Scheme::Boxes, GRID).unwrap());
    let whole = whole(&problem, GRID, Scheme::Boxes);
    for size in SIZES {
        let found = simulated(size, |post| {
            let team = Team::new(post, 8).unwrap();
            let share = Share::of_rank(&problem, &decomposition, &team, whole).unwrap();
            let own: Vec<f64> =
                share.contacts.iter().flat_map(|k| [r[2 * *k as usize], r[2 * *k as usize + 1]]).collect();
            (share.velocity(&own, &team), share.grains)
        });
        for (velocity, grains) in found {
            assert!(grains.iter().zip(velocity).all(|(grain, v)| v == expected[*grain as usize]), "{size}");
        }
    }
}

/// The errors of the last iterate on each number of ranks beside those of one machine.
fn errors_alike<M: Mechanics + Bounded>(
    problem: &Packing<M>,
    solver: &dyn Distributed<M>,
    solutions: &[Vec<f64>],
    stop: &Stop,
) -> Measures {
    let truths: Vec<Truth<M>> = solutions.iter().map(|r| Truth::new(problem, r)).collect();
    let start = vec![0.0; problem.impulse_count()];
    let go_on = &mut |_: &runner::Progress| ControlFlow::Continue(());
    let alone = solve_against(&truths, solver, problem, &start, stop, Measured::Needed, go_on).unwrap();
    let beside = Beside { start: &start, solutions };
    let on = |size| on_ranks_beside(problem, solver, (GRID, size), beside, stop).unwrap().outcome;
    let first = on(1);
    for size in SIZES {
        let end = on(size);
        assert_eq!((end.status, end.iterations), (alone.status, alone.iterations), "{size} ranks");
        assert_eq!(bits(&end.measures), bits(&first.measures), "{size} ranks");
    }
    let (found, expected) = (first.measures, alone.measures);
    assert!(close(found.velocity_error, expected.velocity_error), "{found:?} instead of {expected:?}");
    assert_eq!(found.energy_gap.is_nan(), expected.energy_gap.is_nan());
    assert!(found.energy_gap.is_nan() || close_to(found.energy_gap, expected.energy_gap, 1e-8));
    found
}

#[test]
fn errors_are_those_of_one_machine_but_for_round_off() {
    let problem = discs("settled-250");
    let Answer::Solution { impulses, .. } = reference::solve(&problem) else { panic!("no solution") };
    let solutions = [impulses];
    let nsgs = NsgsDd { subdomains: GRID, ..NsgsDd::default() };
    let latin = LatinDd { subdomains: GRID, ..LatinDd::default() };
    let on_the_error = Stop { on: Measure::VelocityError, tolerance: 0.1, max_iterations: 10_000 };
    for solver in [&nsgs as &dyn Distributed<Discs>, &latin] {
        let measures = errors_alike(&problem, solver, &solutions, &FEW);
        assert!(measures.velocity_error > 1e-3 && measures.energy_gap > 0.0, "{measures:?}");
        let measures = errors_alike(&problem, solver, &solutions, &on_the_error);
        assert!(measures.velocity_error <= 0.1, "{measures:?}");
    }
}

/// Checks that of two solutions with different velocities each is the nearest of runs that begin there.
#[test]
fn with_friction_the_error_is_that_of_the_nearest_solution() {
    let problem = rough("rough-991-mu08");
    let pool = solve_rough(&problem, 0..=3, || {});
    let solutions: Vec<Vec<f64>> = pool
        .into_iter()
        .filter(|solution| solution.certificate.certified())
        .map(|solution| solution.impulses)
        .collect();
    assert!(solutions.len() > 1, "{} solutions", solutions.len());
    let nsgs = NsgsDd { subdomains: GRID, ..NsgsDd::default() };
    errors_alike::<RoughDiscs>(&problem, &nsgs, &solutions, &FEW);
    let stop = Stop { max_iterations: 0, ..FEW };
    for (k, start) in solutions.iter().enumerate() {
        let error = |solutions| {
            let beside = Beside { start, solutions };
            let end =
                on_ranks_beside::<RoughDiscs>(&problem, &nsgs, (GRID, 3), beside, &stop).unwrap().outcome;
            end.measures.velocity_error
        };
        assert!(error(&solutions) < 1e-9, "{:e}", error(&solutions));
        let others = [&solutions[..k], &solutions[k + 1..]].concat();
        assert!(error(&others) > 1e-6, "{:e}", error(&others));
    }
}

#[test]
fn what_is_no_solution_or_no_start_is_refused_at_all_ranks() {
    let problem = discs("settled-60");
    let nsgs = NsgsDd { subdomains: GRID, ..NsgsDd::default() };
    let start = vec![0.0; problem.contact_count()];
    let refused = |start: &[f64], solutions: &[Vec<f64>], stop| {
        let beside = Beside { start, solutions };
        on_ranks_beside::<Discs>(&problem, &nsgs, (GRID, 4), beside, &stop).unwrap_err()
    };
    let reason = refused(&start, std::slice::from_ref(&start), FEW);
    assert!(reason.starts_with("`solution` is number 0, which leaves"), "{reason}");
    let reason = refused(&start, &[], Stop { on: Measure::VelocityError, ..FEW });
    assert!(reason.starts_with("`on` is velocity_error"), "{reason}");
    let mut pulls = start.clone();
    pulls[problem.contact_count() - 1] = -1.0;
    refused(&pulls, &[], FEW);
    let none = Stop { max_iterations: 0, ..FEW };
    let beside = Beside { start: &start, solutions: &[] };
    let end = on_ranks_beside::<Discs>(&problem, &nsgs, (GRID, 4), beside, &none).unwrap().outcome;
    assert!(end.status == Status::IterationLimit && end.measures.velocity_error.is_nan());
}
