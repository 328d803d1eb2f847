//! Discs on lines of segments, against the line as a whole; and segments that no disc passes.

use crate::common::scene_of_discs;
use cases::{Case, CaseError, Explosion, March};
use contact::{Discs, Measure};
use nalgebra::Vector2;
use nsgs::Nsgs;
use runner::{Status, Stop};

const H: f64 = 0.01;
const LAWS: [&str; 3] = ["iqs", "predicted-gap", "newton"];

/// A scene under another law than `iqs`; elastic to 0.9 under `newton`.
fn under(law: &str, discs: &str, rest: &str) -> Case {
    let mut case = scene_of_discs(discs, H, rest).unwrap_or_else(|error| panic!("{error}"));
    case.scene.law = serde_json::from_str(&format!("{law:?}")).unwrap();
    case.scene.restitution = (law == "newton").then_some(0.9);
    case
}

/// Segments from each point to the next.
fn chain(points: &[[f64; 2]]) -> String {
    let piece =
        |ends: &[[f64; 2]]| format!("[[scene.segments]]\nfrom_m = {:?}\nto_m = {:?}\n", ends[0], ends[1]);
    points.windows(2).map(piece).collect()
}

fn stop() -> Stop {
    Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 10_000 }
}

/// Place and velocity of the first disc after each time step, and its greatest overlap.
fn path(case: &Case, time_steps: u32) -> (Vec<[Vector2<f64>; 2]>, f64) {
    let (mut march, mut deepest) = (March::<Discs>::new(case).unwrap(), 0.0_f64);
    let step = |_| {
        let next = march.next().unwrap();
        if march.time_steps() < 3 {
            println!("{:?} {:?} {}", next.sides, next.frozen.gap, next.frozen.problem.position()[0]);
        }
        let (out, seen) = march.time_step(&Nsgs::default(), &stop()).unwrap();
        if march.time_steps() < 3 {
            println!("r {:?} {}", out.impulses, out.iterations);
        }
        if seen.greatest_overlap > 1e-9 {
            println!("{} {:e}", march.time_steps(), seen.greatest_overlap);
        }
        deepest = deepest.max(seen.greatest_overlap);
        let (_, place, velocity) = march.grains().next().unwrap();
        [place, velocity]
    };
    ((0..time_steps).map(step).collect(), deepest)
}

/// A disc of 0.1 m at a distance along a line that leans, as [x, y, radius].
fn on_a_slope(angle: f64, along: f64) -> String {
    let (sin, cos) = angle.sin_cos();
    format!("[[{:?}, {:?}, 0.1]]", along * cos - 0.1 * sin, along * sin + 0.1 * cos)
}

#[test]
fn a_disc_slides_over_flush_joints_as_on_one_segment() {
    for (angle, law) in [0.0, 0.3, -0.7].into_iter().flat_map(|angle: f64| LAWS.map(|law| (angle, law))) {
        let (sin, cos) = angle.sin_cos();
        // Joints at uneven distances, two of them within one time step; the last pieces overlap, and one is written from right to left.
        let along = [0.0, 0.5, 0.53, 0.54, 0.9, 1.33, 4.0];
        let points = along.map(|s| [s * cos, s * sin]);
        let thrown = format!(
            "gravity_m_per_s2 = 10.0\nslope_rad = {:?}\nthrown_at_m_per_s = [{:?}, {:?}]\n",
            angle,
            5.0 * cos,
            5.0 * sin
        );
        let reversed = chain(&[[points[5][0], points[5][1]], points[4]]);
        let [first, last] = [chain(&points[..5]), chain(&[[1.1 * cos, 1.1 * sin], points[6]])];
        let disc = on_a_slope(angle, 0.2);
        let case = under(law, &disc, &format!("{thrown}{first}{reversed}{last}"));
        let whole = under(law, &disc, &format!("{thrown}{}", chain(&[points[0], points[6]])));
        let ((joined, deepest), (alone, _)) = (path(&case, 60), path(&whole, 60));
        for (k, ([x, v], [y, w])) in joined.iter().zip(&alone).enumerate() {
            assert!((x - y).norm() < 1e-12 && (v - w).norm() < 1e-12, "{law}, {angle}, {k}: {v} and {w}");
            assert!((v.norm() - 5.0).abs() < 1e-12, "{law}, {angle}, {k}: {} m/s", v.norm());
        }
        assert!(deepest < 1e-12, "{law}, {angle}: {deepest} m");
    }
}

/// Into a corner that rises by an angle a disc brings what of its velocity is along the side beyond, and touches both sides there.
#[test]
fn a_concave_corner_turns_a_disc_along_its_other_side() {
    for (degrees, law) in
        [10.0_f64, 30.0, 60.0].into_iter().flat_map(|a| ["iqs", "predicted-gap"].map(|law| (a, law)))
    {
        let angle = degrees.to_radians();
        let (sin, cos) = angle.sin_cos();
        let rest = "gravity_m_per_s2 = 0.0\nthrown_at_m_per_s = [5.0, 0.0]\n";
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0 + 4.0 * cos, 4.0 * sin]];
        let (path, deepest) =
            path(&under(law, "[[0.2, 0.1, 0.1]]", &format!("{rest}{}", chain(&points))), 60);
        let [place, velocity] = path[59];
        assert!(
            (velocity - Vector2::new(cos, sin) * 5.0 * cos).norm() < 1e-9,
            "{law}, {degrees}°: {velocity}"
        );
        let height = (place - Vector2::new(1.0, 0.0)).dot(&Vector2::new(-sin, cos));
        assert!((0.1 - 1e-9..0.1 + 0.05).contains(&height), "{law}, {degrees}°: {height} m");
        assert!(deepest < 1e-9, "{law}, {degrees}°: {deepest} m");
    }
}

/// Over a convex corner a disc flies on as from an edge, and then lies on the side beyond: never held back, never deep in it.
#[test]
fn a_convex_corner_lets_a_disc_go() {
    for (law, drop) in LAWS.into_iter().flat_map(|law| [0.05, 0.3].map(|drop| (law, drop))) {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.7, -0.7 * drop], [9.0, -8.0 * drop]];
        let rest = format!("gravity_m_per_s2 = 10.0\nthrown_at_m_per_s = [5.0, 0.0]\n{}", chain(&points));
        let (path, deepest) = path(&under(law, "[[0.2, 0.1, 0.1]]", &rest), 60);
        assert!(path.iter().all(|[_, v]| v.x >= 5.0 - 1e-9), "{law}, {drop}: {path:?}");
        assert!(deepest < 1e-9, "{law}, {drop}: {deepest} m");
    }
}

/// A bowl of many short sides: no more is lost than its corners take, the cosine of what is turned at once, and nothing gets out.
#[test]
fn a_bowl_of_short_sides_takes_from_a_disc_what_its_corners_take() {
    for law in ["iqs", "predicted-gap"] {
        let turn = std::f64::consts::PI / 80.0;
        let points: Vec<[f64; 2]> = (0..=80)
            .map(|k| std::f64::consts::PI + turn * f64::from(k))
            .map(|angle| [angle.cos(), angle.sin()])
            .collect();
        let rest = format!("gravity_m_per_s2 = 0.0\nthrown_at_m_per_s = [0.0, -5.0]\n{}", chain(&points));
        // Beside the first side, which is nearly upright.
        let (path, deepest) = path(&under(law, "[[-0.899, 0.0, 0.1]]", &rest), 70);
        let reached = path.iter().position(|[place, _]| place.x > 0.0 && place.y > 0.0).unwrap();
        let [_, velocity] = path[reached];
        // At most three corners at once are met within a time step, in which it passes one and a half. With `predicted-gap` it turns before
        // it is at the side, and so at more of them.
        let least = if law == "iqs" { 5.0 * (3.0 * turn).cos().powi(27) } else { 2.5 };
        assert!(velocity.norm() >= least && velocity.y > 0.9 * velocity.norm(), "{law}: {velocity}, {least}");
        assert!(deepest < 1e-9, "{law}: {deepest} m");
    }
}

/// Between the foot of a plate that stands on the floor and the floor there is no corner; nor is one where it stands in a box.
#[test]
fn a_disc_slides_along_the_floor_past_what_is_below_it_and_up_to_a_plate() {
    for floor in ["[scene.box]\n".to_owned(), chain(&[[-9.0, 0.0], [9.0, 0.0]])] {
        // A plate that leans away, at the joint of which the disc comes to lie, and one that hangs below the floor.
        let rest = format!(
            "gravity_m_per_s2 = 10.0\nthrown_at_m_per_s = [5.0, 0.0]\n{floor}{}{}",
            chain(&[[1.0, 0.0], [2.0, 1.0]]),
            chain(&[[0.4, 0.0], [0.5, -1.0]])
        );
        let case = under("iqs", "[[0.2, 0.1, 0.1]]", &rest);
        let (path, deepest) = path(&case, 14);
        // The centre is beside the plate from x = 0.9586 on: 0.1 m from floor and plate.
        for [place, velocity] in path.iter().filter(|[place, _]| place.x < 0.92) {
            assert!((velocity - Vector2::new(5.0, 0.0)).norm() < 1e-12, "{floor}: {place} {velocity}");
        }
        assert!(deepest < 1e-12, "{floor}: {deepest} m");
    }
}

#[test]
fn the_thicker_of_two_segments_that_meet_has_the_contact() {
    // The disc lies on the round end of the thick one, 0.3 m about (1, 0), beyond which a thin one goes on.
    let thick = "[[scene.segments]]\nfrom_m = [0.0, 0.0]\nto_m = [1.0, 0.0]\nradius_m = 0.3\n";
    let thin = chain(&[[1.0, 0.0], [3.0, 0.0]]);
    for segments in [format!("{thick}{thin}"), format!("{thin}{thick}")] {
        let case = under("iqs", "[[1.0, 0.4, 0.1]]", &format!("gravity_m_per_s2 = 10.0\n{segments}"));
        let next = March::<Discs>::new(&case).unwrap().next().unwrap();
        assert_eq!(next.frozen.gap.len(), 1, "{segments}");
        assert!(next.frozen.gap[0].abs() < 1e-12 && next.frozen.problem.contacts()[0].normal.y > 1.0 - 1e-12);
    }
}

/// Walls that close press a disc through a plate without thickness: the time step in which its centre passes it is the last.
#[test]
fn a_disc_does_not_pass_a_segment_unseen() {
    let plate = chain(&[[0.0, -1.0], [0.0, 1.0]]);
    let piston =
        "[[scene.segments]]\nfrom_m = [0.21, -1.0]\nto_m = [0.21, 1.0]\nvelocity_m_per_s = [-1.0, 0.0]\n";
    for joined in [plate.clone(), chain(&[[0.0, -1.0], [0.0, 0.0], [0.0, 1.0]])] {
        for law in LAWS {
            let case =
                under(law, "[[0.105, 0.0, 0.1]]", &format!("gravity_m_per_s2 = 0.0\n{joined}{piston}"));
            let mut march = March::<Discs>::new(&case).unwrap();
            let error = (0..101).find_map(|_| march.time_step(&Nsgs::default(), &stop()).err());
            let Some(CaseError::Exploded { why: Explosion::Overlap { grain: 0, .. }, .. }) = error else {
                panic!("{law}: {error:?} at {}", march.grains().next().unwrap().1)
            };
        }
    }
}

/// Two plates without thickness leave a slot of this half width (m), through which a piston presses a disc of 0.1 m. Returns the greatest
/// overlap of the time steps that were solved and how the march ended, if it did.
fn through_a_slot(half: f64, law: &str) -> (f64, Option<CaseError>) {
    let (above, below) = (chain(&[[0.0, half], [0.0, 1.0]]), chain(&[[0.0, -1.0], [0.0, -half]]));
    let x = (0.01 - half * half).sqrt();
    let at = x + 0.105;
    let piston = format!(
        "[[scene.segments]]\nfrom_m = [{at:?}, -1.0]\nto_m = [{at:?}, 1.0]\nvelocity_m_per_s = [-0.5, 0.0]\n"
    );
    let rest = format!("gravity_m_per_s2 = 0.0\n{above}{below}{piston}");
    let mut march = March::<Discs>::new(&under(law, &format!("[[{x:?}, 0.0, 0.1]]"), &rest)).unwrap();
    let mut deepest = 0.0_f64;
    for _ in 0..60 {
        match march.time_step(&Nsgs::default(), &stop()) {
            Ok((outcome, seen)) if outcome.status == Status::Converged => {
                deepest = deepest.max(seen.greatest_overlap);
            }
            Ok(_) => {}
            Err(error) => return (deepest, Some(error)),
        }
    }
    (deepest, None)
}

/// A free end has no thickness, so that no overlap with it exceeds the radius: it is passed where it is within half of that.
#[test]
fn a_disc_squeezed_round_the_free_end_of_a_segment_has_passed_it() {
    for law in LAWS {
        let (_, ended) = through_a_slot(0.04, law);
        let Some(CaseError::Exploded { why: Explosion::Overlap { grain: 0, .. }, .. }) = ended else {
            panic!("{law}: {ended:?}")
        };
    }
}

#[test]
fn what_lies_in_a_segment_or_would_be_passed_at_once_is_refused() {
    let refused = |discs: &str, rest: &str| {
        let case = scene_of_discs(discs, H, &format!("gravity_m_per_s2 = 0.0\n{rest}")).unwrap();
        March::<Discs>::new(&case).unwrap_err().to_string()
    };
    let platen = chain(&[[-1.0, 0.3], [1.0, 0.3]]);
    let inside = refused("[[0.0, 0.0, 0.1], [0.0, 0.25, 0.1]]", &platen);
    assert!(
        inside.contains("`scene.segments[0]`: grain 1, of radius 0.1 m")
            && inside.contains("when time begins"),
        "{inside}"
    );
    let pair = refused("[[0.0, 0.0, 0.1], [0.0, 0.15, 0.1]]", "");
    assert!(
        pair.contains("`sample`: grain 0, of radius 0.1 m") && pair.contains("overlaps grain 1"),
        "{pair}"
    );
    let floor = refused("[[0.0, 0.05, 0.1]]", "[scene.box]\n");
    assert!(floor.contains("`scene.box`: grain 0"), "{floor}");
    // Within half a time step it would be on the other side.
    let fast =
        "[[scene.segments]]\nfrom_m = [-1.0, -0.2]\nto_m = [1.0, -0.2]\nvelocity_m_per_s = [0.0, 100.0]\n";
    let passed = refused("[[0.0, 0.0, 0.1]]", fast);
    assert!(
        passed.contains("`scene.segments[0]`") && passed.contains("shorten `scene.time_step_s`"),
        "{passed}"
    );
    // At a tenth of that speed it takes the disc along.
    let (path, deepest) = path(
        &scene_of_discs(
            "[[0.0, 0.0, 0.1]]",
            H,
            &format!("gravity_m_per_s2 = 0.0\n{}", fast.replace("100.0", "10.0")),
        )
        .unwrap(),
        20,
    );
    assert!(path[19][1].y >= 10.0 - 1e-9 && deepest < 1e-9, "{path:?}, {deepest}");
}
