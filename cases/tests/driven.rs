//! Segments that a table, a vibration or a force moves: known answers.

use crate::common::scene_of_discs;
use cases::{Case, March, Marched, Observables};
use contact::{Discs, Measure, RoughDiscs, Solver};
use nalgebra::Vector2;
use nsgs::Nsgs;
use runner::{Outcome, Stop};

const H: f64 = 0.01;

fn scene(discs: &str, rest: &str) -> Result<Case, String> {
    scene_of_discs(discs, H, rest)
}

fn time_step<M: Marched<Place = Vector2<f64>>>(march: &mut March<M>) -> (Outcome, Observables)
where
    Nsgs: Solver<M>,
{
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 100_000 };
    march.time_step(&Nsgs::default(), &stop).unwrap()
}

fn near(is: f64, expected: f64) {
    assert!((is - expected).abs() <= 1e-10 * expected.abs().max(1.0), "{is} for {expected}");
}

const LEVEL: &str = "gravity_m_per_s2 = 10.0\n[[scene.segments]]\nfrom_m = [-2.0, 1.0]\nto_m = [2.0, 1.0]\n";

#[test]
fn a_platform_that_follows_a_table_carries_a_disc_at_its_velocity() {
    // It rises, then falls at 7 m/s², less than g. Corners are where contacts are sought, in the middle of a time step.
    let table = "motion = [[0.005, 0.0, 0.0], [0.105, 0.0, 0.5], [0.155, 0.0, 0.5], [0.355, 0.0, -0.9]]\n";
    let mut march =
        March::<Discs>::new(&scene("[[0.0, 1.5, 0.5]]", &format!("{LEVEL}{table}")).unwrap()).unwrap();
    for k in 1..50 {
        let (outcome, seen) = time_step(&mut march);
        let t = H * f64::from(k);
        let expected = match t {
            t if t <= 0.105 => (t - 0.005) * 5.0,
            t if t <= 0.155 => 0.5,
            t if t <= 0.355 => 0.5 - 7.0 * (t - 0.155),
            _ => -0.9,
        };
        near(march.velocity()[0].y, expected);
        assert!(outcome.impulses[0] > 0.0 && seen.greatest_overlap < 1e-12, "{seen:?}");
    }
}

#[test]
fn a_table_and_a_constant_velocity_of_the_same_value_are_the_same_motion() {
    let end = |keys: &str| {
        let case = scene("[[0.0, 1.5, 0.5]]", &format!("{LEVEL}{keys}")).unwrap();
        let mut march = March::<Discs>::new(&case).unwrap();
        for _ in 0..30 {
            time_step(&mut march);
        }
        march.grains().next().unwrap().1.y
    };
    let constant = end("velocity_m_per_s = [0.1, 0.7]\n");
    near(end("motion = [[0.4, 0.1, 0.7]]\n"), constant);
    near(end("motion = [[-0.1, 0.1, 0.3], [5.0, 0.1, 0.3]]\nvelocity_m_per_s = [0.0, 0.4]\n"), constant);
}

#[test]
fn a_platform_that_vibrates_keeps_a_disc_on_it_below_g() {
    // A (2π f)² = 0.9 g.
    let omega = std::f64::consts::TAU * 2.0;
    let amplitude = 9.0 / (omega * omega);
    let vibration = format!(
        "vibration = {{ amplitude_m = {amplitude}, frequency_hz = 2.0, direction = \"y\", start_s = 0.005 }}\n"
    );
    let case = scene("[[0.0, 1.5, 0.5]]", &format!("{LEVEL}{vibration}")).unwrap();
    let mut march = March::<Discs>::new(&case).unwrap();
    for k in 1..100 {
        time_step(&mut march);
        // Half a time step on is where contacts are sought next: there it is on the platform, which began with the first of these.
        let (_, place, velocity) = march.grains().next().unwrap();
        near((place + velocity * (0.5 * H)).y, 1.5 + amplitude * (omega * H * f64::from(k)).sin());
    }
}

#[test]
fn a_driven_wall_that_nothing_holds_moves_by_its_force_over_its_mass() {
    let wall = "gravity_m_per_s2 = 10.0\n[[scene.segments]]\nfrom_m = [4.0, 0.0]\nto_m = [0.0, 3.0]\n\
                driven = { mass_kg = 50.0, force_n = 200.0, direction = [3.0, 4.0] }\n";
    let mut march = March::<RoughDiscs>::new(
        &scene("[[-9.0, 0.0, 0.5]]", wall)
            .map(|mut case| {
                case.scene.friction = Some(0.3);
                case
            })
            .unwrap(),
    )
    .unwrap();
    let from = march.grains().last().unwrap().1;
    for k in 1..=20 {
        time_step(&mut march);
        let (_, place, velocity) = march.grains().last().unwrap();
        // Along (0.6, 0.8): F/m − 0.8 g.
        let (acceleration, t) = (200.0 / 50.0 - 0.8 * 10.0, H * f64::from(k));
        near(velocity.x, 0.6 * acceleration * t);
        near(velocity.y, 0.8 * acceleration * t);
        near((place - from).norm(), 0.5 * acceleration.abs() * t * t);
        assert!(march.velocity().last().unwrap().z.abs() < 1e-20, "it does not turn");
    }
}

fn row_carries_the_force<M: Marched<Place = Vector2<f64>>>(friction: &str)
where
    Nsgs: Solver<M>,
{
    let row = "[[0.1, 0.0, 0.1], [0.4, 0.0, 0.2], [0.7, 0.0, 0.1]]";
    let walls = format!(
        "{friction}gravity_m_per_s2 = 0.0\n[[scene.segments]]\nfrom_m = [0.0, -1.0]\nto_m = [0.0, 1.0]\n\
         [[scene.segments]]\nfrom_m = [0.8, -1.0]\nto_m = [0.8, 1.0]\n\
         driven = {{ mass_kg = 70.0, force_n = -300.0, direction = [1.0, 0.0] }}\n"
    );
    let mut march = March::<M>::new(&scene(row, &walls).unwrap()).unwrap();
    assert_eq!(march.grain_count(), 3);
    let mut last = None;
    for _ in 0..5 {
        last = Some(time_step(&mut march));
    }
    let (outcome, seen) = last.unwrap();
    let normal: Vec<f64> = outcome.impulses.iter().step_by(outcome.impulses.len() / 6).copied().collect();
    // Wall and disc, twice disc and disc, disc and driven wall; then its guides.
    for r in &normal[..4] {
        near(*r, 300.0 * H);
    }
    assert!(normal[4..].iter().all(|r| r.abs() < 1e-10), "{normal:?}");
    near(seen.wall_impulses[0], 300.0 * H);
    // A rectangle of 0.8 m by 0.4 m: force over height.
    near(seen.stress.xx, 300.0 / 0.4);
    near(seen.stress.yy, 0.0);
    assert!(seen.greatest_speed < 1e-10, "{seen:?}");
    assert!(seen.energy.left_over < 1e-12, "{seen:?}");
}

#[test]
fn a_row_of_discs_passes_the_force_of_a_driven_wall_through_each_contact() {
    row_carries_the_force::<Discs>("");
    row_carries_the_force::<RoughDiscs>("friction = 0.4\n");
}

#[test]
fn energy_of_a_row_that_a_driven_wall_throws_is_its_forces_work() {
    // All move together: F/(M + m), and the work is that of the force.
    let walls = "gravity_m_per_s2 = 0.0\n[[scene.segments]]\nfrom_m = [0.8, -1.0]\nto_m = [0.8, 1.0]\n\
                 driven = { mass_kg = 70.0, force_n = -300.0, direction = [1.0, 0.0] }\n";
    let mut march =
        March::<Discs>::new(&scene("[[0.4, 0.0, 0.2], [0.7, 0.0, 0.1]]", walls).unwrap()).unwrap();
    let (mut work, mut kinetic) = (0.0, 0.0);
    for _ in 0..20 {
        let (_, seen) = time_step(&mut march);
        (work, kinetic) = (work + seen.energy.walls, seen.kinetic_energy);
    }
    let mass = 70.0 + 1000.0 * std::f64::consts::PI * 0.05;
    let speed = -300.0 / mass * 20.0 * H;
    march.velocity().iter().for_each(|v| near(v.x, speed));
    near(kinetic, 0.5 * mass * speed * speed);
    near(work, kinetic);
}

#[test]
fn friction_of_a_segment_is_its_own() {
    let end = |keys: &str| {
        let rest = format!("thrown_at_m_per_s = [3.0, 0.0]\n{LEVEL}friction = 0.2\n{keys}");
        let mut march = March::<RoughDiscs>::new(&scene("[[0.0, 1.5, 0.5]]", &rest).unwrap()).unwrap();
        for _ in 0..20 {
            time_step(&mut march);
        }
        march.velocity()[0]
    };
    // It slides until 3/(3 μ g) = 0.5 s.
    near(end("").x, 3.0 - 0.2 * 10.0 * 0.2);
    near(end("").z, -2.0 * 0.2 * 10.0 * 0.2 / 0.5);
}

#[test]
fn what_has_no_meaning_is_refused_by_key_and_number() {
    let refused = |keys: &str, said: &str| {
        let error = scene("[[0.0, 1.5, 0.5]]", &format!("{LEVEL}{keys}\n")).unwrap_err();
        assert!(error.contains(said), "{error}");
    };
    refused(
        "motion = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]",
        "`scene.segments[0].motion[1]` is [0, 1, 0]: its time",
    );
    refused("motion = [[0.0, nan, 0.0]]", "`scene.segments[0].motion[0][1]` is NaN: it must be finite");
    refused("friction = -0.5", "`scene.segments[0].friction` is -0.5");
    let across = "vibration = { amplitude_m = 0.1, frequency_hz = 1.0, direction = \"z\" }\n";
    let across = scene("[[0.0, 1.5, 0.5]]", &format!("{LEVEL}{across}")).unwrap();
    let error = March::<Discs>::new(&across).unwrap_err().to_string();
    assert!(error.contains("`scene.segments[0].vibration.direction` is z"), "{error}");
    let driven = |mass: &str, direction: &str| {
        format!("driven = {{ mass_kg = {mass}, force_n = 1.0, direction = {direction} }}")
    };
    refused(&driven("0.0", "[1.0, 0.0]"), "`scene.segments[0].driven.mass_kg` is 0");
    refused(&driven("1.0", "[0.0, 0.0]"), "`scene.segments[0].driven.direction` is 0");
    refused(
        &format!("removed_at_s = 1.0\n{}", driven("1.0", "[0.0, 1.0]")),
        "`scene.segments[0].removed_at_s` is given beside `driven`",
    );
}
