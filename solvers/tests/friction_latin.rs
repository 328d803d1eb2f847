//! LATIN with friction: its counts on another code's packing, its fixed points, subdomains, and a known answer.

use crate::friction::{given, rough, with_friction};
use crate::problems::frozen_path;
use analysis::Meter;
use contact::{Measure, Packing, RoughContact, RoughDiscs, RoughMass, Solver, Truth};
use latin_dd::LatinDd;
use nalgebra::{Vector2, Vector3};
use partition::{Decomposition, Grid, Partition, Scheme};
use runner::{Status, Stop, solve};

/// The same packing whose contacts have no tangent.
pub(crate) fn smooth(problem: &Packing<RoughDiscs>) -> Packing {
    let smooth = problem.without_friction().unwrap();
    let (mass, v_free) = (smooth.mass().to_vec(), smooth.free_velocity().to_vec());
    Packing::new(mass, problem.position().to_vec(), v_free, smooth.contacts().to_vec()).unwrap()
}

/// LATIN with κ = `kappa_l`.
fn latin(kappa_l: f64) -> LatinDd {
    LatinDd { kappa_l: Some(kappa_l), ..LatinDd::default() }
}

/// Iterations of LATIN from r = 0 to a natural map of `tolerance`, if it comes there within so many.
fn latin_to(problem: &Packing<RoughDiscs>, settings: LatinDd, tolerance: f64, most: u64) -> Option<u64> {
    let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: most };
    let r0 = vec![0.0; problem.impulse_count()];
    let outcome = solve(&settings, problem, &r0, &stop, &mut |_| ()).unwrap();
    (outcome.status == Status::Converged).then_some(outcome.iterations)
}

/// At μ = 0.8 nothing but a low direction comes near a solution; at 0.3 every direction does, and a steep one soonest.
#[test]
fn friction_decides_whether_a_steep_direction_of_latin_converges() {
    let problem = rough("rough-991-mu08").problem;
    let to_a_tenth = |kappa_l| latin_to(&problem, latin(kappa_l), 1e-1, 500);
    assert_eq!([3.0, 10.0, 30.0].map(to_a_tenth), [Some(55), None, None]);

    let problem = with_friction(&problem, 0.3);
    let to_1e_4 = |kappa_l| latin_to(&problem, latin(kappa_l), 1e-4, 1000).unwrap();
    let (low, steep) = (to_1e_4(3.0), to_1e_4(30.0));
    assert!(2 * steep < low, "{low} and {steep}");
}

#[test]
fn latin_on_subdomains_reaches_the_velocity_that_it_reaches_on_one() {
    let problem = with_friction(&rough("rough-991-mu08").problem, 0.05);
    let r0 = vec![0.0; problem.impulse_count()];
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-9, max_iterations: 2000 };
    let run = |subdomains, coarse| {
        let settings = LatinDd { subdomains, coarse, ..latin(30.0) };
        let outcome = solve(&settings, &problem, &r0, &stop, &mut |_| ()).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{subdomains}");
        assert!(outcome.measures.velocity_jump < 1e-10, "{:e} m/s", outcome.measures.velocity_jump);
        Truth::new(&problem, &outcome.impulses).velocity().to_vec()
    };
    let one = run(Grid::ONE, false);
    let size = problem.velocity_distance(problem.free_velocity(), &one);
    for coarse in [false, true] {
        let several = run(Grid::of(4, 2), coarse);
        // Ten times what the natural map was brought to.
        assert!(problem.velocity_distance(&one, &several) < 1e-8 * size, "coarse: {coarse}");
    }
}

/// A fixed point solves Coulomb's law, and the other way round: whatever the direction and the subdomains.
#[test]
fn latin_stays_at_the_solution_of_another_code() {
    let problem = rough("rough-991-mu08").problem;
    let text = std::fs::read_to_string(frozen_path("rough-991-mu08.solution.json")).unwrap();
    let solution = given(&serde_json::from_str(&text).unwrap());
    let mut velocity = vec![Vector3::zeros(); problem.grain_count()];
    problem.velocity(&solution, &mut velocity);
    let size = problem.velocity_distance(problem.free_velocity(), &velocity);
    let mut meter = Meter::new(&problem);
    for (subdomains, kappa_l) in [(Grid::ONE, 3.0), (Grid::ONE, 30.0), (Grid::of(4, 2), 30.0)] {
        let settings = LatinDd { subdomains, kappa_t: 2.0, ..latin(kappa_l) };
        let mut run = Solver::<RoughDiscs>::start(&settings, &problem, &solution).unwrap();
        let (mut r, mut moved) = (solution.clone(), velocity.clone());
        for _ in 0..5 {
            run.advance();
            run.impulses(&mut r);
            problem.velocity(&r, &mut moved);
            // The solution's own natural map is below 1e-12; the factor amplifies round-off by κ.
            assert!(meter.measure_after(&[], &r, 0.0).natural_map < 1e-11, "{subdomains}, κ = {kappa_l}");
            assert!(
                problem.velocity_distance(&velocity, &moved) < 1e-12 * size,
                "{subdomains}, κ = {kappa_l}"
            );
            assert!(run.velocity_jump() < 1e-13);
        }
    }
}

#[test]
fn latin_without_friction_has_the_iterates_of_a_mechanics_without_spins() {
    let rough = with_friction(&rough("rough-991-mu08").problem, 0.0);
    let smooth = smooth(&rough);
    let mut r = vec![f64::NAN; rough.impulse_count()];
    let mut normal = vec![f64::NAN; smooth.impulse_count()];
    for subdomains in [Grid::ONE, Grid::of(4, 2)] {
        let settings = LatinDd { subdomains, coarse: subdomains != Grid::ONE, ..latin(30.0) };
        let mut with_spins = settings.start(&rough, &vec![0.0; r.len()]).unwrap();
        let mut without = settings.start(&smooth, &vec![0.0; normal.len()]).unwrap();
        for k in 0..100 {
            with_spins.advance();
            without.advance();
            with_spins.impulses(&mut r);
            without.impulses(&mut normal);
            let greatest = normal.iter().copied().fold(0.0, f64::max);
            for (r, normal) in r.chunks_exact(2).zip(&normal) {
                assert!((r[0] - normal).abs() < 1e-12 * greatest, "{subdomains}, {k}: {} and {normal}", r[0]);
                assert_eq!(r[1], 0.0, "{subdomains}, {k}");
            }
        }
    }
}

#[test]
fn latin_exchanges_the_spins_of_copies_too() {
    let problem = rough("rough-991-mu08").problem;
    let subdomains = Grid::of(4, 2);
    let partition = Partition::of_contacts(&problem, Scheme::Boxes, subdomains).unwrap();
    let copies = Decomposition::new(&problem, &partition).copy_count() as u64;
    let settings = LatinDd { subdomains, ..latin(3.0) };
    let mut run = settings.start(&problem, &vec![0.0; problem.impulse_count()]).unwrap();
    (0..10).for_each(|_| run.advance());
    assert!(copies > 0);
    assert_eq!(run.work().interface_values, 10 * 3 * copies);
    assert_eq!(run.work().contact_updates, 10 * problem.contact_count() as u64);
    assert_eq!(run.work().factorisations, 8);
}

/// A disc thrown along a floor at 1 m/s, that also falls at 1 m/s: w_t = 3/m stops its lowest point and leaves it ⅔ m/s, unless
/// that takes more than μ times what stops the fall.
#[test]
fn disc_thrown_along_a_floor_rolls_at_two_thirds_or_slides() {
    let (m, radius) = (3.0, 0.2);
    for (friction, along, spin) in [(0.5, 2.0 / 3.0, -2.0 / 3.0), (0.1, 0.9, -0.2)] {
        let floor = RoughContact {
            candidate: 0,
            antagonist: None,
            normal: Vector2::y(),
            arms: Vector2::new(radius, 0.0),
            offset: Vector2::zeros(),
            friction,
        };
        let mass = RoughMass { mass: m, inertia: 0.5 * m * radius * radius };
        let thrown = Vector3::new(1.0, -1.0, 0.0);
        let position = vec![Vector2::zeros()];
        let problem = Packing::<RoughDiscs>::new(vec![mass], position, vec![thrown], vec![floor]).unwrap();
        let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 200 };
        let outcome = solve(&latin(1.0), &problem, &[0.0; 2], &stop, &mut |_| ()).unwrap();
        let expected = Vector3::new(along, 0.0, spin / radius);
        assert_eq!(outcome.status, Status::Converged);
        let velocity = Truth::new(&problem, &outcome.impulses).velocity()[0];
        assert!((velocity - expected).amax() < 1e-12, "μ = {friction}: {velocity}");
    }
}
