//! Elasticity of rigid grains after few iterations: what N iterations a time step, from the impulses of the step before, make of a contact.
//!
//! In a wave much longer than it travels in a time step all contacts near one another approach at the same v, as they would at the old
//! impulses. W does next to nothing to a change of such impulses, so each iteration changes them by the same: r ← r − a v/W_αα, with a = ω
//! for Jacobi; a = 2ω/(2 − ω) for Gauss-Seidel, whose matrix W_D/ω + L is W_D (1/ω − ½) + W/2 + (L − Lᵗ)/2, of which the last has no mean effect in
//! an order along the chain (in another order that stays the same it costs a constant); a = 2κ for LATIN, whose stages contract by
//! (1 − κW/W_αα)/(1 + κW/W_αα), relaxed by μ from the second iteration on. Extrapolated by β = (j − 1)/(j + 1), iteration j = 1…N changes by
//! (j + 2)/3 times as much as one of Gauss-Seidel, N(N + 5)/6 together, as long as no restart happens. The force r/h then grows like a spring's,
//! dF/dt = −k v, with k = Σa/(W_αα h²); in a column of discs W_αα = 2/m, and waves run c = d √(k/m) = √(Σa/2) diameters a time step. Elasticity of a
//! chain from few iterations: Unger, Brendel, Wolf, Kertész 2002, Phys. Rev. E 65, 061305.

use crate::problems::first_problem;
use contact::acceleration::Acceleration;
use contact::{Packing, Solver, Touch, Truth};
use jacobi::Jacobi;
use latin_dd::LatinDd;
use nsgs::Nsgs;
use nsgs_dd::{Exchange, NsgsDd};
use runner::{Stop, solve};

/// Height of the column (discs).
const HEIGHT: usize = 200;

/// Returns the speed at which the weight of a column comes to the floor (discs per time step), from the force there after 0.8 of the
/// time that it takes at the speed `expected`: the force grows like the time until it is the weight.
fn speed(solver: &dyn Solver, iterations: u64, expected: f64) -> f64 {
    let mut problem = first_problem("column", &[("sample.grains", &HEIGHT.to_string())]).problem;
    // At first nothing moves, so the free velocity is what gravity adds in a time step.
    let gained = problem.free_velocity()[0];
    let floor = (0..HEIGHT).find(|k| problem.contacts()[*k].ends().1.is_none()).unwrap();
    let weight = -gained.y * problem.mass()[0] * HEIGHT as f64;
    let stop = Stop { tolerance: 1e-300, max_iterations: iterations, ..Stop::default() };
    let steps = (0.8 * HEIGHT as f64 / expected) as usize;
    let mut r = vec![0.0; HEIGHT];
    for _ in 0..steps {
        let outcome = solve(solver, &problem, &r, &stop, &mut |_| {}).unwrap();
        r = outcome.impulses;
        let next = Truth::new(&problem, &r).velocity().iter().map(|v| v + gained).collect();
        let (mass, position) = (problem.mass().to_vec(), problem.position().to_vec());
        problem = Packing::new(mass, position, next, problem.contacts().to_vec()).unwrap();
    }
    r[floor] / weight * HEIGHT as f64 / steps as f64
}

#[test]
fn sound_is_as_fast_as_the_iterations_are_many() {
    let jacobi = Jacobi::default();
    let simultaneous = NsgsDd { contact_exchange: Exchange::Jacobi, relaxation: 0.5, ..NsgsDd::default() };
    let relaxed = Nsgs { relaxation: 1.5, ..Nsgs::default() };
    let nesterov = Nsgs { acceleration: Acceleration::Nesterov, ..Nsgs::default() };
    let latin = LatinDd { kappa_l: Some(4.0), relaxation: 0.8, adaptive: Some(false), ..LatinDd::default() };
    for n in [3, 10, 30] {
        let iterations = n as f64;
        let cases: [(&str, &dyn Solver, f64); 6] = [
            ("jacobi", &jacobi, 0.5 * iterations),
            ("nsgs-dd, contacts at once", &simultaneous, 0.5 * iterations),
            ("nsgs", &Nsgs::default(), 2.0 * iterations),
            ("nsgs, ω = 1.5", &relaxed, 6.0 * iterations),
            ("nsgs, accelerated", &nesterov, iterations * (iterations + 5.0) / 3.0),
            ("latin-dd", &latin, 2.0 * 4.0 * (1.0 + 0.8 * (iterations - 1.0))),
        ];
        for (name, solver, change) in cases {
            let expected = (change / 2.0).sqrt();
            let speed = speed(solver, n, expected);
            assert!(
                (speed / expected - 1.0).abs() < 0.02,
                "{name}, {n} iterations: {speed}, {expected} expected"
            );
        }
    }
}
