//! The column of n equal discs, of which everything is known.

use crate::problems::{first_problem, impulses, start};
use active_set::ActiveSet;
use apgd::Apgd;
use cg::{Cg, Preconditioner};
use contact::{Measure, Solver, Truth};
use gradient::Gradient;
use jacobi::Jacobi;
use latin_dd::LatinDd;
use mprgp::Mprgp;
use nncg::Nncg;
use nsgs::Nsgs;
use nsgs_dd::NsgsDd;
use partition::Grid;
use reference::InteriorPoint;
use runner::{Status, Stop, solve};

fn column(n: usize) -> cases::Frozen {
    first_problem("column", &[("sample.grains", &n.to_string())])
}

/// Iterations from a velocity error of 1e-4 to one of 1e-8, in decades. The column is at rest: V* = 0.
pub(crate) fn iterations_per_decade(solver: &dyn Solver, n: usize) -> f64 {
    let frozen = column(n);
    let mut iteration = start(solver, &frozen.problem);
    let mut velocity = vec![nalgebra::Vector2::zeros(); n];
    let rest = vec![nalgebra::Vector2::zeros(); n];
    let scale = frozen.problem.velocity_distance(&rest, frozen.problem.free_velocity());
    let mut passed = [None, None];
    for k in 0.. {
        frozen.problem.velocity(&impulses(&*iteration, &frozen.problem), &mut velocity);
        let error = frozen.problem.velocity_distance(&velocity, &rest) / scale;
        for (passed, level) in passed.iter_mut().zip([1e-4, 1e-8]) {
            if error <= level {
                passed.get_or_insert(f64::from(k));
            }
        }
        if let [Some(from), Some(to)] = passed {
            return (to - from) / 4.0;
        }
        iteration.advance();
    }
    unreachable!("the loop ends by its return")
}

#[test]
fn nsgs_contracts_by_ten_in_0_93_n_squared_sweeps() {
    for n in [10, 20, 40] {
        let sweeps = iterations_per_decade(&Nsgs::default(), n);
        let expected = 0.93 * (n * n) as f64;
        assert!((sweeps / expected - 1.0).abs() < 0.05, "n = {n}: {sweeps} sweeps, {expected} expected");
    }
}

#[test]
fn latin_contracts_by_ten_in_1_47_n_iterations_at_its_best_direction() {
    for n in [10, 20, 40] {
        let best = 2.0 * n as f64 / std::f64::consts::PI;
        let solver = LatinDd { kappa_l: Some(best), relaxation: 1.0, ..LatinDd::default() };
        let iterations = iterations_per_decade(&solver, n);
        let expected = 1.47 * n as f64;
        assert!((iterations / expected - 1.0).abs() < 0.05, "n = {n}: {iterations}, {expected} expected");
    }
}

#[test]
fn conjugate_gradient_ends_in_n_iterations() {
    for n in [10_u64, 20, 40] {
        for preconditioner in [Preconditioner::None, Preconditioner::Diagonal] {
            let frozen = column(n as usize);
            let r0 = frozen.start(false);
            // Round-off in n iterations on a problem of condition n².
            let tolerance = 1e-15 * (n * n * n) as f64;
            let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: 10 * n };
            let outcome =
                solve(&Cg { preconditioner, ..Cg::default() }, &frozen.problem, &r0, &stop, &mut |_| {})
                    .unwrap();
            assert_eq!(outcome.status, Status::Converged);
            assert_eq!(outcome.iterations, n, "{preconditioner:?}");
        }
    }
}

#[test]
fn column_of_discs_carries_its_weight() {
    let n = 12;
    let frozen = column(n);
    let weight = frozen.problem.mass()[0] * 9.81 * frozen.time_step;
    let halves = Grid::of(1, 2);
    for solver in [
        &Nsgs::default() as &dyn Solver,
        &Jacobi::default(),
        &Cg::default(),
        &Gradient::default(),
        &NsgsDd { subdomains: halves, ..NsgsDd::default() },
        &LatinDd { subdomains: halves, ..LatinDd::default() },
        &Apgd::default(),
        &Mprgp::default(),
        &Nncg::default(),
        &ActiveSet::default(),
        &InteriorPoint::default(),
    ] {
        let stop = Stop { tolerance: 1e-11, ..Stop::default() };
        let outcome = solve(solver, &frozen.problem, &frozen.start(false), &stop, &mut |_| {}).unwrap();
        assert_eq!(outcome.status, Status::Converged);
        // Contact k from the floor carries n − k discs; the list is in that order, each disc's lower contact first.
        for (contact, r) in frozen.problem.contacts().iter().zip(&outcome.impulses) {
            let below = contact.antagonist.map_or(0, |j| j.min(contact.candidate) as usize + 1);
            let expected = (n - below) as f64 * weight;
            // r is known to n²/4 times the relative residual, the condition of the column.
            assert!((r / expected - 1.0).abs() < 1e-9, "{r} N·s, {expected} expected");
        }
        assert!(Truth::new(&frozen.problem, &outcome.impulses).velocity().iter().all(|v| v.norm() < 1e-9));
    }
}
