//! What is known of the cases, against what they give.

use analysis::proves_infeasible;
use cases::{Case, CaseError, Explosion, Frozen, March, Marched, Missed, Side, Start, detect};
use cg::Cg;
use contact::{Discs, Measure, RoughDiscs, RoughSpheres, Spheres, Truth};
use nalgebra::{Matrix3, Vector2, Vector3};
use nsgs::Nsgs;
use proptest::prelude::*;
use runner::{Status, Stop, solve};
use std::path::PathBuf;

const GRAVITY: f64 = 9.81;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn case(name: &str, overrides: &[(&str, &str)]) -> Case {
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    Case::read(&folder().join(name).with_extension("toml"), &overrides)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn march(name: &str, overrides: &[(&str, &str)]) -> March {
    March::new(&case(name, overrides)).unwrap()
}

fn rough_march(case: &Case) -> March<RoughDiscs> {
    March::new(case).unwrap()
}

fn tight() -> Stop {
    Stop { on: Measure::NaturalMap, tolerance: 1e-10, max_iterations: 100_000 }
}

/// Impulses on the floor: the contacts whose normal points up and that have no antagonist (N·s).
fn on_the_floor(frozen: &Frozen, r: &[f64]) -> f64 {
    let contacts = frozen.problem.contacts().iter().zip(r);
    contacts
        .filter(|(contact, _)| contact.antagonist.is_none() && contact.normal.y == 1.0)
        .map(|(_, r)| r)
        .sum()
}

#[test]
fn what_only_spheres_have_is_refused_of_discs() {
    let depth = case("settled-box", &[("scene.box.depth_m", "1.0")]);
    let error = March::<Discs>::new(&depth).unwrap_err().to_string();
    assert!(
        error.ends_with("`scene.box.depth_m` is 1: discs have no depth, so it must be left out"),
        "{error}"
    );
    let shaken = case("shaken-box", &[("scene.box.vibration.direction", "z")]);
    let error = March::<Discs>::new(&shaken).unwrap_err().to_string();
    assert!(error.contains("`scene.box.vibration.direction` is z: it must be x or y"), "{error}");
    assert!(March::<Discs>::new(&case("sphere-box", &[])).is_err());
}

/// Whether there are contacts in a time step of a march, up to the one whose problem is solved.
fn touches<M: Marched>(mut march: March<M>, solve_at: u64) -> bool {
    (0..solve_at).any(|_| {
        let next = march.next().unwrap();
        let problem = &next.frozen.problem;
        let r = vec![0.0; problem.impulse_count()];
        march.advance(&next, &r);
        !problem.contacts().is_empty()
    })
}

#[test]
fn every_case_file_is_named_as_it_says_and_makes_a_problem() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "toml") && !path.ends_with("Cargo.toml") {
            let case = Case::read(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(case.name, path.file_stem().unwrap().to_string_lossy());
            let touching = if case.in_space().unwrap() && case.scene.is_rough() {
                touches(March::<RoughSpheres>::new(&case).unwrap(), case.solve_at)
            } else if case.in_space().unwrap() {
                touches(March::<Spheres>::new(&case).unwrap(), case.solve_at)
            } else if case.scene.is_rough() {
                touches(rough_march(&case), case.solve_at)
            } else {
                touches(March::<Discs>::new(&case).unwrap(), case.solve_at)
            };
            assert!(touching, "{}", case.name);
            count += 1;
        }
    }
    assert!(count >= 5);
}

#[test]
fn two_discs_press_as_the_case_file_says() {
    let frozen = march("two-discs", &[]).next().unwrap().frozen;
    let r = solve(&Cg::default(), &frozen.problem, &frozen.start, &tight(), &mut |_| {}).unwrap().impulses;
    let area = std::f64::consts::PI;
    let weight = |discs: f64| discs * 1000.0 * area * GRAVITY * 0.005;
    assert_eq!(r.len(), 2);
    // The lower disc's contact with the floor, then that between the two; areas are π/4 and π.
    assert!((r[0] / weight(1.25) - 1.0).abs() < 1e-9, "{r:?}");
    assert!((r[1] / weight(1.0) - 1.0).abs() < 1e-9, "{r:?}");
    assert!(case("two-discs", &[]).known.contains(&format!("{:.2} and {:.2} N s", r[1], r[0])), "{r:?}");
}

#[test]
fn deposited_discs_have_the_two_contacts_that_hold_them_and_few_more() {
    let problem = march("deposited-box", &[]).next().unwrap().frozen.problem;
    let contacts = problem.contact_count();
    assert!((2 * 1000..2 * 1050).contains(&contacts), "{contacts}");
}

#[test]
fn disc_between_closing_walls_has_no_answer() {
    let problem = march("closing-walls", &[]).next().unwrap().frozen.problem;
    let b = problem.b();
    let wall = |k: &usize| problem.contacts()[*k].normal.x != 0.0;
    let walls: Vec<usize> = (0..problem.contact_count()).filter(wall).collect();
    assert_eq!((walls.len(), problem.contact_count()), (2, 3), "two walls and the floor");
    assert!(walls.iter().all(|k| (b[*k] + 0.1).abs() < 1e-12), "{b:?}");
    let equal: Vec<f64> = (0..3).map(|k| if walls.contains(&k) { 1.0 } else { 0.0 }).collect();
    assert!(proves_infeasible(&problem, &equal));
}

#[test]
fn crystal_at_rest_puts_its_whole_weight_on_the_floor() {
    let frozen = march("triangular", &[]).next().unwrap().frozen;
    let outcome = solve(&Cg::default(), &frozen.problem, &frozen.start, &tight(), &mut |_| {}).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    let weight: f64 = frozen.problem.mass().iter().sum::<f64>() * GRAVITY * frozen.time_step;
    assert!((on_the_floor(&frozen, &outcome.impulses) / weight - 1.0).abs() < 1e-6);
    assert!(
        Truth::new(&frozen.problem, &outcome.impulses).velocity().iter().all(|v| v.norm() < 1e-7),
        "nothing moves"
    );
    // More contacts than the 2 n velocities that they hold: impulses are not unique.
    assert!(frozen.problem.contact_count() > 2 * frozen.problem.grain_count());
}

#[test]
fn settled_box_comes_to_rest_on_its_floor_without_overlap() {
    let mut march = march("settled-box", &[("sample.grains", "60"), ("scene.box.width_m", "1.2")]);
    let stop = Stop { tolerance: 1e-8, ..tight() };
    for _ in 0..400 {
        let (_, observables) = march.time_step(&Cg::default(), &stop).unwrap();
        // v ≥ −gap/h holds to the tolerance; a gap is advanced to first order, which two discs of 0.1 m that slide by
        // 0.1 m/s past each other exceed by (h v)²/4R < 1e-6 m.
        assert!(observables.greatest_overlap < 1e-5, "{observables:?}");
    }
    let next = march.next().unwrap();
    let outcome =
        solve(&Cg::default(), &next.frozen.problem, &next.frozen.start, &stop, &mut |_| {}).unwrap();
    let observables = march.advance(&next, &outcome.impulses);
    let mass: f64 = next.frozen.problem.mass().iter().sum();
    // One thousandth of the speed that a grain gains in free fall over one time step.
    assert!(
        observables.kinetic_energy < 0.5 * mass * (1e-3 * GRAVITY * 0.005_f64).powi(2),
        "{observables:?}"
    );
    let weight = mass * GRAVITY * 0.005;
    let floor = on_the_floor(&next.frozen, &outcome.impulses);
    assert!((floor / weight - 1.0).abs() < 1e-3);
    // At rest the side walls hold each other's balance.
    let [shown, left, right, ..] = observables.wall_impulses;
    assert_eq!(shown, floor);
    assert!(left > 0.0 && (left - right).abs() < 1e-3 * weight, "{observables:?}");
}

#[test]
fn samples_follow_their_seed() {
    let sample = |seed| march("settled-box", &[("sample.seed", seed)]).next().unwrap().frozen.radius;
    assert_eq!(sample("5"), sample("5"));
    assert_ne!(sample("5"), sample("6"));
}

/// θ = ½ gives the exact parabola: y = y₀ − ½ g t².
#[test]
fn free_fall_is_exact() {
    let discs = "[[0.0, 100.0, 0.5]]";
    let mut march = march("two-discs", &[("sample.discs", discs), ("scene.law", "predicted-gap")]);
    let mut height = 0.0;
    for _ in 0..200 {
        height = march.time_step(&Cg::default(), &tight()).unwrap().1.mean_height;
    }
    assert!((height - (100.0 - 0.5 * GRAVITY)).abs() < 1e-10, "{height} m after 1 s");
}

/// A disc that falls by more than its diameter within a time step would pass others unseen.
#[test]
fn absurd_time_step_explodes_at_once() {
    let changes = [("sample.discs", "[[0.0, 100.0, 0.5]]"), ("scene.time_step_s", "1.0")];
    let error = march("two-discs", &changes).time_step(&Cg::default(), &tight()).unwrap_err();
    let Explosion::Speed { grain: 0, speed, bound } = (match error {
        CaseError::Exploded { time_step: 1, why, solved: None } => why,
        other => panic!("{other}"),
    }) else {
        panic!("of speed")
    };
    assert!((speed - GRAVITY).abs() < 1e-12 && bound == 1.0, "{speed} m/s, {bound} m/s");
}

/// The march until it explodes: how it is known, and the solve that it goes back to.
fn explosion(mut march: March, stop: &Stop) -> (Explosion, Option<Missed>) {
    loop {
        match march.time_step(&Nsgs::default(), stop) {
            Ok(_) => assert!(march.time_steps() < 1000, "no explosion"),
            Err(CaseError::Exploded { why, solved, .. }) => return (why, solved),
            Err(other) => panic!("{other}"),
        }
    }
}

/// Without impulses all grains fall through the floor: of a binary mixture the small one is below it first, long before
/// half the mean diameter.
#[test]
fn small_grain_beside_a_large_one_explodes_by_its_own_size() {
    let mixture = [("sample.discs", "[[0.0, 1.0, 1.0], [3.0, 0.05, 0.05]]")];
    let no_impulses = Stop { max_iterations: 0, ..tight() };
    let (why, solved) = explosion(march("two-discs", &mixture), &no_impulses);
    let Explosion::Overlap { grain: 1, overlap, bound } = why else { panic!("{why}") };
    // Within 0.1 s it falls at 1 m/s, 5 mm per time step.
    assert!(bound == 0.05 && (0.05..0.056).contains(&overlap), "{overlap} m, {bound} m");
    assert_eq!(solved.map(|missed| missed.status), Some(Status::IterationLimit));

    let falling = [
        ("sample.discs", "[[0.0, 105.0, 5.0], [20.0, 100.0, 0.05]]"),
        ("scene.time_step_s", "0.05"),
        ("scene.law", "predicted-gap"),
    ];
    let (why, solved) = explosion(march("two-discs", &falling), &tight());
    let Explosion::Speed { grain: 1, speed, bound } = why else { panic!("{why}") };
    assert!((bound - 2.0).abs() < 1e-12 && (2.0..2.5).contains(&speed), "{speed} m/s, {bound} m/s");
    assert_eq!(solved, None);
}

#[test]
fn explosion_goes_back_to_the_problem_without_solution() {
    let squeezed = march("closing-walls", &[("scene.box.closing_speed_m_per_s", "10.0")]);
    let (why, solved) = explosion(squeezed, &tight());
    assert!(matches!(why, Explosion::Overlap { grain: 0, bound: 0.5, .. }), "{why}");
    assert_eq!(solved.map(|missed| missed.status), Some(Status::Infeasible));
}

/// Impulses that grew for ever say nothing of the next time step; those of a solve that only ended early do.
#[test]
fn impulses_of_a_failed_time_step_do_not_begin_the_next() {
    let next_start = |stop: &Stop, expected| {
        let mut march = march("closing-walls", &[]);
        let (outcome, _) = march.time_step(&Nsgs::default(), stop).unwrap();
        assert_eq!(outcome.status, expected);
        assert!(outcome.impulses.iter().any(|r| *r > 0.0));
        (outcome.impulses, march.next().unwrap().frozen.start)
    };
    let (_, start) = next_start(&tight(), Status::Infeasible);
    assert!(start.len() == 3 && start.iter().all(|r| *r == 0.0), "{start:?}");
    let (impulses, start) = next_start(&Stop { max_iterations: 2, ..tight() }, Status::IterationLimit);
    assert_eq!(start, impulses);
}

#[test]
fn time_step_that_is_stopped_inside_its_solve_is_not_made() {
    let mut march = march("column", &[]);
    let next = march.next().unwrap();
    let asked = std::cell::Cell::new(0);
    let halt = || {
        asked.set(asked.get() + 1);
        asked.get() > 3
    };
    let stopped = march.solve(&next, &Cg::default(), &tight(), Start::Previous, &halt).unwrap_err();
    assert!(matches!(stopped, CaseError::Interrupted { time_step: 1, iterations: 3 }), "{stopped}");
    assert_eq!((march.time_steps(), march.next().unwrap().frozen), (0, next.frozen));
}

/// A disc that lies on a shaken floor moves with it, as long as the floor's acceleration is below g.
#[test]
fn disc_on_a_vibrating_floor_follows_it() {
    let shaken = [
        ("sample.discs", "[[0.0, 0.5, 0.5]]"),
        ("scene.time_step_s", "1e-3"),
        ("scene.box.vibration", "{ amplitude_m = 0.01, frequency_hz = 2.0, direction = \"y\" }"),
    ];
    let mut march = march("two-discs", &shaken);
    for _ in 0..1000 {
        let observables = march.time_step(&Cg::default(), &tight()).unwrap().1;
        let floor = 0.01 * (4.0 * std::f64::consts::PI * observables.time).sin();
        // The first detection, half a time step after the start, finds the floor risen into the disc, and the law leaves it
        // there. From then on the floor is followed exactly from one detection to the next; the end of a time step lies
        // between, where the chord is off by at most A (2πf)² h²/8.
        let late = 0.01 * (4.0 * std::f64::consts::PI * 0.5e-3).sin();
        assert!((observables.mean_height - 0.5 - floor + late).abs() < 2.1e-7, "{observables:?}");
    }
}

#[test]
fn impulses_of_a_contact_begin_the_next_time_step() {
    let mut march = march("column", &[]);
    let step = march.next().unwrap();
    assert!(step.frozen.start.iter().all(|r| *r == 0.0));
    let r = solve(&Cg::default(), &step.frozen.problem, &step.frozen.start, &tight(), &mut |_| {}).unwrap();
    march.advance(&step, &r.impulses);
    assert_eq!(march.next().unwrap().frozen.start, r.impulses);
}

/// The paper's law leaves a contact out that will not close; the other keeps it, with its gap in c.
#[test]
fn laws_treat_an_open_contact_each_in_its_way() {
    let floating = |law| {
        let discs = "[[0.0, 0.5, 0.5], [0.0, 1.5001, 0.5]]";
        march("two-discs", &[("sample.discs", discs), ("scene.law", law)]).next().unwrap().frozen
    };
    let (kept, left_out) = (floating("iqs"), floating("predicted-gap"));
    assert_eq!(kept.problem.contact_count(), 2);
    assert!((kept.problem.contacts()[1].offset - 0.0001 / 0.005).abs() < 1e-9);
    assert_eq!(left_out.problem.contact_count(), 1, "the two fall side by side: their gap stays open");
}

proptest! {
    #[test]
    fn cells_find_the_pairs_that_a_double_loop_finds(
        discs in prop::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64, 0.05..0.4_f64), 1..80),
        far in prop::option::of(-1e6..1e6_f64),
        reach in 0.0..0.3_f64,
    ) {
        let mut position: Vec<_> = discs.iter().map(|(x, y, _)| Vector2::new(*x, *y)).collect();
        let radius: Vec<_> = discs.iter().map(|(_, _, r)| *r).collect();
        if let Some(far) = far {
            position[0].x = far;
        }
        let found: Vec<_> =
            detect(&position, &radius, reach).iter().map(|pair| (pair.candidate, pair.antagonist)).collect();
        let mut expected = Vec::new();
        for i in 0..position.len() {
            for j in i + 1..position.len() {
                if (position[i] - position[j]).norm() - radius[i] - radius[j] <= reach {
                    expected.push((i as u32, Side::Grain(j as u32)));
                }
            }
        }
        prop_assert_eq!(found, expected);
    }
}

#[test]
fn unknown_key_of_a_change_is_named_with_its_file() {
    let changes = [("sample.grain".into(), "3".into())];
    let error = Case::read(&folder().join("column.toml"), &changes).unwrap_err().to_string();
    assert!(error.contains("column.toml") && error.contains("unknown field `grain`"), "{error}");
}

/// Thrust, weight and their directions, solved by `Cg`.
fn solved(name: &str, overrides: &[(&str, &str)]) -> (Frozen, runner::Outcome) {
    let frozen = march(name, overrides).next().unwrap().frozen;
    let outcome = solve(&Cg::default(), &frozen.problem, &frozen.start, &tight(), &mut |_| {}).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{name}");
    (frozen, outcome)
}

#[test]
fn flat_arch_carries_its_keystone_by_thrust() {
    for width in ["2.9", "2.99", "2.999"] {
        let (frozen, outcome) = solved("flat-arch", &[("scene.box.width_m", width)]);
        let weight = frozen.problem.mass()[1] * GRAVITY * frozen.time_step;
        let along: f64 = 0.5 * (width.parse::<f64>().unwrap() - 1.0);
        let thrust = weight / (2.0 * (1.0 - along * along).sqrt());
        let links = frozen.problem.contacts().iter().zip(&outcome.impulses);
        for (_, r) in links.filter(|(contact, _)| contact.antagonist.is_some()) {
            // The condition of the arch, 1/(1 − along²), times the residual.
            assert!((r / thrust - 1.0).abs() < 1e-6, "{r} N·s, {thrust} expected");
        }
        assert!(Truth::new(&frozen.problem, &outcome.impulses).velocity().iter().all(|v| v.norm() < 1e-6));
    }
}

#[test]
fn middle_disc_escapes_from_almost_closing_walls() {
    let (frozen, outcome) = solved("almost-closing", &[("scene.box.width_m", "2.9")]);
    let along: f64 = 0.95;
    // The outer discs follow the walls at 0.1 m/s: the link turns, and its end moves at right angles to it.
    let expected = 0.1 * along / (1.0 - along * along).sqrt();
    let truth = Truth::new(&frozen.problem, &outcome.impulses);
    assert!((truth.velocity()[1].y / expected - 1.0).abs() < 1e-6, "{:?}", truth.velocity());
}

#[test]
fn rollers_all_touch_the_floor_and_the_disc_above_and_carry_its_weight() {
    let (frozen, outcome) = solved("rollers", &[]);
    let problem = &frozen.problem;
    assert_eq!((problem.grain_count(), problem.contact_count()), (6, 10));
    assert!(frozen.gap.iter().all(|gap| gap.abs() < 1e-12), "{:?}", frozen.gap);
    let weight = problem.mass().iter().sum::<f64>() * GRAVITY * frozen.time_step;
    // The outer rollers are pushed aside, by a normal that is 1/40 off the vertical.
    let floor = on_the_floor(&frozen, &outcome.impulses);
    assert!(floor <= weight * (1.0 + 1e-9) && floor > 0.99 * weight, "{floor} of {weight} N·s");
}

#[test]
fn heavy_top_is_carried_by_every_contact_below_it() {
    let (frozen, outcome) = solved("heavy-top", &[]);
    let weight = |discs: f64| discs * frozen.problem.mass()[0] * GRAVITY * frozen.time_step;
    assert_eq!(frozen.problem.mass()[9], 100.0 * frozen.problem.mass()[0]);
    let floor = on_the_floor(&frozen, &outcome.impulses);
    assert!((floor / weight(109.0) - 1.0).abs() < 1e-6, "{floor} N·s");
}

#[test]
fn copies_of_contacts_change_no_velocity() {
    let solved = |copies| solved("copied-contacts", &[("scene.contact_copies", copies)]);
    let ((one, once), (two, twice)) = (solved("1"), solved("3"));
    assert_eq!(two.problem.contact_count(), 3 * one.problem.contact_count());
    let [once, twice] = [(&one, once), (&two, twice)].map(|(at, end)| Truth::new(&at.problem, &end.impulses));
    assert!(once.velocity().iter().zip(twice.velocity()).all(|(v, u)| (v - u).norm() < 1e-9));
}

#[test]
fn iterations_depend_on_no_units() {
    let ours = [
        ("sample.radius_m", "0.5"),
        ("sample.density_kg_per_m2", "1000.0"),
        ("scene.gravity_m_per_s2", "9.81"),
        ("scene.box.width_m", "8.0"),
    ];
    let ((_, si), (_, mm)) = (solved("units", &ours), solved("units", &[]));
    let apart = si.iterations.abs_diff(mm.iterations);
    assert!(apart <= si.iterations / 10, "{} in SI, {} in mm and tonnes", si.iterations, mm.iterations);
}

#[test]
fn weightless_crystal_has_nothing_to_solve() {
    let (_, outcome) = solved("weightless", &[]);
    assert_eq!((outcome.iterations, outcome.impulses.iter().sum::<f64>()), (0, 0.0));
}

#[test]
fn thrown_disc_begins_with_its_speed_and_no_other_moves() {
    let problem = march("impact", &[("scene.gravity_m_per_s2", "0.0")]).next().unwrap().frozen.problem;
    let moving: Vec<_> = problem.free_velocity().iter().filter(|v| v.norm() > 0.0).collect();
    assert_eq!(moving, [&Vector2::new(0.0, -10.0)]);
}

#[test]
fn squeezed_crystal_has_no_answer_and_its_thrust_proves_it() {
    let frozen = march("squeezed-crystal", &[]).next().unwrap().frozen;
    // Thrust along the lowest row, from wall to wall.
    let low = |grain: u32| frozen.problem.position()[grain as usize].y < 0.6;
    let level = |contact: &contact::Contact| contact.normal.y.abs() < 1e-12 && low(contact.candidate);
    let row: Vec<f64> =
        frozen.problem.contacts().iter().map(|contact| f64::from(u8::from(level(contact)))).collect();
    assert!(proves_infeasible(&frozen.problem, &row));
}

#[test]
fn shapes_that_do_not_fit_are_refused_by_key_and_value() {
    let refused = |name: &str, key: &str, value: &str| {
        let error = March::<Discs>::new(&case(name, &[(key, value)])).unwrap_err().to_string();
        assert!(error.contains(&format!("{name}.toml")) && error.contains(value), "{error}");
        error
    };
    assert!(refused("flat-arch", "scene.box.width_m", "3.5").contains("between 2 and 3"));
    assert!(refused("rollers", "sample.top_radius_m", "1").contains("too small for 5 rollers"));
    assert!(refused("intruder", "sample.intruder_radius_m", "-1").contains("`sample.intruder_radius_m`"));
}

/// Velocities [m/s, m/s, rad/s] of the discs of a case with friction after some time steps.
fn velocities(name: &str, overrides: &[(&str, &str)], time_steps: u64) -> Vec<[f64; 3]> {
    let mut march = rough_march(&case(name, overrides));
    let stop = Stop { tolerance: 1e-13, ..tight() };
    for _ in 0..time_steps {
        let (outcome, _) = march.time_step(&Nsgs::default(), &stop).unwrap();
        assert_eq!(outcome.status, Status::Converged);
    }
    march.velocity().iter().map(|v| [v.x, v.y, v.z]).collect()
}

fn assert_close(is: f64, expected: f64, what: &str) {
    assert!((is - expected).abs() < 1e-10, "{what}: {is}, {expected} expected");
}

#[test]
fn a_disc_rolls_down_a_slope_or_slides_as_its_friction_says() {
    for (friction, slope) in [(0.2_f64, 0.4_f64), (0.2, 0.6), (0.1, 0.5)] {
        let (mu, angle) = (friction.to_string(), slope.to_string());
        let overrides = [("scene.friction", mu.as_str()), ("scene.slope_rad", angle.as_str())];
        let [along, into, spin] = velocities("slope", &overrides, 50)[0];
        let (g, t) = (GRAVITY, 0.5);
        let rolls = slope.tan() <= 3.0 * friction;
        let sliding = g * (slope.sin() - friction * slope.cos());
        assert_close(along, t * if rolls { 2.0 / 3.0 * g * slope.sin() } else { sliding }, "along the slope");
        assert_close(into, 0.0, "into the slope");
        let of_sliding = t * 2.0 * friction * g * slope.cos() / 0.5;
        assert_close(-spin, if rolls { along / 0.5 } else { of_sliding }, "spin");
    }
}

#[test]
fn a_thrown_disc_rolls_at_two_thirds_of_its_speed() {
    assert_close(velocities("thrown-disc", &[], 20)[0][0], 0.8, "sliding");
    let [x, y, spin] = velocities("thrown-disc", &[], 40)[0];
    assert_close(x, 2.0 / 3.0, "rolling");
    assert_close(y, 0.0, "upwards");
    assert_close(spin, -x / 0.5, "spin");
}

#[test]
fn a_belt_takes_discs_along_at_a_third_of_its_speed() {
    for disc in velocities("belt", &[], 10) {
        assert_close(disc[0], 0.1, "sliding");
    }
    for disc in velocities("belt", &[], 30) {
        assert_close(disc[0], 0.5 / 3.0, "rolling on the belt");
    }
}

#[test]
fn a_stack_of_three_stands_or_falls() {
    let fastest = |overrides: &[(&str, &str)]| {
        velocities("stack-of-three", overrides, 20)
            .into_iter()
            .flatten()
            .fold(0.0, |v: f64, x| v.max(x.abs()))
    };
    assert!(fastest(&[]) < 1e-8);
    assert!(fastest(&[("scene.friction", "0.26")]) > 1e-3);
    assert!(fastest(&[("scene.box.friction", "0.085")]) > 1e-3);
}

#[test]
fn an_arch_stands_where_the_thrust_stays_within_the_cones() {
    // Balance of a side disc, horizontal and vertical, and of the keystone, in units of a weight: thrust at the keystone, tangential
    // impulse, thrust at the support.
    let (sine, root) = (0.5, f64::sqrt(0.5));
    let cosine = f64::sqrt(0.75);
    let balance = Matrix3::new(
        -cosine,
        -(sine + root),
        root,
        -sine,
        cosine + root,
        root,
        2.0 * sine,
        -2.0 * cosine,
        0.0,
    );
    let thrust = balance.lu().solve(&Vector3::new(0.0, 1.0, 1.0)).unwrap();
    let least = thrust.y / thrust.x;
    assert!((least - 0.14050).abs() < 1e-5 && (thrust.y / thrust.z - 0.09593).abs() < 1e-5, "{thrust}");
    let fastest = |friction: f64, scaled: bool| {
        let friction = friction.to_string();
        let mut overrides = vec![("scene.friction", friction.as_str())];
        if scaled {
            overrides.extend([
                ("sample.discs", "[[-1.7320508075688772e-3, 2e-3, 1e-3], [0.0, 3e-3, 1e-3], [1.7320508075688772e-3, 2e-3, 1e-3]]"),
                ("sample.density_kg_per_m2", "1e12"),
                ("scene.segments", "[{ from_m = [-3.1462643699419726e-3, 0.585786437626905e-3], radius_m = 1e-3 }, \
                    { from_m = [3.1462643699419726e-3, 0.585786437626905e-3], radius_m = 1e-3 }]"),
            ]);
        }
        velocities("arch", &overrides, 1).into_iter().flatten().fold(0.0, |v: f64, x| v.max(x.abs()))
    };
    for scaled in [false, true] {
        let of_gravity = 10.0 * 0.01;
        assert!(fastest(1.001 * least, scaled) < 1e-8 * of_gravity, "{scaled}");
        assert!(fastest(0.999 * least, scaled) > 1e-5 * of_gravity, "{scaled}");
    }
}

#[test]
fn a_box_with_friction_comes_to_rest_with_fewer_contacts_and_leans_on_its_walls() {
    let rest = |name: &str, overrides: &[(&str, &str)]| {
        let mut march = rough_march(&case(name, overrides));
        let stop = Stop { tolerance: 1e-6, ..tight() };
        let mut last = None;
        for _ in 0..200 {
            last = Some(march.time_step(&Cg::default(), &stop).unwrap().1);
        }
        last.unwrap()
    };
    let small = [("sample.grains", "60"), ("scene.box.width_m", "1.2")];
    let rough = rest("rough-box", &small);
    let smooth = rest("rough-box", &[small[0], small[1], ("scene.friction", "0.0")]);
    assert!(rough.kinetic_energy < 1e-3, "{rough:?}");
    let mass: f64 = rough_march(&case("rough-box", &small)).mass().iter().map(|mass| mass.mass).sum();
    let weight = mass * GRAVITY * 0.005;
    // Without friction the floor carries all.
    assert!((smooth.wall_impulses[0] / weight - 1.0).abs() < 0.02, "{smooth:?}, {weight}");
    assert!(rough.wall_impulses[0] < 0.99 * weight, "{rough:?}, {weight}");
}

#[test]
fn a_scene_without_friction_marches_alike_with_spins_that_nothing_moves() {
    let overrides = [("sample.grains", "60"), ("scene.box.width_m", "1.2")];
    let mut smooth = march("settled-box", &overrides);
    let mut rough = rough_march(&case("settled-box", &overrides));
    for _ in 0..50 {
        smooth.time_step(&Nsgs::default(), &tight()).unwrap();
        rough.time_step(&Nsgs::default(), &tight()).unwrap();
    }
    for ((_, x, v), (_, y, w)) in smooth.grains().zip(rough.grains()) {
        assert!((x - y).norm() < 1e-8 && (v - w).norm() < 1e-6, "{x} {y} {v} {w}");
    }
}
