//! What is told of solutions with friction: whether one exists, whether it stands alone, and to which an iterate is polished.

use crate::friction::{given, rough, with_friction};
use crate::problems::frozen_path;
use active_set::ActiveSet;
use contact::{Packing, RoughContact, RoughDiscs, RoughMass, RoughSpheres, Solver};
use jacobi::Jacobi;
use nalgebra::{Matrix4, Vector2, Vector3, Vector6};
use nsgs::Nsgs;
use reference::{
    Existence, Isolation, certify, distance, existence, is_same, isolation, polished, solve_rough,
};
use runner::{Stop, solve};
use serde_json::Value;

/// A disc of 1 kg and 1 m with this free velocity, and walls by their normals and offsets, of one friction.
fn disc(free: Vector3<f64>, walls: &[([f64; 2], [f64; 2])], friction: f64) -> Packing<RoughDiscs> {
    let contact = |(normal, offset): &([f64; 2], [f64; 2])| RoughContact {
        candidate: 0,
        antagonist: None,
        normal: Vector2::from(*normal),
        arms: Vector2::new(1.0, 0.0),
        offset: Vector2::from(*offset),
        friction,
    };
    let mass = RoughMass { mass: 1.0, inertia: 0.5 };
    Packing::new(vec![mass], vec![Vector2::zeros()], vec![free], walls.iter().map(contact).collect()).unwrap()
}

const FLOOR: [f64; 2] = [0.0, 1.0];
const CEILING: [f64; 2] = [0.0, -1.0];
const DOWN: Vector3<f64> = Vector3::new(0.0, -1.0, 0.0);

#[test]
fn velocities_in_the_dual_cones_tell_that_a_solution_exists() {
    assert_eq!(existence(&disc(DOWN, &[(FLOOR, [0.0, 0.0])], 0.3)), Some(Existence::AtRest));
    // A belt takes the disc along; an open gap asks for nothing.
    assert_eq!(existence(&disc(DOWN, &[(FLOOR, [0.0, 0.5])], 0.3)), Some(Existence::Moving));
    assert_eq!(
        existence(&disc(DOWN, &[(FLOOR, [0.5, 0.0]), (CEILING, [0.1, 0.0])], 0.3)),
        Some(Existence::AtRest)
    );
    // Between two plates that close, nothing can be.
    assert_eq!(existence(&disc(DOWN, &[(FLOOR, [-1.0, 0.0]), (CEILING, [-1.0, 0.0])], 0.3)), None);
    // Whose contacts, each driven along itself, ask for one spin that none has: v_t = 0 only, as no gap opens.
    let driven =
        [(FLOOR, [0.0, 1.0]), (CEILING, [0.0, 1.0]), ([1.0, 0.0], [0.0, -1.0]), ([-1.0, 0.0], [0.0, -1.0])];
    assert_eq!(existence(&disc(DOWN, &driven, 0.3)), None);
    for frozen in ["rough-250", "rough-991-mu08", "rough-991-onset-unconverged"] {
        assert!(existence(&rough(frozen).problem).is_some(), "{frozen}");
    }
}

/// The impulses that end a run of the active set.
fn solved(problem: &Packing<RoughDiscs>) -> Vec<f64> {
    let stop = Stop { tolerance: 1e-14, ..Stop::default() };
    solve(&ActiveSet::default(), problem, &vec![0.0; problem.impulse_count()], &stop, &mut |_| {})
        .unwrap()
        .impulses
}

#[test]
fn a_solution_is_isolated_where_no_status_is_about_to_change_and_no_impulse_is_free() {
    let of = |problem: &Packing<RoughDiscs>| isolation(problem, &solved(problem));
    let across = |speed: f64| Vector3::new(speed, -1.0, 0.0);
    // It stops with r_t = −speed/3, and slides above 3 μ = 0.9.
    for (speed, unknowns) in [(0.0, 2), (0.8, 2), (1.0, 1)] {
        let alone = of(&disc(across(speed), &[(FLOOR, [0.0, 0.0])], 0.3));
        assert!(alone.is_isolated() && alone.unknowns == unknowns, "{speed}: {alone:?}");
        assert!((alone.least_singular_value - 1.0).abs() < 1e-12, "W itself, of one contact: {alone:?}");
    }
    let turning = of(&disc(across(0.9), &[(FLOOR, [0.0, 0.0])], 0.3));
    assert!(!turning.is_isolated() && turning.margin < 1e-12, "{turning:?}");
    // Held in a corner by two contacts that stick, its impulses are not unique.
    let corner = [(FLOOR, [0.0, 0.0]), ([1.0, 0.0], [0.0, 0.0])];
    let wedged = of(&disc(Vector3::new(-1.0, -1.0, 0.0), &corner, 0.9));
    assert!(!wedged.is_isolated() && wedged.least_singular_value < 1e-12, "{wedged:?}");
}

#[test]
fn in_space_the_derivative_of_a_turning_contact_is_that_of_the_law() {
    // A ball slides along a floor and a wall, and spins at both.
    let contact = |normal: Vector3<f64>| RoughContact {
        candidate: 0,
        antagonist: None,
        normal,
        arms: Vector2::new(0.5, 0.0),
        offset: Vector3::zeros(),
        friction: 0.2,
    };
    let mass = RoughMass { mass: 1.0, inertia: 0.1 };
    let free = Vector6::new(-0.6, -1.0, 2.0, 0.3, 0.2, -0.4);
    let walls = vec![contact(Vector3::y()), contact(Vector3::x())];
    let problem =
        Packing::<RoughSpheres>::new(vec![mass], vec![Vector3::zeros()], vec![free], walls).unwrap();
    let stop = Stop { tolerance: 1e-14, ..Stop::default() };
    let r = solve(&Nsgs::default(), &problem, &[0.0; 6], &stop, &mut |_| {}).unwrap().impulses;
    let found = isolation(&problem, &r);
    assert!(found.is_isolated() && found.unknowns == 4 && found.curvature > 1.0, "{found:?}");
    // By differences of R(ξ) = v(s(ξ)) − s(ξ) + ξ along the normal and across the direction of each contact, with ξ = s − v.
    let weight: Vec<f64> = problem.delassus_diagonal().iter().map(|w| w.sqrt()).collect();
    let v_of = |s: &[f64]| -> Vec<f64> {
        let r: Vec<f64> = s.iter().zip(&weight).map(|(s, w)| s / w).collect();
        let (mut velocity, mut v) = (vec![Vector6::zeros()], vec![0.0; 6]);
        problem.velocity(&r, &mut velocity);
        problem.relative_velocity(&velocity, &mut v);
        v.iter().zip(&weight).map(|(v, w)| v / w).collect()
    };
    let s: Vec<f64> = r.iter().zip(&weight).map(|(r, w)| r * w).collect();
    let xi: Vec<f64> = s.iter().zip(&v_of(&s)).map(|(s, v)| s - v).collect();
    let bound: Vec<f64> = (0..2).map(|k| 0.2 * weight[3 * k + 1] / weight[3 * k]).collect();
    let residual = |xi: &[f64]| -> Vec<f64> {
        let mut s = xi.to_vec();
        for (s, bound) in s.chunks_mut(3).zip(&bound) {
            let share = bound * s[0] / s[1].hypot(s[2]);
            s[1..].iter_mut().for_each(|s| *s *= share);
        }
        v_of(&s).iter().zip(&s).zip(xi).map(|((v, s), xi)| v - s + xi).collect()
    };
    let across = |k: usize| {
        let size = xi[3 * k + 1].hypot(xi[3 * k + 2]);
        let mut across = [0.0; 6];
        (across[3 * k + 1], across[3 * k + 2]) = (-xi[3 * k + 2] / size, xi[3 * k + 1] / size);
        across
    };
    let normal = |k: usize| std::array::from_fn::<f64, 6, _>(|at| f64::from(u8::from(at == 3 * k)));
    let axes = [normal(0), across(0), normal(1), across(1)];
    let step = 1e-6;
    let moved = |axis: &[f64; 6], step: f64| -> Vec<f64> {
        residual(&xi.iter().zip(axis).map(|(xi, a)| xi + step * a).collect::<Vec<_>>())
    };
    let derivative = Matrix4::from_fn(|row, col| {
        let difference = moved(&axes[col], step).into_iter().zip(moved(&axes[col], -step));
        difference.zip(axes[row]).map(|((a, b), axis)| (a - b) * axis).sum::<f64>() / (2.0 * step)
    });
    let least = derivative.singular_values().min();
    assert!((least - found.least_singular_value).abs() < 1e-6, "{least}: {found:?}");
}

#[test]
fn a_packing_has_isolated_solutions_and_some_whose_impulses_are_not_unique() {
    let problem = rough("rough-991-mu08").problem;
    let text = std::fs::read_to_string(frozen_path("rough-991-mu08.solution.json")).unwrap();
    let solution: Value = serde_json::from_str(&text).unwrap();
    let of = |r: &[f64]| isolation(&problem, r);
    let solutions = std::iter::once(&solution).chain(solution["other_solutions"].as_array().unwrap());
    let found: Vec<_> = solutions.map(|known| of(&given(known))).collect();
    let is_isolated: Vec<bool> = found.iter().map(Isolation::is_isolated).collect();
    assert_eq!(is_isolated, [true, false, true, false], "{found:?}");
    for (isolation, is_isolated) in found.iter().zip(is_isolated) {
        assert_eq!(
            isolation.least_singular_value > 1e-12,
            is_isolated,
            "impulses are unique, or not: {isolation:?}"
        );
    }
}

#[test]
fn an_iterate_near_a_solution_is_polished_to_it_and_one_far_away_to_none() {
    let problem = with_friction(&rough("rough-991-mu08").problem, 0.3);
    let solution = &solve_rough(&problem, 0..=0, || {})[0];
    assert!(solution.certificate.certified());
    let near: Vec<f64> = solution.impulses.iter().map(|r| r * (1.0 + 1e-6)).collect();
    assert!(!certify(&problem, &near).certified());
    let found = polished(&problem, &near).unwrap();
    assert!(found.certificate.certified());
    assert!(is_same(distance(&problem, &solution.impulses, &found.impulses)));
    assert_eq!(polished(&problem, &vec![0.0; problem.impulse_count()]), None);
}

/// What the last of so many sweeps moves, and what it leaves.
fn after(problem: &Packing<RoughDiscs>, sweeps: u64) -> (f64, f64) {
    let stop = Stop { tolerance: 0.0, max_iterations: sweeps, ..Stop::default() };
    let r0 = vec![0.0; problem.impulse_count()];
    let outcome = solve(&Nsgs::default(), problem, &r0, &stop, &mut |_| {}).unwrap();
    (outcome.last_change_moves, outcome.measures.natural_map)
}

#[test]
fn impulses_that_drift_along_the_kernel_are_told_from_those_that_only_change_slowly() {
    // More contacts stick than motion allows: from some thousand sweeps on nothing changes but impulses, by the same each time.
    let drifting = rough("rough-250").problem;
    let (early, late) = (after(&drifting, 4000), after(&drifting, 20_000));
    assert!(early.0 > 1e-3 && late.0 < 1e-6, "{early:?}, {late:?}");
    assert!((after(&drifting, 30_000).1 / late.1 - 1.0).abs() < 0.1, "it is a floor");
    let slow = rough("rough-991-mu08").problem;
    let (share, left) = after(&slow, 8000);
    assert!(share > 1e-3 && left > 1e-3, "{share:e}, {left:e}");
    // One contact: all of a change moves its grain, by W itself.
    let alone = solve(
        &Nsgs::default(),
        &disc(DOWN, &[(FLOOR, [0.0, 0.0])], 0.3),
        &[0.0; 2],
        &Stop::default(),
        &mut |_| {},
    );
    assert!((alone.unwrap().last_change_moves - 1.0).abs() < 1e-12);
}

#[test]
fn runs_that_go_round_in_a_cycle_are_told_from_those_that_drift() {
    // Three times the same contact: each stops the disc on its own, all together throw it back, so that none then acts.
    let thrice = disc(DOWN, &[(FLOOR, [0.0, 0.0]); 3], 0.3);
    let cycle = |solver: &dyn Solver<RoughDiscs>, problem: &Packing<RoughDiscs>, max_iterations: u64| {
        let stop = Stop { tolerance: 0.0, max_iterations, ..Stop::default() };
        let r0 = vec![0.0; problem.impulse_count()];
        solve(solver, problem, &r0, &stop, &mut |_| {}).unwrap().cycle
    };
    let jacobi = Jacobi { relaxation: 1.0, bounded: false, ..Jacobi::default() };
    assert_eq!([401, 400, 100].map(|most| cycle(&jacobi, &thrice, most)), [Some(2), Some(2), None]);
    assert_eq!(cycle(&Jacobi::default(), &thrice, 400), None, "it converges");
    assert_eq!(cycle(&Nsgs::default(), &rough("rough-250").problem, 12_000), None, "it drifts");
}
