//! Coulomb's law: another code's problem, its solution and its counts; known answers; and what is left where friction is 0.

use crate::problems::{first_problem_of, frozen, frozen_path};
use active_set::ActiveSet;
use analysis::Meter;
use cases::Frozen;
use cg::Cg;
use contact::{
    Contact, Discs, Iteration, Measure, Packing, RoughContact, RoughDiscs, RoughMass, Solver, Truth,
};
use jacobi::Jacobi;
use nalgebra::{Vector2, Vector3};
use nsgs::{Nsgs, Order};
use nsgs_dd::{Exchange, NsgsDd};
use partition::Grid;
use reference::{certify, distance, solve_rough};
use runner::{Measured, Outcome, Progress, Status, Stop, solve, solve_against};
use serde_json::Value;
use std::ops::ControlFlow;

pub(crate) fn rough(name: &str) -> Frozen<RoughDiscs> {
    Frozen::read(&frozen_path(&format!("{name}.json"))).unwrap()
}

/// The same contacts with another friction.
pub(crate) fn with_friction(problem: &Packing<RoughDiscs>, friction: f64) -> Packing<RoughDiscs> {
    let contacts = problem.contacts().iter().map(|contact| RoughContact { friction, ..*contact }).collect();
    let (mass, position) = (problem.mass().to_vec(), problem.position().to_vec());
    Packing::new(mass, position, problem.free_velocity().to_vec(), contacts).unwrap()
}

/// Discs without friction as discs with friction, of a radius that nothing depends on.
fn roughened(problem: &Packing, friction: f64) -> Packing<RoughDiscs> {
    let contact = |at: &Contact| RoughContact {
        candidate: at.candidate,
        antagonist: at.antagonist,
        normal: at.normal,
        arms: Vector2::new(0.5, at.antagonist.map_or(0.0, |_| 0.5)),
        offset: Vector2::new(at.offset, 0.0),
        friction,
    };
    Packing::new(
        problem.mass().iter().map(|mass| RoughMass { mass: *mass, inertia: 0.125 * mass }).collect(),
        problem.position().to_vec(),
        problem.free_velocity().iter().map(|v| Vector3::new(v.x, v.y, 0.0)).collect(),
        problem.contacts().iter().map(contact).collect(),
    )
    .unwrap()
}

fn run(solver: &dyn Solver<RoughDiscs>, problem: &Packing<RoughDiscs>, tolerance: f64) -> Outcome {
    let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: 200_000 };
    solve(solver, problem, &vec![0.0; problem.impulse_count()], &stop, &mut |_| {}).unwrap()
}

fn impulses(iteration: &dyn Iteration, count: usize) -> Vec<f64> {
    let mut r = vec![f64::NAN; count];
    iteration.impulses(&mut r);
    r
}

/// Impulses that another code gave.
pub(crate) fn given(solution: &Value) -> Vec<f64> {
    serde_json::from_value::<Vec<[f64; 2]>>(solution["impulse"].clone()).unwrap().concat()
}

pub(crate) fn given_solution() -> Value {
    let text = std::fs::read_to_string(frozen_path("rough-991-mu08.solution.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn sweeps_are_as_many_as_another_code_makes() {
    let frozen = rough("rough-991-mu08");
    for (tolerance, expected) in [(1e-2, 6150.0), (1e-3, 11_710.0), (1e-4, 58_100.0)] {
        let outcome = run(&Nsgs::default(), &frozen.problem, tolerance);
        assert_eq!(outcome.status, Status::Converged);
        let ratio = outcome.iterations as f64 / expected;
        assert!((ratio - 1.0).abs() < 0.01, "{tolerance:e}: {} sweeps", outcome.iterations);
    }
}

#[test]
fn another_codes_solutions_are_certified_and_far_from_each_other() {
    let (frozen, solution) = (rough("rough-991-mu08"), given_solution());
    let first = given(&solution);
    let certificate = certify(&frozen.problem, &first);
    assert!(certificate.certified(), "{certificate}");
    let measured = Meter::new(&frozen.problem).measure_after(&[], &first, 0.0).natural_map;
    let said = solution["residual"].as_f64().unwrap();
    assert!(measured < 2.0 * said && certificate.natural_map.relative < 2.0 * said, "{measured:e}, {said:e}");
    for other in solution["other_solutions"].as_array().unwrap() {
        let certificate = certify(&frozen.problem, &given(other));
        assert!(certificate.natural_map.relative <= 1e-12, "{certificate}");
        let (apart, said) =
            (distance(&frozen.problem, &first, &given(other)), other["velocity_distance"].as_f64().unwrap());
        assert!((apart - said).abs() < 1e-6 * said, "{apart} and {said}");
    }
}

#[test]
fn the_active_set_ends_certified_for_any_friction_up_to_one_half() {
    let frozen = rough("rough-991-mu08");
    for friction in [0.0, 0.05, 0.1, 0.3, 0.5] {
        let problem = with_friction(&frozen.problem, friction);
        let outcome = run(&ActiveSet::default(), &problem, 1e-13);
        assert_eq!(outcome.status, Status::Converged, "{friction}: {:e}", outcome.measures.natural_map);
        let certificate = certify(&problem, &outcome.impulses);
        assert!(certificate.certified(), "{friction}: {certificate}");
    }
}

#[test]
fn solutions_from_other_starts_are_others() {
    let problem = with_friction(&rough("rough-991-mu08").problem, 0.5);
    let solutions = solve_rough(&problem, 0..=6, || {});
    assert!(solutions.len() > 1 && solutions.iter().all(|solution| solution.certificate.certified()));
    for (k, one) in solutions.iter().enumerate() {
        for other in &solutions[..k] {
            let apart = distance(&problem, &one.impulses, &other.impulses);
            assert!(apart > 1e-8, "{apart:e}");
        }
    }
}

#[test]
fn a_solution_that_nobody_knew_is_no_false_convergence() {
    let (problem, solution) = (rough("rough-991-mu08").problem, given_solution());
    let known = Truth::new(&problem, &given(&solution));
    // Another solution, far away, from which nothing moves.
    let other = given(&solution["other_solutions"][0]);
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 10 };
    let nsgs: &dyn Solver<RoughDiscs> = &Nsgs::default();
    let go_on = &mut |_: &Progress| ControlFlow::Continue(());
    let outcome = solve_against([&known], nsgs, &problem, &other, &stop, Measured::Every, go_on).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    assert!(outcome.measures.velocity_error > 0.1, "{:?}", outcome.measures);
}

#[test]
fn methods_agree_on_the_law_where_they_converge() {
    let problem = with_friction(&rough("rough-991-mu08").problem, 0.05);
    let diagonal = Cg::preconditioned();
    let grid = Grid::of(4, 2);
    let methods: [(&str, &dyn Solver<RoughDiscs>); 9] = [
        ("nsgs", &Nsgs::default()),
        ("nsgs bottom-up", &Nsgs { order: Order::BottomUp, ..Nsgs::default() }),
        ("nsgs symmetric", &Nsgs { symmetric: true, ..Nsgs::default() }),
        ("jacobi", &Jacobi { relaxation: 0.9, bounded: true, ..Jacobi::default() }),
        ("nsgs-dd", &NsgsDd { subdomains: grid, ..NsgsDd::default() }),
        (
            "nsgs-dd coloured",
            &NsgsDd { subdomains: grid, exchange: Exchange::GaussSeidel, ..NsgsDd::default() },
        ),
        (
            "schwarz",
            &NsgsDd { subdomains: grid, mass_splitting: false, relaxation: 0.5, ..NsgsDd::default() },
        ),
        ("cg", &Cg::default()),
        ("cg diagonal", &diagonal),
    ];
    for (name, method) in methods {
        let outcome = run(method, &problem, 1e-5);
        assert_eq!(outcome.status, Status::Converged, "{name}");
        let certificate = certify(&problem, &outcome.impulses);
        assert!(
            certificate.natural_map.relative <= 1.01e-5 && certificate.cone.unwrap().relative <= 1e-12,
            "{name}: {certificate}"
        );
    }
}

#[test]
fn without_friction_each_iterate_is_that_of_discs() {
    let smooth = frozen("shear-box-991-onset").problem;
    let problem = roughened(&smooth, 0.0);
    let grid = Grid::of(2, 2);
    let dd = NsgsDd { subdomains: grid, ..NsgsDd::default() };
    let diagonal = Cg::preconditioned();
    let jacobi = Jacobi { relaxation: 0.3, bounded: false, ..Jacobi::default() };
    let pairs: [(&str, &dyn Solver<Discs>, &dyn Solver<RoughDiscs>); 5] = [
        ("nsgs", &Nsgs::default(), &Nsgs::default()),
        ("jacobi", &jacobi, &jacobi),
        ("nsgs-dd", &dd, &dd),
        ("cg", &Cg::default(), &Cg::default()),
        ("cg diagonal", &diagonal, &diagonal),
    ];
    for (name, on_discs, on_rough) in pairs {
        let (none, none_rough) = (vec![0.0; smooth.contact_count()], vec![0.0; problem.impulse_count()]);
        let mut one = on_discs.start(&smooth, &none).unwrap();
        let mut other = on_rough.start(&problem, &none_rough).unwrap();
        for k in 1..=40 {
            one.advance();
            other.advance();
            let (r, both) = (impulses(&*one, none.len()), impulses(&*other, none_rough.len()));
            let greatest = r.iter().copied().fold(0.0, f64::max);
            for (r, both) in r.iter().zip(both.chunks_exact(2)) {
                assert!(
                    (r - both[0]).abs() <= 1e-9 * greatest && both[1] == 0.0,
                    "{name}, iteration {k}: {r}, {both:?}"
                );
            }
        }
    }
}

/// A disc of 2 kg and 0.5 m on a plane with normal [0, 1], with this velocity before the time step of 10 ms and gravity along the
/// plane and against its normal (m/s²).
fn disc_on_a_plane(
    velocity: Vector3<f64>,
    gravity: Vector2<f64>,
    friction: f64,
    units: (f64, f64),
) -> Packing<RoughDiscs> {
    let (length, mass) = units;
    let radius = 0.5 * length;
    let free = Vector3::new(
        velocity.x * length + H * gravity.x * length,
        velocity.y + H * gravity.y * length,
        velocity.z,
    );
    Packing::new(
        vec![RoughMass { mass: 2.0 * mass, inertia: mass * radius * radius }],
        vec![Vector2::new(0.0, radius)],
        vec![free],
        vec![RoughContact {
            candidate: 0,
            antagonist: None,
            normal: Vector2::y(),
            arms: Vector2::new(radius, 0.0),
            offset: Vector2::zeros(),
            friction,
        }],
    )
    .unwrap()
}

const H: f64 = 0.01;

/// Lengths and masses in metres and kilograms, and in others: no answer depends on them.
const UNITS: [(f64, f64); 3] = [(1.0, 1.0), (1e-3, 1.0), (1.0, 1e6)];

fn every_method() -> Vec<(&'static str, Box<dyn Solver<RoughDiscs>>)> {
    vec![
        ("nsgs", Box::new(Nsgs::default())),
        ("jacobi", Box::new(Jacobi { relaxation: 1.0, bounded: false, ..Jacobi::default() })),
        ("nsgs-dd", Box::new(NsgsDd::default())),
        ("cg", Box::new(Cg::preconditioned())),
        ("active-set", Box::new(ActiveSet::default())),
    ]
}

#[test]
fn a_disc_on_a_slope_rolls_up_to_three_times_the_friction_and_slides_above() {
    let (g, friction) = (9.81, 0.2_f64);
    for units in UNITS {
        for tangent in [0.1_f64, 0.3, 0.59, 0.61, 1.0] {
            let angle = tangent.atan();
            let (along, down) = (g * angle.sin(), g * angle.cos());
            let problem = disc_on_a_plane(Vector3::zeros(), Vector2::new(along, -down), friction, units);
            let rolls = tangent <= 3.0 * friction;
            let acceleration = if rolls { 2.0 / 3.0 * along } else { along - friction * down };
            // α = a/R clockwise where it rolls, 2 μ g cos θ/R where it slides.
            let spin = if rolls { acceleration / 0.5 } else { 2.0 * friction * down / 0.5 };
            for (name, method) in every_method() {
                let v = Truth::new(&problem, &run(&*method, &problem, 1e-12).impulses).velocity()[0];
                let expected = Vector3::new(H * acceleration * units.0, 0.0, -H * spin);
                let error = (v - expected).component_div(&Vector3::new(units.0, units.0, 1.0)).amax();
                assert!(error < 1e-10, "{name}, {tangent}, {units:?}: {v} and {expected}");
            }
        }
    }
}

#[test]
fn a_thrown_disc_slides_until_it_rolls_at_two_thirds_of_its_speed() {
    let (v0, friction, g) = (1.0, 0.1, 10.0);
    for units in UNITS {
        // Rolling begins at v₀/(3 μ g) = 1/3 s.
        let mut v = Vector3::new(v0, 0.0, 0.0);
        for step in 1..=60 {
            let problem = disc_on_a_plane(v, Vector2::new(0.0, -g), friction, units);
            let outcome = run(&Nsgs::default(), &problem, 1e-13);
            v = Truth::new(&problem, &outcome.impulses).velocity()[0]
                .component_div(&Vector3::new(units.0, units.0, 1.0));
            let t = f64::from(step) * H;
            let expected = if t < v0 / (3.0 * friction * g) { v0 - friction * g * t } else { 2.0 / 3.0 * v0 };
            assert!((v.x - expected).abs() < 1e-10, "{units:?}, {t} s: {} and {expected} m/s", v.x);
        }
        assert!((v.x + 0.5 * v.z).abs() < 1e-10, "it rolls");
    }
}

#[test]
fn large_friction_stops_the_contact_point() {
    let problem = disc_on_a_plane(Vector3::new(3.0, -1.0, 2.0), Vector2::zeros(), 1e3, (1.0, 1.0));
    for (name, method) in every_method() {
        let v = Truth::new(&problem, &run(&*method, &problem, 1e-13).impulses).velocity()[0];
        assert!((v.x + 0.5 * v.z).abs() < 1e-12 && v.y.abs() < 1e-12, "{name}: {v}");
    }
}

/// Two equal discs of 1 m that touch on a floor, a third on both, under gravity: the friction between discs, and at the floor.
fn stack(between: f64, floor: f64) -> Packing<RoughDiscs> {
    let (mass, radius) = (1.0, 1.0);
    let position = [(-1.0, 1.0), (1.0, 1.0), (0.0, 1.0 + 3.0_f64.sqrt())];
    let contact = |i: u32, j: Option<u32>, normal: (f64, f64), friction| RoughContact {
        candidate: i,
        antagonist: j,
        normal: Vector2::new(normal.0, normal.1),
        arms: Vector2::new(radius, j.map_or(0.0, |_| radius)),
        offset: Vector2::zeros(),
        friction,
    };
    let slanted = 3.0_f64.sqrt() / 2.0;
    Packing::new(
        vec![RoughMass { mass, inertia: 0.5 * mass * radius * radius }; 3],
        position.map(|(x, y)| Vector2::new(x, y)).to_vec(),
        vec![Vector3::new(0.0, -0.1, 0.0); 3],
        vec![
            contact(0, None, (0.0, 1.0), floor),
            contact(1, None, (0.0, 1.0), floor),
            contact(1, Some(0), (1.0, 0.0), between),
            contact(2, Some(0), (0.5, slanted), between),
            contact(2, Some(1), (-0.5, slanted), between),
        ],
    )
    .unwrap()
}

#[test]
fn a_stack_of_three_stands_where_both_frictions_suffice() {
    let needed = 15.0_f64.to_radians().tan();
    for (name, method) in every_method().into_iter().filter(|(name, _)| *name != "jacobi") {
        for (between, floor, stands) in [
            (1.01 * needed, 1.01 * needed / 3.0, true),
            (0.9 * needed, 1.01 * needed / 3.0, false),
            (1.01 * needed, 0.9 * needed / 3.0, false),
        ] {
            let problem = stack(between, floor);
            let outcome = run(&*method, &problem, 1e-10);
            assert_eq!(outcome.status, Status::Converged, "{name}");
            let truth = Truth::new(&problem, &outcome.impulses);
            let fastest = truth.velocity().iter().map(Vector3::amax).fold(0.0, f64::max);
            assert_eq!(fastest < 1e-8, stands, "{name}, {between}, {floor}: {fastest:e} m/s");
        }
    }
}

#[test]
fn a_floor_that_slides_takes_a_disc_along() {
    // c_t = −t · V_wall, with t = (−1, 0).
    let (u, friction, g) = (0.5, 0.1, 10.0);
    let mut v = Vector3::zeros();
    for step in 1..=40 {
        let mut contact = disc_on_a_plane(v, Vector2::new(0.0, -g), friction, (1.0, 1.0)).contacts()[0];
        contact.offset.y = u;
        let still = disc_on_a_plane(v, Vector2::new(0.0, -g), friction, (1.0, 1.0));
        let problem = Packing::new(
            still.mass().to_vec(),
            still.position().to_vec(),
            still.free_velocity().to_vec(),
            vec![contact],
        )
        .unwrap();
        v = Truth::new(&problem, &run(&Nsgs::default(), &problem, 1e-13).impulses).velocity()[0];
        let t = f64::from(step) * H;
        // Moves at U/3 from t = U/(3 μ g) on.
        let expected = f64::min(friction * g * t, u / 3.0);
        assert!((v.x - expected).abs() < 1e-10, "{t} s: {} and {expected} m/s", v.x);
    }
}

#[test]
fn the_active_set_comes_through_where_impulses_drift() {
    // Gauss-Seidel takes 129,100 sweeps; of the second, a packing at rest in which more contacts stick than motion allows, it comes to
    // a floor of 2e-7.
    for name in ["rough-991-mu08", "rough-250"] {
        let problem = rough(name).problem;
        let outcome = run(&ActiveSet::default(), &problem, 1e-12);
        assert_eq!(outcome.status, Status::Converged, "{name}");
        assert!(outcome.iterations < 60_000, "{name}: {}", outcome.iterations);
        assert!(certify(&problem, &outcome.impulses).certified(), "{name}");
    }
    // Friction that a packing has all of a sudden: from conjugate gradients it ended at a floor. A natural map of 1e-12 is
    // not enough for a certificate here.
    let settings =
        [("sample.file", "frozen/settled-250.json"), ("scene.box.width_m", "2.4"), ("scene.friction", "0.8")];
    let problem = first_problem_of("friction-switched-on", &settings).problem;
    let outcome = run(&ActiveSet::default(), &problem, 1e-13);
    assert_eq!(outcome.status, Status::Converged);
    assert!(certify(&problem, &outcome.impulses).certified());
}
