//! Periodic sides and a lid that a force presses, against what mechanics says of them.

use cases::{Case, March, Marched, Observables};
use contact::{Discs, Measure, RoughDiscs, Solver};
use nalgebra::Vector2;
use nsgs::Nsgs;
use runner::Stop;
use std::path::PathBuf;

fn read(name: &str, overrides: &[(&str, &str)]) -> Result<Case, String> {
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
    Case::read(&file, &overrides).map_err(|error| error.to_string())
}

fn time_step<M: Marched<Place = Vector2<f64>>>(march: &mut March<M>, tolerance: f64) -> Observables
where
    Nsgs: Solver<M>,
{
    let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: 100_000 };
    march.time_step(&Nsgs::default(), &stop).unwrap().1
}

/// Discs in a periodic box of 2.4 m, each shifted so far along x.
fn shifted(discs: &[(f64, Vector2<f64>)], by: f64, friction: &str) -> Case {
    let list: Vec<String> = discs.iter().map(|(r, x)| format!("[{}, {}, {r}]", x.x + by, x.y)).collect();
    let sample = format!("{{ kind = \"discs\", discs = [{}], density_kg_per_m2 = 1000.0 }}", list.join(", "));
    let periodic = [("sample", sample.as_str()), ("scene.box", "{ width_m = 2.4, periodic = true }")];
    let friction = [("scene.friction", friction)];
    let friction = if friction[0].1.is_empty() { &[][..] } else { &friction[..] };
    read("settled-box", &[&periodic[..], friction].concat()).unwrap()
}

fn a_shift_changes_nothing<M: Marched<Place = Vector2<f64>>>(friction: &str)
where
    Nsgs: Solver<M>,
{
    let periodic = [("sample.grains", "60"), ("scene.box", "{ width_m = 2.4, periodic = true }")];
    let laid =
        March::<M>::new(&read(if M::HAS_FRICTION { "rough-box" } else { "settled-box" }, &periodic).unwrap());
    let discs: Vec<_> = laid.unwrap().grains().map(|(radius, place, _)| (radius, place)).collect();
    let mut marches =
        [0.0, 0.77, 1.9, -31.3].map(|by| March::<M>::new(&shifted(&discs, by, friction)).unwrap());
    // As many sweeps for each, so that nothing but round-off tells them apart.
    let stop = Stop { on: Measure::NaturalMap, tolerance: 0.0, max_iterations: 200 };
    for k in 0..30 {
        let seen = marches.each_mut().map(|march| march.time_step(&Nsgs::default(), &stop).unwrap().1);
        assert!(seen.iter().all(|other| other.contacts == seen[0].contacts), "{seen:?}");
        let [first, others @ ..] = &marches;
        for ((_, _, v), (_, x, w)) in others.iter().flat_map(|other| first.grains().zip(other.grains())) {
            // Beside g h: places of some metres end at 1e-15 m, which over h is 1e-13 m/s, and grow from shock to shock.
            assert!((v - w).norm() <= 1e-8 * 0.049, "{k}: {v:?} and {w:?}");
            assert!((0.0..2.4).contains(&x.x), "it is in the box: {x}");
        }
    }
    let through = marches[0].next().unwrap().frozen.problem;
    let far = through.contacts().iter().filter_map(|at| {
        let (i, j) = contact::Touch::ends(at);
        Some((through.position()[i as usize] - through.position()[j? as usize]).norm())
    });
    assert!(far.filter(|far| *far > 1.2).count() >= 2, "discs touch through the boundary");
}

#[test]
fn a_packing_that_is_shifted_along_x_marches_the_same() {
    a_shift_changes_nothing::<Discs>("");
    a_shift_changes_nothing::<RoughDiscs>("0.3");
}

#[test]
fn a_disc_that_rolls_out_at_the_right_comes_in_at_the_left() {
    let thrown = |of_box: &str| {
        March::<RoughDiscs>::new(&read("thrown-disc", &[("scene.box", of_box)]).unwrap()).unwrap()
    };
    let [mut periodic, mut free] = [thrown("{ width_m = 6.0, periodic = true }"), thrown("{}")];
    let mut turned = false;
    for _ in 0..1000 {
        time_step(&mut periodic, 1e-13);
        time_step(&mut free, 1e-13);
        let [(_, here, v), (_, there, w)] = [&periodic, &free].map(|march| march.grains().next().unwrap());
        assert!(
            (here.x - there.x.rem_euclid(6.0)).abs() < 1e-10 && (v - w).norm() < 1e-12,
            "{here}, {there}"
        );
        turned |= there.x > 6.0;
    }
    assert!(turned, "it went through");
}

#[test]
fn without_floor_and_walls_momentum_along_x_is_kept() {
    // High above the floor, without gravity; the highest of them comes down on the others.
    let mut march = March::<RoughDiscs>::new(
        &read(
            "rough-box",
            &[
                ("scene.box", "{ width_m = 2.4, periodic = true }"),
                ("scene.gravity_m_per_s2", "0.0"),
                ("scene.thrown_at_m_per_s", "[0.5, 5.0]"),
                ("scene.impact_speed_m_per_s", "8.0"),
                ("sample.grains", "80"),
            ],
        )
        .unwrap(),
    )
    .unwrap();
    let momentum = |march: &March<RoughDiscs>| -> f64 {
        march.mass().iter().zip(march.velocity()).map(|(m, v)| m.mass * v.x).sum()
    };
    let before = momentum(&march);
    let mut carried = false;
    for _ in 0..60 {
        let seen = time_step(&mut march, 1e-6);
        carried |= seen.contacts > 0 && seen.energy.shocks < 0.0;
        assert!((momentum(&march) / before - 1.0).abs() < 1e-12);
    }
    assert!(carried);
}

/// Three discs on top of each other in a wide periodic box, under a lid of 500 kg.
fn column(overrides: &[(&str, &str)]) -> Case {
    let column = [
        ("sample", "{ kind = \"column\", grains = 3, radius_m = 0.1, density_kg_per_m2 = 1000.0 }"),
        ("scene.box", "{ width_m = 1.5, periodic = true, lid = { mass_kg = 500.0, force_n = 2000.0 } }"),
    ];
    read("periodic-shear", &[&column[..], overrides].concat()).unwrap()
}

#[test]
fn a_lid_that_nothing_holds_falls_by_its_force_over_its_mass() {
    let falls = column(&[("scene.thrown_at_m_per_s", "[0.0, -20.0]"), ("scene.gravity_m_per_s2", "3.0")]);
    let mut march = March::<RoughDiscs>::new(&falls).unwrap();
    for k in 1..=10 {
        time_step(&mut march, 1e-12);
        let (_, _, lid) = march.grains().last().unwrap();
        let expected = -(2000.0 / 500.0 + 3.0) * 0.005 * f64::from(k);
        assert!((lid.y - expected).abs() < 1e-12 && lid.x.abs() < 1e-12, "{lid}, {expected}");
    }
}

#[test]
fn floor_and_stress_carry_the_lids_force() {
    for gravity in [0.0, 9.81] {
        let gravity_text = format!("{gravity:?}");
        let mut march =
            March::<RoughDiscs>::new(&column(&[("scene.gravity_m_per_s2", &gravity_text)])).unwrap();
        let mut seen = time_step(&mut march, 1e-13);
        for _ in 0..100 {
            seen = time_step(&mut march, 1e-13);
        }
        let of_disc = 1000.0 * std::f64::consts::PI * 0.01;
        let carried = (2000.0 + gravity * (500.0 + 3.0 * of_disc)) * 0.005;
        assert!((seen.wall_impulses[0] / carried - 1.0).abs() < 1e-10, "{seen:?}, {carried}");
        assert!(seen.greatest_speed < 1e-10, "{seen:?}");
        assert!(
            (seen.stress.coordination - 2.0).abs() < 1e-15,
            "four contacts between three discs and walls: {seen:?}"
        );
        if gravity == 0.0 {
            assert!((seen.stress.yy / (2000.0 / 1.5) - 1.0).abs() < 1e-10, "{seen:?}");
            assert!(seen.stress.xx.abs() + seen.stress.xy.abs() < 1e-6, "{seen:?}");
        }
    }
}

#[test]
fn a_packing_at_rest_under_a_lid_has_its_force_over_the_width_as_stress() {
    // Bumps on both, and friction; the lid moves as long as the packing settles.
    let still = read("periodic-shear", &[("scene.box.lid.speed_m_per_s", "0.0"), ("sample.grains", "60")]);
    let mut march = March::<RoughDiscs>::new(&still.unwrap()).unwrap();
    let mut seen = time_step(&mut march, 1e-6);
    for _ in 0..600 {
        seen = time_step(&mut march, 1e-6);
        assert!(seen.energy.left_over <= 1e-11 * seen.energy.moved.max(1e-6), "{:?}", seen.energy);
    }
    // Discs that nothing holds may still move.
    let (_, _, lid) = march.grains().last().unwrap();
    assert!(lid.norm() < 1e-6, "it is at rest: {lid}");
    assert!((seen.stress.yy / 1e4 - 1.0).abs() < 1e-3, "{seen:?}");
}

#[test]
fn a_lid_drags_what_it_presses_at_the_speed_of_its_guides() {
    let mut march =
        March::<RoughDiscs>::new(&read("periodic-shear", &[("sample.grains", "60")]).unwrap()).unwrap();
    let (mut sheared, mut balance) = (0.0, 0.0);
    for k in 0..200 {
        let seen = time_step(&mut march, 1e-6);
        let (_, _, lid) = march.grains().last().unwrap();
        assert!((lid.x - 0.4).abs() < 1e-3, "{lid}");
        assert!(march.velocity().last().unwrap().z.abs() < 1e-20, "it does not turn");
        assert!(seen.energy.left_over <= 1e-11 * seen.energy.moved, "{:?}", seen.energy);
        if k >= 100 {
            // What the guides give is what the discs take.
            sheared -= seen.stress.xy * 2.4 / 100.0;
            balance += (seen.wall_impulses[1] - seen.wall_impulses[2]) / 0.005 / 100.0;
        }
    }
    assert!(sheared > 1000.0 && (sheared / balance - 1.0).abs() < 0.2, "{sheared} N and {balance} N");
}

#[test]
fn what_does_not_go_with_periodic_sides_is_refused_by_its_key() {
    let refused = |overrides: &[(&str, &str)], said: &str| {
        let error = match read("periodic-shear", overrides) {
            Ok(case) => March::<RoughDiscs>::new(&case).unwrap_err().to_string(),
            Err(error) => error,
        };
        assert!(error.contains(said), "{error}");
    };
    refused(
        &[("scene.box.tilt_rate_rad_per_s", "0.1")],
        "`scene.box.tilt_rate_rad_per_s` is 0.1: periodic sides",
    );
    refused(&[("scene.box.closing_speed_m_per_s", "0.1")], "`scene.box.closing_speed_m_per_s` is 0.1");
    refused(&[("scene.box.bump_radius_m", "0.07")], "`scene.box.bump_radius_m` is 0.07");
    refused(&[("scene.box.periodic", "false")], "`scene.box.lid` asks for `scene.box.periodic` = true");
    refused(&[("scene.box.lid.mass_kg", "0.0")], "`scene.box.lid.mass_kg` is 0");
    refused(
        &[("scene.box.width_m", "0.9")],
        "`scene.box.width_m` is 0.9: a periodic box must be at least 12",
    );
    refused(&[("scene.drum", "{ radius_m = 2.0 }")], "`scene.drum.radius_m`");
}
