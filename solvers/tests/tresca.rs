//! Tresca's law, the convex neighbour of Coulomb's: what is proved where there is a minimum holds with friction there.

use crate::friction::{given, given_solution, rough};
use crate::problems::assert_never_increases;
use contact::{Measure, Measuring, Packing, RoughMeter, Solver, TrescaDiscs, Truth};
use nsgs::Nsgs;
use nsgs_dd::{Exchange, NsgsDd};
use partition::Grid;

/// The problem whose bounds are those of a few sweeps with Coulomb's law.
fn packing() -> Packing<TrescaDiscs> {
    let problem = rough("rough-250").problem;
    let mut sweeps = Nsgs::default().start(&problem, &vec![0.0; problem.impulse_count()]).unwrap();
    let mut r = vec![0.0; problem.impulse_count()];
    (0..30).for_each(|_| sweeps.advance());
    sweeps.impulses(&mut r);
    problem.with_bounds_of(&r).unwrap()
}

/// The energies of so many iterations from r = 0, and the last impulses with their natural map.
fn run(solver: &NsgsDd, problem: &Packing<TrescaDiscs>, iterations: u64) -> (Vec<f64>, Vec<f64>, f64) {
    let mut r = vec![0.0; problem.impulse_count()];
    let (mut run, mut meter) = (solver.start(problem, &r).unwrap(), RoughMeter::new(problem));
    let (mut energies, mut natural_map) = (vec![0.0], f64::NAN);
    for _ in 0..iterations {
        run.advance();
        run.impulses(&mut r);
        let measures = meter.measure_after(&[], &r, 0.0);
        energies.push(measures.energy);
        natural_map = measures.get(Measure::NaturalMap);
    }
    (energies, r, natural_map)
}

#[test]
fn split_masses_never_increase_the_energy() {
    let problem = packing();
    assert!(problem.contacts().iter().filter(|contact| contact.bound > 0.0).count() > 200);
    for (subdomains, inner_sweeps, exchange) in [
        (Grid::ONE, 1, Exchange::Jacobi),
        (Grid::of(2, 1), 1, Exchange::Jacobi),
        (Grid::of(4, 2), 1, Exchange::Jacobi),
        (Grid::of(4, 2), 5, Exchange::Jacobi),
        (Grid::of(4, 2), 2, Exchange::GaussSeidel),
        (Grid::of(8, 8), 1, Exchange::Jacobi),
    ] {
        for relaxation in [0.7, 1.0, 1.7] {
            let settings = NsgsDd { subdomains, inner_sweeps, exchange, relaxation, ..NsgsDd::default() };
            let (energies, _, _) = run(&settings, &problem, 60);
            assert!(energies[60] < 0.0);
            assert_never_increases(&energies, &format!("{settings:?}"));
        }
    }
}

#[test]
fn whole_masses_are_not_bound_to_it() {
    let problem = packing();
    let schwarz = NsgsDd { subdomains: Grid::of(8, 8), mass_splitting: false, ..NsgsDd::default() };
    let (energies, _, _) = run(&schwarz, &problem, 60);
    assert!(energies.windows(2).any(|pair| pair[1] > pair[0] + 1e-9 * pair[0].abs()));
}

#[test]
fn all_subdomains_end_at_one_velocity() {
    let problem = packing();
    let ends = [Grid::ONE, Grid::of(4, 2)].map(|subdomains| {
        let (_, r, natural_map) =
            run(&NsgsDd { subdomains, relaxation: 1.7, ..NsgsDd::default() }, &problem, 20_000);
        assert!(natural_map < 1e-5, "{subdomains}: {natural_map:e}");
        Truth::new(&problem, &r)
    });
    let apart = problem.velocity_distance(ends[0].velocity(), ends[1].velocity());
    let moved = problem.velocity_distance(ends[0].velocity(), problem.free_velocity());
    assert!(apart < 1e-3 * moved, "{apart:e} of {moved:e}");
}

#[test]
fn solution_of_coulomb_solves_it_with_its_own_bounds() {
    let (problem, r) = (rough("rough-991-mu08").problem, given(&given_solution()));
    let problem = problem.with_bounds_of(&r).unwrap();
    let measures = RoughMeter::new(&problem).measure_after(&[], &r, 0.0);
    assert!(measures.natural_map < 1e-12, "{:e}", measures.natural_map);
}
