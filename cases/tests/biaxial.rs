//! The biaxial test: the force on its wall, and the friction angle.

use cases::{Case, March};
use contact::{Measure, RoughDiscs};
use nsgs::Nsgs;
use runner::Stop;
use std::path::PathBuf;

/// Sheared to a strain of a tenth or so: the stress along x times the height over the force on the wall, and the friction angle (°),
/// both of mean stresses over the second half.
fn sheared(friction: &str) -> (f64, f64) {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("biaxial.toml");
    let case = Case::read(&file, &[("scene.friction".to_owned(), friction.to_owned())]).unwrap();
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-3, max_iterations: 300 };
    let mut march = March::<RoughDiscs>::new(&case).unwrap();
    let (mut force, mut along, mut down) = (0.0, 0.0, 0.0);
    for k in 0..400 {
        let (_, seen) = march.time_step(&Nsgs::default(), &stop).unwrap();
        let top = march.grains().take(march.grain_count()).map(|(r, x, _)| x.y + r).fold(0.0, f64::max);
        if k >= 200 {
            force += seen.stress.xx * top / 24_000.0 / 200.0;
            along += seen.stress.xx;
            down += seen.stress.yy;
        }
    }
    (force, ((down - along) / (down + along)).asin().to_degrees())
}

#[test]
fn a_wall_of_given_force_balances_and_strength_rises_with_friction() {
    let [(balance, smooth), (rough_balance, rough)] = ["0.0", "0.3"].map(sheared);
    // Of the mean over a second, in which the wall of 200 kg gains or loses less than 0.1 m/s: 20 N of 24 kN; fluctuations do not add up.
    assert!((balance - 1.0).abs() < 0.02 && (rough_balance - 1.0).abs() < 0.02, "{balance}, {rough_balance}");
    // Frictionless grains have some strength (of spheres 5.8 degrees: Peyneau, Roux 2008), rough ones much more.
    assert!((3.0..9.0).contains(&smooth) && (13.0..22.0).contains(&rough), "{smooth}, {rough} degrees");
}
