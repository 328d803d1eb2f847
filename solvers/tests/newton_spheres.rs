//! The active set between spheres with friction: known answers, the plane laid into space, and packings.

use crate::friction::rough;
use crate::problems::{collected, packing};
use crate::rough_spheres::{embedded, roughened};
use crate::spheres::sphere_problem_of;
use active_set::{ActiveSet, Start};
use analysis::Meter;
use contact::{
    Iteration, Packing, RoughContact, RoughDiscs, RoughMass, RoughSpheres, Solver, Spheres, Truth, frame,
};
use nalgebra::{Vector2, Vector3, Vector6};
use nsgs::Nsgs;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use reference::{RoughSolution, certify, continued, distance, polished, solve_rough};
use runner::{Stop, solve};

/// Newton's method from the start impulses.
const AT_ONCE: ActiveSet = ActiveSet { start: Some(Start::ColdSet), start_accuracy: None, warm: true };

/// Contacts between spheres of radius 0.5 m and mass 1 kg, or with walls, each given by its grains and normal.
fn spheres(
    free: &[Vector3<f64>],
    contacts: &[(u32, Option<u32>, Vector3<f64>)],
    friction: f64,
) -> Packing<RoughSpheres> {
    let contact = |(candidate, antagonist, normal): &(u32, Option<u32>, Vector3<f64>)| RoughContact {
        candidate: *candidate,
        antagonist: *antagonist,
        normal: *normal,
        arms: Vector2::new(0.5, if antagonist.is_some() { 0.5 } else { 0.0 }),
        offset: Vector3::zeros(),
        friction,
    };
    Packing::new(
        vec![RoughMass { mass: 1.0, inertia: 0.1 }; free.len()],
        (0..free.len()).map(|k| Vector3::new(0.0, 0.5 + k as f64, 0.0)).collect(),
        free.iter().map(|v| Vector6::new(v.x, v.y, v.z, 0.0, 0.0, 0.0)).collect(),
        contacts.iter().map(contact).collect(),
    )
    .unwrap()
}

/// The impulses at which a run ends, or those after so many iterations; and whether it ended.
fn ended(
    method: &ActiveSet,
    problem: &Packing<RoughSpheres>,
    r0: &[f64],
    most: u32,
) -> (Vec<f64>, bool, u64) {
    let mut run: Box<dyn Iteration + '_> = method.start(problem, r0).unwrap();
    let mut iterations = 0;
    while !run.stalled() && iterations < most {
        run.advance();
        iterations += 1;
    }
    let mut r = r0.to_vec();
    run.impulses(&mut r);
    (r, run.stalled(), run.work().factorisations)
}

fn solution(problem: &Packing<RoughSpheres>) -> Vec<f64> {
    let none = vec![0.0; problem.impulse_count()];
    let (r, is_ended, _) = ended(&ActiveSet::default(), problem, &none, 20_000);
    assert!(is_ended);
    let certificate = certify(problem, &r);
    assert!(certificate.certified(), "{certificate}");
    r
}

/// It sticks where |v_t| ≤ 3.5 μ |v_n|, with r_t = −(2/7) v_t; else r_t = μ r_n against v_t, whichever way that is.
#[test]
fn sphere_on_a_floor_sticks_or_slides() {
    for across in [Vector3::x(), Vector3::new(0.6, 0.0, -0.8), Vector3::new(-0.28, 0.0, 0.96)] {
        for (speed, friction) in [(0.9, 0.3), (1.2, 0.3), (1e-9, 0.3), (1e-9, 0.0), (1e9, 0.3)] {
            let problem = spheres(&[across * speed - Vector3::y()], &[(0, None, Vector3::y())], friction);
            let r = solution(&problem);
            let [first, second] = frame(&Vector3::y());
            let along = first * r[1] + second * r[2];
            let expected = across * -f64::min(speed * 2.0 / 7.0, friction);
            assert!((r[0] - 1.0).abs() < 1e-14, "{r:?}");
            assert!((along - expected).norm() < 1e-14, "{speed} {friction}: {along:?} {expected:?}");
        }
    }
}

/// The lowest contact of a stack carries all of it, and nothing acts across.
#[test]
fn stack_carries_its_weight() {
    let count = 6_u32;
    let contacts: Vec<_> = (0..count).map(|k| (k, k.checked_sub(1), Vector3::y())).collect();
    let problem = spheres(&vec![-Vector3::y(); count as usize], &contacts, 0.3);
    let r = solution(&problem);
    for (r, above) in r.chunks_exact(3).zip((1..=count).rev()) {
        assert!((r[0] - f64::from(above)).abs() < 1e-12 * f64::from(above), "{r:?}");
        assert!(r[1].hypot(r[2]) < 1e-12, "{r:?}");
    }
}

/// Four spheres as a pyramid on a floor stand by friction, or slide apart; either way alike in all three directions.
#[test]
fn pyramid_stands_or_slides_apart_alike_all_around() {
    let apex = Vector3::new(0.0, (2.0_f64 / 3.0).sqrt(), 0.0);
    let low = |k: u32| {
        let angle = f64::from(k) * std::f64::consts::TAU / 3.0;
        Vector3::new(angle.cos(), 0.0, angle.sin()) / 3.0_f64.sqrt()
    };
    let mut contacts: Vec<_> = (0..3).map(|k| (k, None, Vector3::y())).collect();
    contacts.extend((0..3).map(|k| (3, Some(k), apex - low(k))));
    for friction in [0.05, 0.8] {
        let problem = spheres(&[-Vector3::y(); 4], &contacts, friction);
        let r = solution(&problem);
        let floor: f64 = (0..3).map(|k| r[3 * k]).sum();
        for k in [0, 1, 2] {
            assert!((r[3 * k] - floor / 3.0).abs() < 1e-12, "{friction}: {r:?}");
        }
        // The apex falls where it slides: the floor does not stop all.
        assert_eq!(floor < 4.0 - 1e-9, friction < 0.1, "{floor}");
    }
}

/// A packing of the plane laid into space has the solutions that it has in the plane.
#[test]
fn layer_in_space_is_solved_by_impulses_of_the_plane() {
    let flat = crate::friction::with_friction(&rough("rough-991-mu08").problem, 0.3);
    let known = &solve_rough(&flat, 0..=0, || {})[0];
    assert!(known.certificate.certified());
    let laid = embedded(&flat);
    let mut r = vec![0.0; laid.impulse_count()];
    for (k, contact) in laid.contacts().iter().enumerate() {
        let tangent = Vector3::new(-contact.normal.y, contact.normal.x, 0.0);
        let [first, second] = frame(&contact.normal).map(|t| t.dot(&tangent));
        let [normal, along] = [known.impulses[2 * k], known.impulses[2 * k + 1]];
        r[3 * k..3 * k + 3].copy_from_slice(&[normal, first * along, second * along]);
    }
    assert!(certify(&laid, &r).certified());
    // From it nothing moves; from near it Newton's method comes back.
    let (stays, is_ended, factorisations) = ended(&AT_ONCE, &laid, &r, 10);
    assert!(is_ended && factorisations <= 1 && certify(&laid, &stays).certified());
    let near: Vec<f64> = r.iter().map(|r| r * (1.0 + 1e-6)).collect();
    assert!(!certify(&laid, &near).certified());
    let found = polished(&laid, &near).unwrap();
    assert!(distance(&laid, &r, &found.impulses) < 1e-6);
}

#[test]
fn without_friction_it_finds_the_frictionless_solution() {
    let (smooth, radius) = sphere_problem_of("sphere-box", 30);
    let problem = roughened(&smooth, &radius, 0.0);
    let r = solution(&problem);
    let stop = Stop { tolerance: 1e-13, ..Stop::default() };
    let none = vec![0.0; smooth.impulse_count()];
    let outcome = solve::<Spheres>(&ActiveSet::default(), &smooth, &none, &stop, &mut |_| {}).unwrap();
    let mut velocity = vec![Vector6::zeros(); problem.grain_count()];
    problem.velocity(&r, &mut velocity);
    let truth = Truth::new(&smooth, &outcome.impulses);
    let fastest = truth.velocity().iter().map(Vector3::norm).fold(0.0, f64::max);
    for (one, other) in velocity.iter().zip(truth.velocity()) {
        assert!((one.fixed_rows::<3>(0) - other).norm() < 1e-10 * fastest, "{one:?} {other:?}");
    }
}

/// Where friction is switched on while the spheres fall, it ends at a solution, and from there stays.
#[test]
fn falling_packing_is_certified_and_its_solution_stays() {
    for (friction, seed) in [(0.1, 0), (0.5, 0), (0.5, 7)] {
        let (smooth, radius) = sphere_problem_of("sphere-box", 60);
        let problem = roughened(&smooth, &radius, friction);
        let found: Vec<RoughSolution> = solve_rough(&problem, seed..=seed, || {});
        assert!(found[0].certificate.certified(), "{friction}: {}", found[0].certificate);
        let (r, is_ended, factorisations) = ended(&AT_ONCE, &problem, &found[0].impulses, 3);
        assert!(is_ended && factorisations <= 2, "{factorisations}");
        assert!(certify(&problem, &r).certified());
    }
}

/// This packing at rest has gaps that are about to close by 1e-10 m. A continuation from gaps that close as fast as grains fall leads to a
/// solution; so do the stages of the active set from r = 0.
#[test]
fn continuation_in_the_offsets_certifies_a_packing_at_rest() {
    let problem: Packing<RoughSpheres> = collected("44a8d6e018183ffa");
    let (r, _, _) = ended(&ActiveSet::default(), &problem, &vec![0.0; problem.impulse_count()], 20_000);
    assert!(certify(&problem, &r).certified());
    let found = continued(&problem, || {}).unwrap();
    assert!(found.certificate.certified(), "{}", found.certificate);
    assert!(certify(&problem, &found.impulses).certified());
    // What moves has no such way: `None` at once.
    let driven: Packing<RoughDiscs> = packing("rough-991-onset");
    assert!(continued(&driven, || panic!("no search")).is_none());
}

/// More sticks than motion allows in this packing at rest: impulses drift, and no method that we know ends. What is returned leaves a
/// tenth of what 5000 sweeps of Gauss-Seidel do, at most, and is admissible.
#[test]
fn packing_at_rest_comes_nearer_than_sweeps() {
    let problem: Packing<RoughSpheres> = packing("rough-spheres-250-unconverged");
    let none = vec![0.0; problem.impulse_count()];
    let (r, is_ended, _) = ended(&ActiveSet::default(), &problem, &none, 9000);
    assert!(is_ended, "a floor is an end");
    let left = |r: &[f64]| Meter::new(&problem).measure_after(&[], r, 0.0).natural_map;
    let stop = Stop { tolerance: 0.0, max_iterations: 5000, ..Stop::default() };
    let swept = solve(&Nsgs::default(), &problem, &none, &stop, &mut |_| {}).unwrap();
    assert!(left(&r) < 0.1 * left(&swept.impulses), "{:e} {:e}", left(&r), left(&swept.impulses));
    assert!(left(&r) < 1e-10, "{:e}", left(&r));
    assert!(
        r.chunks_exact(3)
            .zip(problem.contacts())
            .all(|(r, at)| { r[0] >= 0.0 && r[1].hypot(r[2]) <= (1.0 + 1e-12) * at.friction * r[0] })
    );
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 12,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Whatever the contacts are, it ends: certified, or with impulses that leave no more than none do.
    #[test]
    fn random_packings_end(
        normals in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..12),
        ends in prop::collection::vec((0..4_u32, 0..5_u32), 12),
        free in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 4),
        friction in 0.0..1.5_f64,
        cold in any::<bool>(),
    ) {
        let contacts: Vec<_> = normals
            .iter()
            .zip(&ends)
            .map(|(n, (i, j))| {
                let n = Vector3::from(*n);
                let n = if n.norm() < 0.1 { Vector3::y() } else { n.normalize() };
                (*i, (*j < 4 && i != j).then_some(*j), n)
            })
            .collect();
        let free: Vec<_> = free.iter().map(|v| Vector3::from(*v)).collect();
        let problem = spheres(&free, &contacts, friction);
        let method =
            ActiveSet { start: cold.then_some(Start::ColdSet), ..ActiveSet::default() };
        let none = vec![0.0; problem.impulse_count()];
        let (r, is_ended, _) = ended(&method, &problem, &none, 40_000);
        prop_assert!(is_ended);
        prop_assert!(r.iter().all(|r| r.is_finite()));
        let left = |r: &[f64]| {
            Meter::new(&problem).measure_after(&[], r, 0.0).natural_map
        };
        prop_assert!(left(&r) <= left(&none) * (1.0 + 1e-12) || certify(&problem, &r).certified());
    }
}
