//! Where methods fail, and how fast they are, as their spectra predict it.

use crate::problems::{
    any_problem, assert_never_increases, energies, first_problem, frozen, impulses, start,
};
use analysis::Spectrum;
use analysis::{coupling, greatest_eigenvalue};
use cg::Cg;
use contact::{Contact, Packing, Solver};
use jacobi::Jacobi;
use latin_dd::LatinDd;
use nsgs::Nsgs;
use nsgs_dd::NsgsDd;
use partition::{Decomposition, Grid, Partition, Scheme};
use proptest::prelude::*;
use reference::Answer;
use runner::{Status, Stop, solve};

fn solution(problem: &Packing) -> Vec<f64> {
    match reference::solve(problem) {
        Answer::Solution { impulses, .. } => impulses,
        _ => panic!("the problem has a solution"),
    }
}

/// The contacts of `problem` that carry more than a millionth of the greatest impulse.
fn carrying(problem: &Packing, r: &[f64]) -> Packing {
    let greatest = r.iter().copied().fold(0.0, f64::max);
    let carry = problem.contacts().iter().zip(r).filter(|(_, r)| **r > 1e-6 * greatest);
    let contacts: Vec<Contact> = carry.map(|(contact, _)| *contact).collect();
    let (mass, position) = (problem.mass().to_vec(), problem.position().to_vec());
    Packing::new(mass, position, problem.free_velocity().to_vec(), contacts).unwrap()
}

/// ‖V(r) − V(s)‖_M of two sets of impulses.
fn distance(problem: &Packing, r: &[f64], s: &[f64]) -> f64 {
    let velocity = |r: &[f64]| {
        let mut velocity = problem.free_velocity().to_vec();
        problem.velocity(r, &mut velocity);
        velocity
    };
    problem.velocity_distance(&velocity(r), &velocity(s))
}

/// Whether a thousand iterations drive impulses that are 1e-9 off the solution `r` further away from its velocity.
fn drives_away(solver: &dyn Solver, problem: &Packing, r: &[f64]) -> bool {
    let off: Vec<f64> = r.iter().enumerate().map(|(k, r)| r * (1.0 + 1e-9 * (k as f64).sin())).collect();
    let mut iteration = solver.start(problem, &off).unwrap();
    (0..1000).for_each(|_| iteration.advance());
    !(distance(problem, &impulses(&*iteration, problem), r) <= distance(problem, &off, r))
}

/// Near a solution, contacts that carry stay closed and those that open stay open: the error e of the impulses that carry goes
/// as e ← (1 − ω W_D⁻¹ W) e, and grows if ω λ̃max > 2. Other contacts do not count.
#[test]
fn jacobis_limit_is_two_over_the_greatest_eigenvalue_of_the_contacts_that_carry() {
    let packings = ["settled-991", "shear-box-991-rest", "shear-box-991-sheared", "lmgc90-shear-991-t1"];
    let column = first_problem("column", &[]).problem;
    for problem in packings.into_iter().map(|name| frozen(name).problem).chain([column]) {
        let r = solution(&problem);
        let expected = 2.0 / greatest_eigenvalue(&carrying(&problem, &r));
        let (mut below, mut above) = (0.1, 3.0);
        while above - below > 1e-3 {
            let relaxation = f64::midpoint(below, above);
            let away = drives_away(&Jacobi { relaxation, ..Jacobi::default() }, &problem, &r);
            *(if away { &mut above } else { &mut below }) = relaxation;
        }
        assert!((below / expected - 1.0).abs() < 0.02, "limit {below}, {expected} expected");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn jacobi_below_its_bound_never_increases_q(problem in any_problem(), share in 0.05..1.0_f64) {
        let bounded = Jacobi { relaxation: share, bounded: true, ..Jacobi::default() };
        assert_never_increases(&energies(&bounded, &problem, 40), "jacobi, bounded");
    }
}

/// Iterations in which the velocity error falls by ten, far from the start: that of a column at rest.
fn iterations_per_decade(solver: &dyn Solver, problem: &Packing) -> f64 {
    let rest = vec![nalgebra::Vector2::zeros(); problem.grain_count()];
    let scale = problem.velocity_distance(&rest, problem.free_velocity());
    let (mut iteration, mut velocity) = (start(solver, problem), rest.clone());
    let mut passed = [None, None];
    for k in 0..2_000_000 {
        problem.velocity(&impulses(&*iteration, problem), &mut velocity);
        let error = problem.velocity_distance(&velocity, &rest) / scale;
        for (passed, level) in passed.iter_mut().zip([1e-3, 1e-6]) {
            if error <= level {
                passed.get_or_insert(f64::from(k));
            }
        }
        if let [Some(from), Some(to)] = passed {
            return (to - from) / 3.0;
        }
        iteration.advance();
    }
    panic!("no three decades in 2,000,000 iterations")
}

fn heavy_top(ratio: f64) -> (Packing, f64, f64) {
    let problem = first_problem("heavy-top", &[("sample.top_mass_ratio", &ratio.to_string())]).problem;
    let all = vec![true; problem.contact_count()];
    let closed = Spectrum::of(&problem, Some(&all)).closed.unwrap();
    (problem, closed.least, closed.greatest)
}

/// Slope of a line through logarithms of the last two points.
fn exponent(ratios: &[f64], values: &[f64]) -> f64 {
    let slope = |of: &[f64]| (of[of.len() - 1] / of[of.len() - 2]).ln();
    slope(values) / slope(ratios)
}

/// W of a column is tridiagonal, so Gauss-Seidel contracts by μ² per sweep, with μ = 1 − λ̃min that of Jacobi (Young 1954). And
/// λ̃min R tends to a constant with the mass ratio R, up to terms of the order of n/R.
#[test]
fn sweeps_of_gauss_seidel_grow_like_the_mass_ratio() {
    let ratios = [1e2, 1e3, 1e4];
    let measured = ratios.map(|ratio| {
        let (problem, least, _) = heavy_top(ratio);
        let sweeps = iterations_per_decade(&Nsgs::default(), &problem);
        let expected = -10_f64.ln() / (2.0 * (-least).ln_1p());
        assert!((sweeps / expected - 1.0).abs() < 0.02, "R = {ratio}: {sweeps} sweeps, {expected} expected");
        sweeps
    });
    // n/R is 0.01 at the smaller of the two.
    assert!((exponent(&ratios, &measured) - 1.0).abs() < 0.02, "{measured:?}");
}

/// At κ_opt LATIN with μ = 1 contracts by (√C − 1)/(√C + 1) per iteration, with C = λ̃max/λ̃min.
#[test]
fn iterations_of_tuned_latin_grow_like_the_root_of_the_mass_ratio() {
    let ratios = [1e2, 1e3, 1e4];
    let measured = ratios.map(|ratio| {
        let (problem, least, greatest) = heavy_top(ratio);
        let kappa_l = Some(1.0 / (least * greatest).sqrt());
        let solver = LatinDd { kappa_l, relaxation: 1.0, ..LatinDd::default() };
        let iterations = iterations_per_decade(&solver, &problem);
        let root = (greatest / least).sqrt();
        let expected = 10_f64.ln() / ((root + 1.0) / (root - 1.0)).ln();
        assert!((iterations / expected - 1.0).abs() < 0.05, "R = {ratio}: {iterations}, {expected} expected");
        iterations
    });
    assert!((exponent(&ratios, &measured) - 0.5).abs() < 0.02, "{measured:?}");
}

/// The root of the condition number is a bound for many iterations; as many as there are contacts are enough, whatever the ratio.
#[test]
fn conjugate_gradient_ends_in_n_iterations_whatever_the_mass_ratio() {
    for ratio in [1.0, 1e2, 1e4] {
        let (problem, ..) = heavy_top(ratio);
        let r0 = vec![0.0; problem.contact_count()];
        let outcome = solve(&Cg::default(), &problem, &r0, &Stop::default(), &mut |_| {}).unwrap();
        assert_eq!((outcome.status, outcome.iterations), (Status::Converged, 10), "R = {ratio}");
    }
}

fn ends(solver: &dyn Solver, problem: &Packing) -> Status {
    let stop = Stop { max_iterations: 20_000, ..Stop::default() };
    solve(solver, problem, &vec![0.0; problem.contact_count()], &stop, &mut |_| {}).unwrap().status
}

/// Where λmax(W_D⁻¹ W_off) < 1 whole masses converge too, as for a light disc on a roller in each of two subdomains. From
/// multiplicity 3 on they need not, and do not for more rollers, while split masses converge on the same problem and partition.
#[test]
fn whole_masses_fail_where_multiplicity_allows_it_and_split_masses_converge() {
    for (rollers, nx, fails) in [(2, 2, false), (4, 8, true), (8, 8, true), (16, 8, true)] {
        let problem = first_problem("balloon", &[("sample.rollers", &i32::to_string(&rollers))]).problem;
        let subdomains = Grid::of(nx, 1);
        let partition = Partition::of_contacts(&problem, Scheme::Boxes, subdomains).unwrap();
        let multiplicity = Decomposition::new(&problem, &partition).multiplicity.into_iter().max();
        let coupling = coupling(&problem, &partition.subdomain).unwrap();
        let expected = (fails, fails);
        assert_eq!((multiplicity >= Some(3), coupling >= 1.0), expected, "{multiplicity:?}, {coupling}");
        let with = |mass_splitting| NsgsDd { subdomains, mass_splitting, ..NsgsDd::default() };
        assert_eq!(ends(&with(true), &problem), Status::Converged);
        assert_eq!(ends(&with(false), &problem) != Status::Converged, fails, "{rollers} rollers");
    }
}
