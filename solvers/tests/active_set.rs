//! The active set: where it ends, what it shows on the way, and what it costs when it knows the set.

use crate::friction::{rough, with_friction};
use crate::problems::{PACKINGS, collected, first_problem, frozen, impulses, start};
use active_set::{ActiveSet, Start};
use analysis::Meter;
use cases::Marched;
use contact::acceleration::Acceleration;
use contact::{Iteration, Measure, Packing, RoughDiscs, RoughSpheres, Solver};
use nsgs::Nsgs;
use reference::{InteriorPoint, certify};
use runner::{Stop, solve};

const STARTS: [Start; 4] = [Start::Cg, Start::Sweeps, Start::ColdSet, Start::InteriorPoint];

fn method(start: Start) -> ActiveSet {
    ActiveSet { start: Some(start), ..ActiveSet::default() }
}

/// Advances until no further iteration helps; returns the impulses.
fn to_its_end(run: &mut dyn Iteration, problem: &Packing) -> Vec<f64> {
    for _ in 0..5000 {
        if run.stalled() {
            return impulses(run, problem);
        }
        run.advance();
    }
    panic!("it does not end");
}

/// ‖V − U‖_M of two impulses over ‖V − `V_free`‖_M.
pub(crate) fn distance(problem: &Packing, r: &[f64], other: &[f64]) -> f64 {
    let velocity = |r: &[f64]| {
        let mut velocity = problem.free_velocity().to_vec();
        problem.velocity(r, &mut velocity);
        velocity
    };
    let (v, u) = (velocity(r), velocity(other));
    problem.velocity_distance(&v, &u) / problem.velocity_distance(&v, problem.free_velocity())
}

/// Whatever the start, the guard against sets that wander among them, by itself.
#[test]
fn active_set_ends_certified_on_every_frozen_problem() {
    for name in PACKINGS.into_iter().chain(["settled-60", "settled-250"]) {
        let problem = frozen(name).problem;
        for begin in STARTS {
            let r = to_its_end(&mut *start(&method(begin), &problem), &problem);
            let certificate = certify(&problem, &r);
            assert!(certificate.certified(), "{name}, {begin:?}: {certificate}");
            let left = Meter::new(&problem).measure(&r, 0.0).natural_map;
            assert!(left < 1e-12, "{name}, {begin:?}: {left:e}");
        }
    }
}

/// Two witnesses that share no step: barriers with a factor of their own, and sets.
#[test]
fn active_set_and_interior_point_agree_on_every_frozen_problem() {
    for name in PACKINGS.into_iter().chain(["settled-60", "settled-250"]) {
        let problem = frozen(name).problem;
        let r = to_its_end(&mut *start(&ActiveSet::default(), &problem), &problem);
        let mut unpolished = start(&InteriorPoint { polish: false }, &problem);
        let distance = distance(&problem, &r, &to_its_end(&mut *unpolished, &problem));
        // The interior point leaves a gap of 1e-8, which is the square of this.
        assert!(distance < 1e-4, "{name}: {distance:e}");
        let polished = to_its_end(&mut *start(&InteriorPoint::default(), &problem), &problem);
        let distance = self::distance(&problem, &r, &polished);
        assert!(distance < 1e-10, "{name}, polished: {distance:e}");
    }
}

#[test]
fn set_of_the_solution_needs_one_factorisation() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        let r = to_its_end(&mut *start(&ActiveSet::default(), &problem), &problem);
        let mut from_it = ActiveSet::default().start(&problem, &r).unwrap();
        let again = to_its_end(&mut *from_it, &problem);
        assert_eq!(from_it.work().factorisations, 1, "{name}");
        assert!(distance(&problem, &again, &r) < 1e-10, "{name}");
        // In the place of conjugate gradients it is tried at once, unless it is not to be.
        for warm in [true, false] {
            let mut run = ActiveSet { warm, ..method(Start::Cg) }.start(&problem, &r).unwrap();
            run.advance();
            assert_eq!(run.work().factorisations, u64::from(warm), "{name}");
            assert!(distance(&problem, &to_its_end(&mut *run, &problem), &r) < 1e-10, "{name}, warm: {warm}");
        }
    }
}

/// With any equal impulses the law closes all contacts of a column, and all stay closed.
#[test]
fn set_of_a_column_that_begins_closed_is_its_last() {
    let problem = first_problem("column", &[("sample.grains", "30")]).problem;
    let mut run = method(Start::ColdSet).start(&problem, &[1e-6; 30]).unwrap();
    run.advance();
    assert!(run.stalled(), "round-off is left");
    assert_eq!(run.work().factorisations, 1);
    let (r, weight) = (impulses(&*run, &problem), problem.mass()[0] * 9.81);
    let h = -problem.free_velocity()[0].y / 9.81;
    let carried = r.iter().copied().fold(0.0, f64::max);
    assert!((carried / (30.0 * weight * h) - 1.0).abs() < 1e-9, "{carried}");
}

#[test]
fn what_the_active_set_shows_never_leaves_more_once_sets_have_begun() {
    for name in ["settled-991", "lmgc90-shear-991-t1"] {
        let problem = frozen(name).problem;
        for begin in [Start::ColdSet, Start::InteriorPoint] {
            let mut run = start(&method(begin), &problem);
            let mut meter = Meter::new(&problem);
            let mut before = f64::INFINITY;
            while !run.stalled() {
                run.advance();
                let left = meter.measure(&impulses(&*run, &problem), 0.0).natural_map;
                // What is shown is max(0, r): that takes a little away from impulses that are not quite 0.
                assert!(left <= 2.0 * before, "{name}, {begin:?}: {left:e} after {before:e}");
                before = left;
            }
        }
    }
}

/// One factorisation at most for each set or step, two passes over the factor in each solve, one to four solves, and a product with
/// each, besides that of the start.
#[test]
fn work_of_the_active_set_is_counted() {
    let problem = frozen("settled-250").problem;
    for begin in [Start::ColdSet, Start::InteriorPoint] {
        let mut run = start(&method(begin), &problem);
        run.advance();
        let first = run.work();
        assert_eq!(first.factorisations, 1);
        let mut iterations = 1;
        while !run.stalled() {
            run.advance();
            iterations += 1;
        }
        let work = run.work();
        let solves = work.triangular_solve_entries / first.triangular_solve_entries;
        assert!(work.factorisations <= iterations + 1 && work.factorisations >= 2, "{work:?}");
        assert!(solves >= iterations / 2 && solves <= 4 * iterations, "{work:?}");
        assert!(work.delassus_products > iterations, "{work:?}");
    }
    let cg: Box<dyn Solver> = Box::new(cg::Cg::preconditioned());
    let sweeps: Box<dyn Solver> = Box::new(Nsgs { acceleration: Acceleration::Nesterov, ..Nsgs::default() });
    for (begin, alone) in [(Start::Cg, cg), (Start::Sweeps, sweeps)] {
        let (mut run, mut alone) = (start(&method(begin), &problem), start(&*alone, &problem));
        // The impulses of the start have a velocity too, in either unknowns.
        let at_start = run.work().delassus_products - alone.work().delassus_products;
        for _ in 0..20 {
            run.advance();
            alone.advance();
            let (work, of_alone) = (run.work(), alone.work());
            assert_eq!(work.delassus_products, of_alone.delassus_products + at_start, "{begin:?}");
            assert_eq!(work.contact_updates, of_alone.contact_updates, "{begin:?}");
            assert_eq!(impulses(&*run, &problem), impulses(&*alone, &problem), "{begin:?}");
        }
    }
}

/// Solves `problem` from r = 0 in at most so many iterations, and certifies the end.
fn ends_certified(problem: &Packing<RoughDiscs>, most: u64) {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-12, max_iterations: most };
    let (method, none) = (ActiveSet::default(), vec![0.0; problem.impulse_count()]);
    let outcome = solve(&method, problem, &none, &stop, &mut |_| ()).unwrap();
    let certificate = certify(problem, &outcome.impulses);
    assert!(certificate.certified(), "{:?}, {certificate}", outcome.status);
}

#[test]
fn with_friction_it_ends_certified() {
    let problem = rough("rough-991-mu08").problem;
    for friction in [0.1, 0.3, 0.5] {
        ends_certified(&with_friction(&problem, friction), 4000);
    }
}

/// As walls move conjugate gradients stay at 1e-3, the fixed point over convex programmes and plain sweeps likewise.
#[test]
fn where_conjugate_gradients_stall_it_ends_certified() {
    for name in ["rough-991-onset-unconverged", "rough-991-sheared-unconverged"] {
        ends_certified(&rough(name).problem, 6000);
    }
}

#[test]
fn starts_that_a_mechanics_lacks_are_refused() {
    let frictional = rough("rough-250").problem;
    let refused =
        Solver::start(&method(Start::Cg), &frictional, &vec![0.0; frictional.impulse_count()]).err();
    let refused = refused.unwrap().to_string();
    assert!(refused.contains("cg is for problems without friction"), "{refused}");
}

/// From r = 0, at rest, where first-order methods and proximal points must choose load paths one after the other.
#[test]
fn an_interior_point_on_coulombs_law_comes_near_packings_at_rest() {
    fn comes_near<M: Marched>(id: &str)
    where
        ActiveSet: Solver<M>,
    {
        let problem: Packing<M> = collected(id);
        let r0 = vec![0.0; problem.impulse_count()];
        let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 100 };
        let outcome = solve(&method(Start::InteriorPoint), &problem, &r0, &stop, &mut |_| {}).unwrap();
        let (left, factors) = (outcome.measures.natural_map, outcome.work.factorisations);
        assert!(left <= 1e-6 && factors < 100, "{id}: {left:e} after {factors} factorisations");
    }
    for id in ["c0369210d81b5539", "41efad57949d3b5d", "7013599b0c791755"] {
        comes_near::<RoughDiscs>(id);
    }
    for id in ["c06f22eb4f93e389", "1cbba430b536aa60"] {
        comes_near::<RoughSpheres>(id);
    }
}
