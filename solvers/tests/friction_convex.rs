//! The convex relaxation of Coulomb's law, and its fixed point.

use crate::friction::{rough, with_friction};
use active_set::ActiveSet;
use contact::{Packing, RoughContact, RoughDiscs, RoughMass, Truth};
use convex::Convex;
use nalgebra::{Vector2, Vector3};
use reference::{certify, distance, solve_rough};
use runner::{Outcome, Status, Stop, solve};

const RELAXED: Convex = Convex { fixed_point: false };
const FRICTION: f64 = 0.3;

/// A disc of 1 kg and 1 m that comes down on a floor at 1 m/s, and along it at another speed.
fn landing(speed: f64) -> Packing<RoughDiscs> {
    let contact = RoughContact {
        candidate: 0,
        antagonist: None,
        normal: Vector2::y(),
        arms: Vector2::new(1.0, 0.0),
        offset: Vector2::zeros(),
        friction: FRICTION,
    };
    let free = vec![Vector3::new(speed, -1.0, 0.0)];
    Packing::new(vec![RoughMass { mass: 1.0, inertia: 0.5 }], vec![Vector2::zeros()], free, vec![contact])
        .unwrap()
}

fn run(method: Convex, problem: &Packing<RoughDiscs>, tolerance: f64) -> Outcome {
    let stop = Stop { tolerance, max_iterations: 200, ..Stop::default() };
    solve(&method, problem, &vec![0.0; problem.impulse_count()], &stop, &mut |_| {}).unwrap()
}

/// Along the floor, and away from it.
fn relative(problem: &Packing<RoughDiscs>, outcome: &Outcome) -> (f64, f64) {
    let truth = Truth::new(problem, &outcome.impulses);
    let velocity = truth.velocity()[0];
    (velocity.x + velocity.z, velocity.y)
}

#[test]
fn the_relaxation_lifts_what_slides_by_its_friction_and_keeps_what_sticks() {
    // It sticks up to a speed of 3 μ.
    let sticking = run(RELAXED, &landing(0.8), 1e-12);
    assert_eq!((sticking.status, sticking.iterations), (Status::Converged, 1));
    let (along, away) = relative(&landing(0.8), &sticking);
    assert!(along.abs() < 1e-12 && away.abs() < 1e-12);
    let sliding = run(RELAXED, &landing(2.0), 1e-12);
    assert_eq!((sliding.status, sliding.iterations), (Status::Stalled, 1));
    let (along, away) = relative(&landing(2.0), &sliding);
    assert!(along > 0.1 && (away - FRICTION * along).abs() < 1e-12, "{along}, {away} m/s");
    // r = (r_n, −μ r_n) with v_n = −1 + r_n = μ v_t = μ (2 − 3 μ r_n).
    let expected = (1.0 + 2.0 * FRICTION) / (1.0 + 3.0 * FRICTION * FRICTION);
    assert!((sliding.impulses[0] - expected).abs() < 1e-12, "{:?}", sliding.impulses);
}

#[test]
fn the_fixed_point_solves_the_law() {
    let sliding = run(Convex::default(), &landing(2.0), 1e-12);
    assert_eq!(sliding.status, Status::Converged);
    // t = (−1, 0): friction acts against the speed along it.
    let [normal, tangential] = sliding.impulses[..] else { unreachable!("one contact") };
    assert!(
        (normal - 1.0).abs() < 1e-10 && (tangential - FRICTION).abs() < 1e-10,
        "{normal}, {tangential} N·s"
    );
    // A packing: near to the certified solution, where the relaxation is not.
    let problem = with_friction(&rough("rough-991-mu08").problem, 0.1);
    let solution = &solve_rough(&problem, 0..=0, || {})[0];
    assert!(solution.certificate.certified());
    let error = |method| distance(&problem, &solution.impulses, &run(method, &problem, 1e-6).impulses);
    let (relaxed, fixed) = (error(RELAXED), error(Convex::default()));
    assert!(relaxed > 1e-3 && fixed < 1e-2 * relaxed, "{relaxed:e}, {fixed:e}");
}

/// More contacts stick there than motion allows: the programmes drift.
#[test]
fn the_fixed_point_stalls_on_a_floor() {
    let problem = rough("rough-250").problem;
    let stop = Stop { tolerance: 1e-10, max_iterations: 5_000, ..Stop::default() };
    let r0 = vec![0.0; problem.impulse_count()];
    let outcome = solve(&Convex::default(), &problem, &r0, &stop, &mut |_| {}).unwrap();
    assert_eq!(outcome.status, Status::Stalled);
    assert!(outcome.measures.natural_map < 1e-6, "{:e}", outcome.measures.natural_map);
}

#[test]
fn programmes_end_within_the_cones_and_what_stays_open_is_not_pushed() {
    for name in ["rough-250", "rough-991-onset-unconverged"] {
        let problem = rough(name).problem;
        let outcome = run(RELAXED, &problem, 1e-12);
        let certificate = certify(&problem, &outcome.impulses);
        assert!(
            certificate.cone.unwrap().relative < 1e-12 && certificate.pull.absolute == 0.0,
            "{name}: {certificate}"
        );
    }
}

#[test]
fn without_friction_there_is_nothing_to_relax() {
    let problem = crate::problems::frozen("settled-60").problem;
    let (stop, r0) = (Stop { tolerance: 1e-12, ..Stop::default() }, vec![0.0; problem.contact_count()]);
    for method in [RELAXED, Convex::default()] {
        let of_convex = solve(&method, &problem, &r0, &stop, &mut |_| {}).unwrap();
        let of_set = solve(&ActiveSet::default(), &problem, &r0, &stop, &mut |_| {}).unwrap();
        assert_eq!(of_convex.impulses, of_set.impulses);
    }
}
