//! Chutes and piles of spheres: what rolls, what bumps hold, and what goes through a periodic side.

use cases::{Case, March};
use contact::{Measure, RoughSpheres};
use nalgebra::Vector3;
use nsgs::Nsgs;
use runner::Stop;
use std::path::PathBuf;

fn read(name: &str, overrides: &[(&str, &str)]) -> Result<Case, String> {
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    Case::read(&file, &overrides).map_err(|error| error.to_string())
}

/// A case with these spheres, [x, y, z, radius] of each, in place of its own.
fn with_spheres(name: &str, spheres: &[[f64; 4]], overrides: &[(&str, &str)]) -> March<RoughSpheres> {
    let sample = format!("{{ kind = \"spheres\", spheres = {spheres:?}, density_kg_per_m3 = 2600.0 }}");
    let all = [&[("sample", sample.as_str())], overrides].concat();
    March::new(&read(name, &all).unwrap()).unwrap()
}

fn time_steps(march: &mut March<RoughSpheres>, count: u32) {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-13, max_iterations: 10_000 };
    for _ in 0..count {
        march.time_step(&Nsgs::default(), &stop).unwrap();
    }
}

/// It rolls iff tan θ ≤ 3.5 μ, at 5/7 g sin θ, and slides at g (sin θ − μ cos θ); what goes out below comes in above.
#[test]
fn a_sphere_on_the_plane_of_the_chute_rolls_or_slides_for_ever() {
    let (g, time) = (9.81, 1.5);
    for (slope, friction) in [(0.5_f64, 0.5), (1.0, 0.5), (1.2, 0.5)] {
        let angle = slope.to_string();
        let smooth = "{ periodic = true, width_m = 1.6, depth_m = 1.2 }";
        let overrides = [("scene.slope_rad", angle.as_str()), ("scene.box", smooth)];
        let mut march = with_spheres("chute", &[[0.3, 0.1, 0.6, 0.1]], &overrides);
        time_steps(&mut march, 300);
        let rolls = slope.tan() <= 3.5 * friction;
        let sliding = g * (slope.sin() - friction * slope.cos());
        let acceleration = if rolls { 5.0 / 7.0 * g * slope.sin() } else { sliding };
        let (_, place, velocity) = march.grains().next().unwrap();
        assert!((velocity - Vector3::x() * (acceleration * time)).norm() < 1e-10, "{slope}: {velocity}");
        // Exactly: θ = ½ is of second order.
        let along = (0.3 + 0.5 * acceleration * time * time).rem_euclid(1.6);
        assert!((place - Vector3::new(along, 0.1, 0.6)).norm() < 1e-10, "{slope}: {place}, {along}");
    }
}

/// Four bumps of radius a around it hold a sphere of radius R at √((R + a)² − 2 a²), in the box and across its periodic side.
#[test]
fn a_sphere_rests_between_four_bumps() {
    let height = (0.23_f64.powi(2) - 2.0 * 0.1_f64.powi(2)).sqrt();
    for x in [0.7, 1.5] {
        let mut march = with_spheres("chute", &[[x, height, 0.3, 0.13]], &[("scene.slope_rad", "0.2")]);
        let next = march.next().unwrap().frozen.problem;
        assert_eq!(next.contact_count(), 4, "at {x}");
        time_steps(&mut march, 50);
        let (_, place, _) = march.grains().next().unwrap();
        assert!((place - Vector3::new(x, height, 0.3)).norm() < 1e-10, "{place}");
    }
}

/// By a whole number of bumps along x: contacts and motion are the same, through the periodic side too.
#[test]
fn a_layer_on_the_chute_that_is_shifted_flows_the_same() {
    let sample = [("sample.grains", "40"), ("scene.box.depth_m", "0.8")];
    let laid: March<RoughSpheres> = March::new(&read("chute", &sample).unwrap()).unwrap();
    let spheres = |by: f64| -> Vec<[f64; 4]> {
        laid.grains().map(|(radius, x, _)| [x.x + by, x.y, x.z, radius]).collect()
    };
    let shifts = [0.0, 0.4, 1.4, -3.2];
    let mut marches = shifts.map(|by| with_spheres("chute", &spheres(by), &[("scene.box.depth_m", "0.8")]));
    // As many sweeps for each: sweeps order contacts by bump, so another shift sees another order, and the tolerance is what is left.
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-11, max_iterations: 100_000 };
    let mut through = 0;
    for k in 0..10 {
        let seen = marches.each_mut().map(|march| march.time_step(&Nsgs::default(), &stop).unwrap().1);
        assert!(seen.iter().all(|other| other.contacts == seen[0].contacts), "{k}: {seen:?}");
        for (march, by) in marches.iter().zip(shifts).skip(1) {
            for ((_, x, v), (_, y, w)) in marches[0].grains().zip(march.grains()) {
                assert!((v - w).norm() < 1e-6, "{k}: {v} and {w}");
                let apart = (y.x - x.x - by) / 1.6;
                assert!((apart - apart.round()).abs() < 1e-6 && (0.0..1.6).contains(&y.x), "{k}: {x}, {y}");
            }
        }
        through += seen[0].contacts;
    }
    assert!(through > 400, "it is a layer: {through}");
}

/// A wall behind that closes takes a sphere along; drawn away, it leaves it where it is.
#[test]
fn walls_behind_and_before_close_at_their_speed() {
    for (speed, expected) in [("0.2", 0.2), ("-0.2", 0.0)] {
        let closing = format!("{{ width_m = 1.4, depth_m = 1.4, depth_closing_speed_m_per_s = {speed} }}");
        let overrides = [("scene.box", closing.as_str()), ("scene.friction", "0.0")];
        let mut march = with_spheres("pile", &[[0.7, 0.1, 0.1, 0.1]], &overrides);
        time_steps(&mut march, 100);
        let (_, place, velocity) = march.grains().next().unwrap();
        assert!((velocity.z - expected).abs() < 1e-10, "{velocity}");
        assert!((place.z - 0.1 - 0.5 * expected).abs() < 1e-3, "{place}");
    }
}

#[test]
fn what_has_no_meaning_in_space_is_refused_by_its_key() {
    let refused = |name: &str, overrides: &[(&str, &str)]| {
        let error = read(name, overrides).and_then(|case| {
            March::<RoughSpheres>::new(&case).map(|_| ()).map_err(|error| error.to_string())
        });
        error.unwrap_err()
    };
    let crystal = |kind: &str| {
        format!("{{ kind = \"{kind}\", counts = [3, 3, 3], radius_m = 0.25, density_kg_per_m3 = 2600.0 }}")
    };
    for kind in ["simple-cubic", "face-centred"].map(crystal) {
        let error = refused("pile", &[("sample", &kind)]);
        assert!(
            error.contains(
                "`scene.box.width_m` is 1.4: 3 spheres of `sample.radius_m` 0.25 side by side need 1.5"
            ),
            "{error}"
        );
        let error = refused("pile", &[("sample", &kind), ("scene.box.width_m", "1.5")]);
        assert!(error.contains("`scene.box.depth_m` is 1.4"), "{error}");
    }
    let narrow = refused("pile", &[("scene.box.depth_m", "0.4")]);
    assert!(narrow.contains("`scene.box.depth_m` is 0.4: it must be at least 4 greatest radii"), "{narrow}");
    let lid = refused("chute", &[("scene.box.lid", "{ mass_kg = 1.0, force_n = 1.0 }")]);
    assert!(lid.contains("`scene.box.lid` is for discs"), "{lid}");
    let open = "{ width_m = 1.4, depth_closing_speed_m_per_s = 0.1 }";
    let sample = "{ kind = \"spheres\", spheres = [[0.7, 0.1, 0.7, 0.1]], density_kg_per_m3 = 2600.0 }";
    let closing = refused("pile", &[("scene.box", open), ("sample", sample)]);
    assert!(
        closing.contains("`scene.box.depth_closing_speed_m_per_s` is 0.1: it needs `scene.box.depth_m`"),
        "{closing}"
    );
    let discs = read("heap", &[("scene.box.depth_closing_speed_m_per_s", "0.1")]).unwrap();
    let discs = March::<contact::RoughDiscs>::new(&discs).unwrap_err().to_string();
    assert!(discs.contains("discs have no depth"), "{discs}");
}
