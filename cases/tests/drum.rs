//! A grain on a curved wall: its speed, its overlap and its energy; and the shipped scenes with a drum or segments over a long time.

use crate::common::scene_of_discs;
use cases::{Case, Energy, March};
use contact::{Discs, Measure, RoughDiscs};
use nsgs::Nsgs;
use runner::Stop;
use std::path::PathBuf;

const H: f64 = 0.01;

/// A disc of 0.1 m that slides at 5 m/s round a drum of 1 m, for three of its turns; its speed, overlap, the greatest distance of the
/// surfaces, and its energy.
fn round(law: &str) -> (f64, f64, f64, Energy) {
    let rest = "gravity_m_per_s2 = 0.0\nthrown_at_m_per_s = [5.0, 0.0]\n[scene.drum]\nradius_m = 1.0\n";
    let mut case = scene_of_discs("[[0.0, -0.9, 0.1]]", H, rest).unwrap();
    case.scene.law = serde_json::from_str(&format!("{law:?}")).unwrap();
    case.scene.restitution = (law == "newton").then_some(0.3);
    let mut march = March::<Discs>::new(&case).unwrap();
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 100 };
    let (mut overlap, mut apart, mut energy) = (0.0_f64, 0.0_f64, Energy::default());
    for _ in 0..340 {
        let next = march.next().unwrap();
        apart = next.frozen.gap.iter().fold(apart, |apart, gap| apart.max(*gap));
        let (_, seen) = march.time_step(&Nsgs::default(), &stop).unwrap();
        overlap = overlap.max(seen.greatest_overlap);
        energy += seen.energy;
    }
    (march.velocity()[0].norm(), overlap, apart, energy)
}

#[test]
fn a_disc_slides_round_a_drum_for_ever_and_stays_at_its_wall() {
    for law in ["iqs", "predicted-gap", "newton"] {
        let (speed, overlap, apart, energy) = round(law);
        // The first half time step is along a straight line: (h v/2)²/2(R − r), which the next takes back, once.
        let begin = (0.5 * H * 5.0_f64).powi(2) / (2.0 * 0.9);
        assert!(overlap < 1.01 * begin && apart < 1.01 * begin, "{law}: {overlap} m, {apart} m");
        assert!((speed - 5.0).abs() < 0.01, "{law}: {speed} m/s");
        // What shocks take the gap gives back.
        let first = 0.5 * 1000.0 * std::f64::consts::PI * 0.01 * 25.0;
        assert!((energy.shocks + energy.gap).abs() < 4e-3 * first, "{law}: {energy:?}");
        assert!(energy.left_over < 1e-12 * energy.moved && energy.walls == 0.0, "{law}: {energy:?}");
    }
}

#[test]
fn a_disc_recovers_from_an_overlap_with_the_floor_at_the_rate_of_the_scene() {
    let rest = "gravity_m_per_s2 = 9.81\nrecovery_per_s = 2.0\n[scene.box]\nwidth_m = 1.0\n";
    let case = scene_of_discs("[[0.5, 0.095, 0.1]]", H, rest).unwrap();
    let mut march = March::<Discs>::new(&case).unwrap();
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-14, max_iterations: 100 };
    let mut expected = 0.005;
    for k in 0..50 {
        let (_, seen) = march.time_step(&Nsgs::default(), &stop).unwrap();
        assert!((seen.greatest_overlap - expected).abs() < 1e-12, "{k}: {} m", seen.greatest_overlap);
        expected *= 1.0 - 2.0 * H;
    }
}

/// Marches a case and gives its greatest overlap over the least radius, in the first half of the time and in the second.
fn overlaps(name: &str, time_steps: u64, overrides: &[(String, String)]) -> [f64; 2] {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    let case = Case::read(&file, overrides).unwrap_or_else(|error| panic!("{error}"));
    // A scene without friction marches alike, with spins that nothing moves.
    let mut march = March::<RoughDiscs>::new(&case).unwrap();
    let least = march.grains().take(march.grain_count()).map(|(radius, _, _)| radius).fold(1.0, f64::min);
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-3, max_iterations: 500 };
    let mut deepest = [0.0_f64; 2];
    for k in 0..time_steps {
        let (_, seen) =
            march.time_step(&Nsgs::default(), &stop).unwrap_or_else(|error| panic!("{name}: {error}"));
        let half = &mut deepest[usize::from(2 * k >= time_steps)];
        *half = half.max(seen.greatest_overlap / least);
        if k % 100 == 99 {
            println!("{name}: {:.2e} after {} of {time_steps} time steps", deepest[0].max(deepest[1]), k + 1);
        }
    }
    deepest
}

#[test]
fn shipped_drums_and_segments_do_not_sink() {
    for name in ["drum", "arch", "hopper"] {
        let [first, second] = overlaps(name, 400, &[]);
        assert!(first < 1e-2 && second < 1e-2, "{name}: {first} and {second} of the least radius");
    }
}

#[test]
fn overlaps_of_a_pressed_packing_add_up_unless_it_recovers_from_them() {
    let of = |rate: &str| {
        overlaps("literature/radjai-1996", 800, &[("scene.recovery_per_s".to_owned(), rate.to_owned())])
    };
    let ([_, staying], [_, recovering]) = (of("0.0"), of("10.0"));
    assert!(recovering < 0.2 * staying, "{recovering} and {staying} of the least radius");
}

/// 20 s of every shipped scene with a drum or segments: minutes, so it is asked for by name.
#[test]
#[ignore = "takes minutes"]
fn shipped_drums_and_segments_do_not_sink_in_twenty_seconds() {
    let only = std::env::var("SCENE").ok();
    let names = [
        "drum",
        "arch",
        "hopper",
        "biaxial",
        "literature/albert-1999",
        "literature/beverloo-1961",
        "literature/coulomb-1776",
        "literature/cundall-strack-1979",
        "literature/gdr-midi-2004-drum",
        "literature/geng-2001",
        "literature/jaeger-1989",
        "literature/lajeunesse-2005",
        "literature/moreau-1994",
        "literature/ohern-2003",
        "literature/radjai-1996",
        "literature/renouf-alart-2005",
        "literature/staron-hinch-2005",
        "literature/to-2001",
        "literature/voivret-2009",
    ];
    for name in names.into_iter().filter(|name| only.as_ref().is_none_or(|only| only == name)) {
        let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
        let h = Case::read(&file, &[]).unwrap().scene.time_step_s;
        let [first, second] = overlaps(name, (20.0 / h).round() as u64, &[]);
        println!("{name}: {first:.2e}, then {second:.2e} of the least radius");
        assert!(first.max(second) < 0.05, "{name}");
    }
}
