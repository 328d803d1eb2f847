//! Accelerated sweeps: the formula, the subdomains, the restart, and what it saves.

use crate::problems::{difference, first_problem, frozen, impulses, packing, start};
use analysis::Bounded;
use contact::acceleration::{Acceleration, LAG, Momentum};
use contact::precision::Precision;
use contact::{ContactProblem, Mechanics, Packing, RoughDiscs, RoughSpheres, Solver, Spheres};
use jacobi::Jacobi;
use nsgs::{Nsgs, Order};
use nsgs_dd::{Exchange, NsgsDd};
use partition::{Grid, Scheme};
use runner::{Status, Stop, solve};

const ACCELERATED: Nsgs = Nsgs {
    order: Order::Natural,
    seed: 1,
    relaxation: 1.0,
    symmetric: false,
    acceleration: Acceleration::Nesterov,
    lag: LAG,
    slack: Some(1.5),
    precision: Precision::Double,
};

/// An accelerated run, step by step from whole lists of impulses: each iteration is the first of a plain run from y.
struct Plain<'p, M: Mechanics> {
    problem: &'p Packing<M>,
    solver: &'p dyn Solver<M>,
    lag: f64,
    slack: Option<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    weight: Vec<f64>,
    j: f64,
    least: f64,
    best: f64,
    pause: [u32; 2],
    /// Number of restarts so far.
    restarts: u32,
}

impl<'p, M: Mechanics> Plain<'p, M> {
    fn new(problem: &'p Packing<M>, solver: &'p dyn Solver<M>, slack: Option<f64>) -> Self {
        let zero = vec![0.0; problem.impulse_count()];
        Self {
            problem,
            solver,
            lag: LAG,
            slack,
            x: zero.clone(),
            y: zero,
            weight: problem.delassus_diagonal(),
            j: 0.0,
            least: f64::INFINITY,
            best: f64::INFINITY,
            pause: [0, 0],
            restarts: 0,
        }
    }

    fn advance(&mut self) {
        let mut run = self.solver.start(self.problem, &self.y).unwrap();
        run.advance();
        let mut z = self.y.clone();
        run.impulses(&mut z);
        let (mut squared, mut along) = (0.0, 0.0);
        for k in 0..z.len() {
            let g = self.y[k] - z[k];
            squared += self.weight[k] * g * g;
            along += self.weight[k] * g * (z[k] - self.x[k]);
        }
        let [pause, paused] = &mut self.pause;
        if *paused > 0 {
            *paused -= 1;
            self.least = squared;
        } else if along > 0.0 || self.slack.is_some_and(|slack| squared > slack.powi(2) * self.least) {
            *pause = match (self.least < self.best, *pause) {
                (true, _) => 0,
                (false, 0) => 1,
                (false, pause) => 64.min(2 * pause),
            };
            self.best = self.best.min(self.least);
            (self.j, self.least, *paused) = (0.0, squared, *pause);
            self.restarts += 1;
        } else {
            self.j += 1.0;
            self.least = self.least.min(squared);
        }
        let factor = self.j / (self.j + self.lag);
        self.y = (0..z.len()).map(|k| z[k] + factor * (z[k] - self.x[k])).collect();
        self.x = z;
    }
}

fn assert_is_the_formula<M: Mechanics>(
    problem: &Packing<M>,
    accelerated: &dyn Solver<M>,
    (plain, slack): (&dyn Solver<M>, Option<f64>),
) {
    let zero = vec![0.0; problem.impulse_count()];
    let mut run = accelerated.start(problem, &zero).unwrap();
    let (mut plain, mut r) = (Plain::new(problem, plain, slack), zero);
    // At least to the first restart.
    let mut k = 0;
    while k < 150 || plain.restarts == 0 {
        assert!(k < 1_000, "{}: no restart was tried", M::NAME);
        k += 1;
        run.advance();
        plain.advance();
        run.impulses(&mut r);
        // Round-off alone, which a frictional contact may enlarge.
        let difference = difference(&r, &plain.x);
        assert!(difference < 1e-9, "{}, iteration {k}: {difference}", M::NAME);
    }
}

/// ρ unless it is given.
fn slack<M: Mechanics>() -> f64 {
    if M::HAS_FRICTION { 1.2 } else { 5.0 }
}

fn assert_sweeps_are_the_formula<M: Mechanics>(problem: &Packing<M>, settings: Nsgs) {
    let plain = Nsgs { acceleration: Acceleration::None, ..settings };
    assert_is_the_formula(problem, &settings, (&plain, settings.slack.or(Some(slack::<M>()))));
}

fn assert_all_are_the_formula<M: Bounded>(problem: &Packing<M>) {
    assert_sweeps_are_the_formula(problem, ACCELERATED);
    let plain = Jacobi { bounded: true, ..Jacobi::default() };
    let accelerated = Jacobi { acceleration: Acceleration::Nesterov, ..plain };
    assert_is_the_formula(problem, &accelerated, (&plain, Some(slack::<M>())));
}

#[test]
fn accelerated_iterations_are_the_formula_in_every_mechanics() {
    let discs: Packing = packing("shear-box-991-sheared");
    assert_all_are_the_formula(&discs);
    let coloured = Nsgs { order: Order::Coloured, ..ACCELERATED };
    assert_sweeps_are_the_formula(&discs, coloured);
    let symmetric = Nsgs { symmetric: true, slack: Some(1.0), ..ACCELERATED };
    assert_sweeps_are_the_formula(&discs, symmetric);
    assert_all_are_the_formula::<RoughDiscs>(&packing("rough-250"));
    assert_all_are_the_formula::<Spheres>(&packing("spheres-250"));
    assert_all_are_the_formula::<RoughSpheres>(&packing("rough-spheres-250"));
}

/// One momentum over all subdomains: on one of them it is that of NSGS.
#[test]
fn accelerated_nsgs_dd_on_one_subdomain_is_accelerated_nsgs() {
    let problem = frozen("shear-box-991-onset").problem;
    let one = NsgsDd { acceleration: Acceleration::Nesterov, ..NsgsDd::default() };
    let (mut nsgs, mut dd) = (start(&ACCELERATED, &problem), start(&one, &problem));
    for k in 0..100 {
        nsgs.advance();
        dd.advance();
        let difference = difference(&impulses(&*nsgs, &problem), &impulses(&*dd, &problem));
        assert!(difference < 1e-10, "iteration {k}: {difference}");
    }
}

/// Whatever the exchange, copies of a grain have one velocity again after each extrapolation: a run ends at a solution.
#[test]
fn accelerated_nsgs_dd_ends_at_solutions() {
    let stop = Stop { tolerance: 1e-8, max_iterations: 3000, ..Stop::default() };
    let default =
        NsgsDd { subdomains: Grid::of(4, 2), acceleration: Acceleration::Nesterov, ..NsgsDd::default() };
    for (name, settings) in [
        ("jacobi", default),
        ("gauss-seidel", NsgsDd { exchange: Exchange::GaussSeidel, ..default }),
        ("schwarz", NsgsDd { mass_splitting: false, relaxation: 0.5, ..default }),
        ("three sweeps", NsgsDd { inner_sweeps: 3, ..default }),
        ("balanced", NsgsDd { partition: Scheme::Balanced, ..default }),
    ] {
        let problem = frozen("shear-box-991-sheared").problem;
        let r0 = vec![0.0; problem.contact_count()];
        let outcome = solve(&settings, &problem, &r0, &stop, &mut |_| {}).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{name}: {}", outcome.measures.natural_map);
    }
}

/// Counts, which no machine changes: a tenth of the sweeps of NSGS, in the whole and in eight subdomains.
#[test]
fn acceleration_saves_nine_of_ten_sweeps_on_sheared_packings() {
    let stop = Stop { tolerance: 1e-6, max_iterations: 9_000, ..Stop::default() };
    for name in ["shear-box-991-onset", "shear-box-991-sheared"] {
        let problem = frozen(name).problem;
        let count = |solver: &dyn Solver| {
            let r0 = vec![0.0; problem.contact_count()];
            let outcome = solve(solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
            assert_eq!(outcome.status, Status::Converged, "{name}");
            outcome.iterations
        };
        let plain = count(&Nsgs::default());
        let accelerated = count(&ACCELERATED);
        let dd =
            NsgsDd { subdomains: Grid::of(4, 2), acceleration: Acceleration::Nesterov, ..NsgsDd::default() };
        let eight = count(&dd);
        assert!(10 * accelerated < plain, "{name}: {accelerated} of {plain}");
        assert!(10 * eight < 13 * accelerated, "{name}: {eight} on eight subdomains, {accelerated} on one");
    }
}

/// Velocities made anew at restarts keep round-off from growing with β: plain sums end at 1e-11 here.
#[test]
fn accelerated_sweeps_come_to_round_off() {
    let problem = frozen("shear-box-991-onset").problem;
    let r0 = vec![0.0; problem.contact_count()];
    let stop = Stop { tolerance: 1e-12, max_iterations: 3_000, ..Stop::default() };
    let outcome = solve(&ACCELERATED, &problem, &r0, &stop, &mut |_| {}).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{}", outcome.measures.natural_map);
}

/// Jacobi at ω = 1/Λ: what plain iterations do not reach in twenty times as many.
#[test]
fn acceleration_brings_jacobi_to_its_tolerance() {
    let problem = frozen("shear-box-991-sheared").problem;
    let r0 = vec![0.0; problem.contact_count()];
    let plain = Jacobi { bounded: true, ..Jacobi::default() };
    let accelerated = Jacobi { acceleration: Acceleration::Nesterov, ..plain };
    for (solver, tolerance, max_iterations, status) in
        [(accelerated, 1e-6, 1_200, Status::Converged), (plain, 1e-4, 20_000, Status::IterationLimit)]
    {
        let stop = Stop { tolerance, max_iterations, ..Stop::default() };
        let outcome = solve(&solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
        assert_eq!(outcome.status, status, "{}", outcome.measures.natural_map);
    }
}

/// Without friction the sweep after a restart is one of plain NSGS, which never increases q(r) = ½ rᵗ W r + bᵗ r.
#[test]
fn a_sweep_after_a_restart_never_increases_the_energy() {
    for name in ["shear-box-991-rest", "settled-250", "lmgc90-shear-991-t1"] {
        let problem = frozen(name).problem;
        let (b, mut v) = (problem.b(), vec![0.0; problem.contact_count()]);
        let mut energy = |r: &[f64]| {
            let mut velocity = problem.free_velocity().to_vec();
            problem.velocity(r, &mut velocity);
            problem.relative_velocity(&velocity, &mut v);
            ContactProblem::<contact::Discs>::energy(r, &v, &b)
        };
        let sweep = Nsgs::default();
        let mut plain = Plain::new(&problem, &sweep, ACCELERATED.slack);
        let mut tried = 0;
        for _ in 0..400 {
            let (restarts, before) = (plain.restarts, plain.x.clone());
            let begins_there = plain.y == before;
            plain.advance();
            if begins_there && restarts > 0 {
                let (from, to) = (energy(&before), energy(&plain.x));
                assert!(to <= from + 1e-13 * from.abs(), "{name}: {from} to {to}");
                tried += 1;
            }
        }
        assert!(tried > 0, "{name}");
    }
}

/// In a large crystal extrapolated sweeps oscillate and grow, and ⟨g, d⟩ stays negative.
#[test]
fn acceleration_does_not_diverge_in_a_crystal() {
    let scene = [("sample.columns", "24"), ("sample.rows", "120"), ("scene.box.width_m", "24.0")];
    let problem = first_problem("triangular", &scene).problem;
    let r0 = vec![0.0; problem.contact_count()];
    let ends = |slack: Option<f64>, max_iterations: u64| {
        let settings = Nsgs { acceleration: Acceleration::Nesterov, slack, ..Nsgs::default() };
        let stop = Stop { max_iterations, ..Stop::default() };
        let outcome = solve(&settings, &problem, &r0, &stop, &mut |_| {}).unwrap();
        (outcome.status, outcome.measures.natural_map)
    };
    assert_eq!(ends(Some(1e9), 300).0, Status::Diverged);
    let (early, late) = (ends(None, 300), ends(None, 1000));
    assert!(early.1 < 1.0 && late.1 < 0.5 * early.1, "{early:?}, {late:?}");
}

#[test]
fn momentum_without_meaning_is_refused() {
    let momentum =
        |lag, slack| Acceleration::Nesterov.momentum(lag, Some(slack)).map(|_: Option<Momentum>| ());
    assert!(momentum(3.0, 1.0).is_ok());
    for (lag, slack, key) in
        [(0.0, 1.5, "lag"), (f64::NAN, 1.5, "lag"), (3.0, 0.9, "slack"), (3.0, f64::NAN, "slack")]
    {
        let error = momentum(lag, slack).unwrap_err().to_string();
        assert!(error.contains(key), "{error}");
    }
}
