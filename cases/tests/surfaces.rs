//! Polygons, rods and hollow cylinders among spheres, and what turns: known answers.

use crate::common::{scene_of_discs, scene_of_spheres};
use cases::{Case, March, Marched, Observables};
use contact::{Discs, Measure, RoughDiscs, RoughSpheres, Solver, Spheres};
use nalgebra::{Vector2, Vector3};
use nsgs::Nsgs;
use runner::{Outcome, Stop};

const G: f64 = 10.0;
const H: f64 = 0.01;
/// A sphere of 0.5 m (kg).
const MASS: f64 = 1000.0 * std::f64::consts::PI / 6.0;

/// Spheres, as [x, y, z, radius], among surfaces.
fn scene(spheres: &str, surfaces: &str) -> Result<Case, String> {
    scene_of_spheres(spheres, H, &format!("gravity_m_per_s2 = {G:?}\n{surfaces}"))
}

fn time_step<M: Marched>(march: &mut March<M>) -> (Outcome, Observables)
where
    Nsgs: Solver<M>,
{
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-13, max_iterations: 10_000 };
    march.time_step(&Nsgs::default(), &stop).unwrap()
}

fn after(case: &Case, time_steps: u32) -> (Outcome, March<Spheres>) {
    let mut march = March::<Spheres>::new(case).unwrap();
    let last = (0..time_steps).map(|_| time_step(&mut march).0).last();
    (last.unwrap(), march)
}

fn place<M: Marched>(march: &March<M>) -> M::Place {
    march.grains().next().unwrap().1
}

fn near(is: f64, expected: f64) {
    assert!((is - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{is} for {expected}");
}

/// A level square of two metres at a height of 1 m, from `x`.
fn square(x: f64) -> String {
    let to = x + 2.0;
    format!(
        "[[scene.segments]]\ncorners_m = [[{x:?}, 1.0, 0.0], [{to:?}, 1.0, 0.0], [{to:?}, 1.0, 2.0], [{x:?}, 1.0, 2.0]]\n"
    )
}

#[test]
fn level_polygon_carries_the_weight_on_its_face_its_edge_and_its_corner() {
    let (outcome, march) = after(&scene("[[1.0, 1.5, 1.0, 0.5]]", &square(0.0)).unwrap(), 5);
    near(outcome.impulses[0], MASS * G * H);
    near(march.velocity()[0].norm(), 0.0);
    // Beyond an edge, 3-4-5: 0.8 of the weight acts along the normal, and so beyond a corner, 2-3-6.
    let (outcome, _) = after(&scene("[[2.3, 1.4, 1.0, 0.5]]", &square(0.0)).unwrap(), 1);
    near(outcome.impulses[0], 0.8 * MASS * G * H);
    let corner = "[[2.2, 1.3, 2.6, 0.7]]";
    let (outcome, _) = after(&scene(corner, &square(0.0)).unwrap(), 1);
    near(outcome.impulses[0], 3.0 / 7.0 * MASS * 2.744 * G * H);
    // From below it holds nothing, and stops what comes.
    let (_, march) = after(&scene("[[1.0, 0.5, 1.0, 0.5]]", &square(0.0)).unwrap(), 5);
    near(march.velocity()[0].y, -5.0 * G * H);
    let thrown = format!("thrown_at_m_per_s = [0.0, 3.0]\n{}", square(0.0));
    let (_, march) = after(&scene("[[1.0, 0.5, 1.0, 0.5]]", &thrown).unwrap(), 1);
    near(march.velocity()[0].y, 0.0);
}

/// A sphere slides without friction over a joint in a plane, and keeps its speed; the same over a joint that no edge is shared at.
#[test]
fn joint_in_a_plane_is_not_felt() {
    let thrown = |surfaces: &str| format!("thrown_at_m_per_s = [2.0, 0.0]\n{surfaces}");
    let long = "[[scene.segments]]\ncorners_m = [[2.0, 1.0, -3.0], [9.0, 1.0, -3.0], [9.0, 1.0, 7.0], [2.0, 1.0, 7.0]]\n";
    for second in [square(2.0), long.to_owned()] {
        let case = scene("[[1.0, 1.5, 1.0, 0.5]]", &thrown(&(square(0.0) + &second))).unwrap();
        let mut march = March::<Spheres>::new(&case).unwrap();
        for _ in 0..120 {
            let (outcome, _) = time_step(&mut march);
            assert_eq!(outcome.impulses.len(), 1, "one contact at {}", place(&march).x);
            near(march.velocity()[0].x, 2.0);
            near(place(&march).y, 1.5);
        }
        assert!(place(&march).x > 3.3);
    }
}

/// Down a slope of 45° onto a level plane: the sphere touches both planes in the corner and loses what points into the second alone.
#[test]
fn corner_between_polygons_stops_what_points_into_it_and_nothing_sinks() {
    let down = "[[scene.segments]]\ncorners_m = [[0.0, 1.0, 0.0], [0.0, 1.0, 2.0], [-3.0, 4.0, 2.0], [-3.0, 4.0, 0.0]]\n";
    let root = std::f64::consts::FRAC_1_SQRT_2;
    let (x, y) = (-1.5 + 0.5 * root, 2.5 + 0.5 * root);
    let case = scene(&format!("[[{x:?}, {y:?}, 1.0, 0.5]]"), &(square(0.0) + down)).unwrap();
    let mut march = March::<Spheres>::new(&case).unwrap();
    let mut fastest: f64 = 0.0;
    for _ in 0..110 {
        let (_, seen) = time_step(&mut march);
        assert!(seen.greatest_overlap < 1e-9, "{} at {:?}", seen.greatest_overlap, place(&march));
        fastest = fastest.max(seen.greatest_speed);
    }
    near(place(&march).y, 1.5);
    let along = march.velocity()[0].x;
    assert!((along / fastest - root).abs() < 0.02, "{along} of {fastest}");
}

#[test]
fn sphere_rolls_off_an_edge_that_two_polygons_share_with_one_contact() {
    // A ridge: its edge along z at x = 2, y = 1.
    let down = "[[scene.segments]]\ncorners_m = [[2.0, 1.0, 0.0], [2.0, 1.0, 2.0], [2.0, -1.0, 2.0], [2.0, -1.0, 0.0]]\n";
    let case = scene("[[2.3, 1.4, 1.0, 0.5]]", &(square(0.0) + down)).unwrap();
    let (outcome, _) = after(&case, 1);
    assert_eq!(outcome.impulses.len(), 1);
    near(outcome.impulses[0], 0.8 * MASS * G * H);
}

#[test]
fn rod_and_ball_are_touched_from_outside_and_a_hollow_cylinder_from_both_sides() {
    let rod = "[[scene.segments]]\nfrom_m = [0.0, 0.0, -3.0]\nto_m = [0.0, 0.0, 3.0]\nradius_m = 0.5\n";
    let (outcome, _) = after(&scene("[[0.6, 0.8, 0.0, 0.5]]", rod).unwrap(), 1);
    near(outcome.impulses[0], 0.8 * MASS * G * H);
    let ball = "[[scene.segments]]\nfrom_m = [0.0, 0.0, 0.0]\nradius_m = 0.5\n";
    let (outcome, _) = after(&scene("[[0.0, 0.8, 0.6, 0.5]]", ball).unwrap(), 1);
    near(outcome.impulses[0], 0.8 * MASS * G * H);
    let tube = "[[scene.segments]]\nfrom_m = [0.0, 0.0, -3.0]\nto_m = [0.0, 0.0, 3.0]\nradius_m = 2.0\nhollow = true\n";
    let (outcome, march) = after(&scene("[[0.0, -1.5, 0.0, 0.5]]", tube).unwrap(), 3);
    near(outcome.impulses[0], MASS * G * H);
    near(march.velocity()[0].norm(), 0.0);
    let (outcome, _) = after(&scene("[[0.0, 2.5, 0.0, 0.5]]", tube).unwrap(), 1);
    near(outcome.impulses[0], MASS * G * H);
    // On its rim, 0.3 m beyond the end: 3-4-5.
    let (outcome, _) = after(&scene("[[0.0, 2.4, 3.3, 0.5]]", tube).unwrap(), 1);
    near(outcome.impulses[0], 0.8 * MASS * G * H);
}

/// A sphere that swings without friction in a hollow cylinder keeps its energy, and does not sink into the wall.
#[test]
fn sphere_swings_in_a_hollow_cylinder_without_sinking() {
    let tube = "[[scene.segments]]\nfrom_m = [0.0, 0.0, -3.0]\nto_m = [0.0, 0.0, 3.0]\nradius_m = 2.0\nhollow = true\n";
    let mut march = March::<Spheres>::new(&scene("[[1.5, 0.0, 0.0, 0.5]]", tube).unwrap()).unwrap();
    let mut highest = f64::MIN;
    for k in 0..600 {
        let (_, seen) = time_step(&mut march);
        assert!(seen.greatest_overlap < 1e-4, "{}", seen.greatest_overlap);
        if k > 300 {
            highest = highest.max(place(&march).y);
        }
    }
    assert!(highest > -0.05 && highest < 0.05, "the height it began at: {highest}");
}

/// A tray that turns about an axis far below carries a disc, and a sphere, with it: friction, not the gap, moves it.
#[test]
fn tray_that_turns_carries_what_lies_on_it_in_both_dimensions() {
    let turning = |axis: &str, about: &str| {
        format!("[scene.segments.turning]\nabout_m = {about}\n{axis}rate_rad_per_s = 0.2\n")
    };
    let plane = format!(
        "gravity_m_per_s2 = 10.0\nfriction = 0.8\n[[scene.segments]]\nfrom_m = [-2.0, 1.0]\nto_m = [2.0, 1.0]\n{}",
        turning("", "[0.0, 0.0]")
    );
    // Two discs side by side cannot roll apart uphill; one alone would roll, so a slope's angle stays small.
    let case = scene_of_discs("[[0.0, 1.5, 0.5]]", H, &plane).unwrap();
    let mut march = March::<RoughDiscs>::new(&case).unwrap();
    for k in 1..=50 {
        let (_, seen) = time_step(&mut march);
        // The chord of half a time step, 1.5 m (ω h)²/8 = 7.5e-7 m; and per time step ω h times what rolling moves less than free motion
        // does, a third of g sin φ h²: less than 7e-8 m at φ = 0.1, half of that on average over 50 of them.
        assert!(seen.greatest_overlap < 2.5e-6, "{}", seen.greatest_overlap);
        let turned = 0.2 * H * f64::from(k);
        // It stays on the tray: one radius above the line.
        let normal = Vector2::new(-turned.sin(), turned.cos());
        assert!((normal.dot(&place(&march)) - 1.5).abs() < 1e-5, "{}", normal.dot(&place(&march)));
        // Its surface moves with that of the tray, 1 m from the axis.
        let [tangent, v] = [Vector2::new(normal.y, -normal.x), march.velocity()[0].xy()];
        let sliding = v.dot(&tangent) + 0.5 * march.velocity()[0].z + 0.2;
        assert!(sliding.abs() < 1e-3, "{sliding}");
    }
    let space = square(-1.0) + &turning("axis = [0.0, 0.0, 1.0]\n", "[0.0, 0.0, 0.0]");
    let case = scene("[[0.0, 1.5, 1.0, 0.5]]", &format!("friction = 0.8\n{space}")).unwrap();
    let mut march = March::<RoughSpheres>::new(&case).unwrap();
    for k in 1..=50 {
        let (_, seen) = time_step(&mut march);
        // The chord of half a time step, 1.5 m (ω h)²/8 = 7.5e-7 m; and per time step ω h times what rolling moves less than free motion
        // does, a third of g sin φ h²: less than 7e-8 m at φ = 0.1, half of that on average over 50 of them.
        assert!(seen.greatest_overlap < 2.5e-6, "{}", seen.greatest_overlap);
        let turned = 0.2 * H * f64::from(k);
        let normal = Vector3::new(-turned.sin(), turned.cos(), 0.0);
        assert!((normal.dot(&place(&march)) - 1.5).abs() < 1e-5, "{}", normal.dot(&place(&march)));
    }
}

/// A paddle sweeps a disc along the floor at its speed there, ω times its distance.
#[test]
fn paddle_pushes_a_disc_at_the_speed_of_its_place() {
    let scene = "gravity_m_per_s2 = 10.0\n[scene.box]\n[[scene.segments]]\nfrom_m = [0.0, 0.0]\nto_m = [0.0, 3.0]\n\
                 [scene.segments.turning]\nabout_m = [0.0, 3.0]\nrate_rad_per_s = 0.5\n";
    let mut march = March::<Discs>::new(&scene_of_discs("[[0.5, 0.5, 0.5]]", H, scene).unwrap()).unwrap();
    for _ in 0..40 {
        time_step(&mut march);
    }
    // With the normal n = (cos φ, sin φ) of the line, one radius from it: (x − 0) cos φ + (0.5 − 3) sin φ = 0.5.
    let turned: f64 = 0.5 * H * 40.0;
    let x = |angle: f64| (0.5 + 2.5 * angle.sin()) / angle.cos();
    assert!((place(&march)[0] - x(turned)).abs() < 1e-2, "{} for {}", place(&march)[0], x(turned));
}

/// In the corner between a tube and the plate that it stands on, a sphere touches each once.
#[test]
fn rim_of_a_tube_that_stands_on_a_plate_is_not_felt() {
    let plate = "[[scene.segments]]\ncorners_m = [[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [9.0, 0.0, 9.0], [-9.0, 0.0, 9.0]]\n";
    let tube = "[[scene.segments]]\nfrom_m = [0.0, 0.0, 0.0]\nto_m = [0.0, 4.0, 0.0]\nradius_m = 2.0\nhollow = true\n";
    for order in [format!("{plate}{tube}"), format!("{tube}{plate}")] {
        let case = scene("[[1.5, 0.5, 0.0, 0.5]]", &format!("slope_rad = 0.6\n{order}")).unwrap();
        let (outcome, march) = after(&case, 5);
        let mut impulses = outcome.impulses;
        impulses.sort_by(f64::total_cmp);
        assert_eq!(impulses.len(), 2);
        near(impulses[0], MASS * G * H * 0.6_f64.sin());
        near(impulses[1], MASS * G * H * 0.6_f64.cos());
        near(march.velocity()[0].norm(), 0.0);
    }
}

#[test]
fn driven_polygon_falls_as_a_piston_and_a_removed_one_lets_go() {
    let piston = "[scene.segments.driven]\nmass_kg = 100.0\nforce_n = 0.0\ndirection = [0.0, -1.0, 0.0]\n";
    let floor = "[[scene.segments]]\ncorners_m = [[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [9.0, 0.0, 9.0], [-9.0, 0.0, 9.0]]\n";
    let case = scene("[[1.0, 0.5, 1.0, 0.5]]", &format!("{}{piston}{floor}", square(0.0))).unwrap();
    let (outcome, march) = after(&case, 3);
    // The sphere carries the piston: the floor both.
    let greatest = outcome.impulses.iter().copied().fold(0.0, f64::max);
    near(greatest, (MASS + 100.0) * G * H);
    near(march.velocity()[1].norm(), 0.0);
    let gate = square(0.0) + "removed_at_s = 0.03\n";
    let (_, march) = after(&scene("[[1.0, 1.5, 1.0, 0.5]]", &gate).unwrap(), 6);
    assert!(march.velocity()[0].y < -2.0 * G * H);
}

#[test]
fn surfaces_without_meaning_are_refused_by_key() {
    let refused = |surfaces: &str, words: &[&str]| {
        let case = scene("[[1.0, 5.5, 1.0, 0.5]]", surfaces);
        let error = match case {
            Err(error) => error,
            Ok(case) => March::<Spheres>::new(&case).unwrap_err().to_string(),
        };
        for word in words {
            assert!(error.contains(word), "no `{word}` in: {error}");
        }
    };
    let one = |keys: &str| format!("[[scene.segments]]\n{keys}\n");
    refused(
        &one("corners_m = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]"),
        &["scene.segments[0].corners_m", "2 corners"],
    );
    refused(
        &one("corners_m = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.5, 1.0], [0.0, 0.0, 1.0]]"),
        &["corners_m[", "off the plane"],
    );
    refused(
        &one("corners_m = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.5, 0.0, 0.5], [0.0, 0.0, 2.0]]"),
        &["corners_m[2]", "convex"],
    );
    let star = "corners_m = [[0.000000, 0.0, 1.000000], [0.587785, 0.0, -0.809017], [-0.951057, 0.0, 0.309017], [0.951057, 0.0, 0.309017], [-0.587785, 0.0, -0.809017]]";
    refused(&one(star), &["more than once"]);
    refused(&one("corners_m = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]"), &["no area"]);
    refused(&one("from_m = [0.5, 0.0]\nto_m = [1.0, 0.0]"), &["from_m", "2 numbers", "must have 3"]);
    refused(&one("radius_m = 1.0"), &["from_m", "corners_m"]);
    refused(&one("from_m = [0.0, 0.0, 0.0]\nradius_m = 1.0\nhollow = true"), &["hollow", "to_m"]);
    let turning = "corners_m = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0]]\nturning = { about_m = [0.0, 0.0, 0.0] }";
    refused(&one(turning), &["turning.axis", "missing"]);
    let disc =
        scene_of_discs("[[0.0, 9.5, 0.5]]", H, &format!("gravity_m_per_s2 = 10.0\n{}", square(0.0))).unwrap();
    let error = March::<Discs>::new(&disc).unwrap_err().to_string();
    assert!(error.contains("corners_m") && error.contains("for spheres"), "{error}");
}
