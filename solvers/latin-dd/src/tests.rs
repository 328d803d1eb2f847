//! The interface conditions (3) at convergence, and what the settings may be.

use super::*;
use crate::run::Run;
use crate::subdomain::Latin;
use cases::Frozen;
use contact::{Measure, Stop};
use nalgebra::Vector2;
use std::path::Path;

fn frozen(name: &str) -> Frozen {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/frozen");
    Frozen::read(&folder.join(name).with_extension("json")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn interface_velocities_agree_and_interface_impulses_sum_to_zero() {
    let problem = frozen("shear-box-991-sheared").problem;
    let r0 = vec![0.0; problem.contact_count()];
    let mut greatest_multiplicity = 0;
    for subdomains in [2, 4, 8, 64].map(Grid::of_count) {
        let settings = LatinDd { subdomains, ..LatinDd::default() };
        let mut run = settings.bind(&problem, settings.directions(&problem), &r0).unwrap();
        (0..1500).for_each(|_| run.advance());
        // Velocities are of the order of 1 m/s; 1500 iterations are past where round-off stops the run.
        assert!(run.velocity_jump < 1e-9, "{subdomains}: {} m/s", run.velocity_jump);

        let (mut sum, mut scale) = (0.0_f64, 0.0_f64);
        let Run { decomposition, subdomains: latins, directions, .. } = &run;
        for copies in decomposition.boundary() {
            let mut of_grain = Vector2::zeros();
            for (e, local) in copies {
                let (v, tau, mass) = latins[*e as usize].boundary(*local);
                let f = tau - directions.d_minus * mass * v;
                scale = scale.max(f.norm());
                of_grain += f;
            }
            sum = sum.max(of_grain.norm());
            greatest_multiplicity = greatest_multiplicity.max(copies.len());
        }
        assert!(sum < 1e-8 * scale, "{subdomains}: {sum} of {scale} N·s");
    }
    assert!(greatest_multiplicity >= 4, "{greatest_multiplicity}");
}

#[test]
fn senseless_settings_are_refused_by_name() {
    let problem = frozen("shear-box-991-sheared").problem;
    let r0 = vec![0.0; problem.contact_count()];
    let refused = |settings: LatinDd| match settings.start(&problem, &r0) {
        Ok(_) => panic!("{settings:?} was accepted"),
        Err(error) => error.to_string(),
    };
    let default = LatinDd::default();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(LatinDd { kappa_l: Some(bad), ..default }).contains("`kappa_l` is"));
        assert!(refused(LatinDd { kappa_d: Some(bad), ..default }).contains("`kappa_d` is"));
    }
    assert!(refused(LatinDd { kappa_l_minus: Some(-1.0), ..default }).contains("`kappa_l_minus` is -1"));
    assert!(refused(LatinDd { kappa_d_minus: Some(f64::NAN), ..default }).contains("`kappa_d_minus` is NaN"));
    for bad in [0.0, -0.5, 1.01, f64::NAN] {
        assert!(refused(LatinDd { relaxation: bad, ..default }).contains("`relaxation`"));
    }
    assert!(
        refused(LatinDd { subdomains: Grid { nx: 2000, ny: 1 }, ..default })
            .contains(&problem.contact_count().to_string())
    );
    let no_l_minus = LatinDd { kappa_l_minus: Some(0.0), ..default };
    assert!(refused(LatinDd { adaptive: Some(true), ..no_l_minus }).contains("`adaptive`"));
    let no_d_minus = LatinDd { kappa_d_minus: Some(0.0), ..default };
    assert!(refused(LatinDd { coarse: true, ..no_d_minus }).contains("`coarse`"));
    assert!(no_l_minus.start(&problem, &r0).is_ok(), "l⁻ = 0 works");
}

/// Iterations to natural map 1e-4 and factorisations, of at most 3000.
fn to_1e_4(problem: &ContactProblem, settings: LatinDd) -> (u64, u64) {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-4, max_iterations: 3000 };
    let r0 = vec![0.0; problem.contact_count()];
    let outcome = contact::solve(&settings, problem, &r0, &stop, &mut |_| ()).unwrap();
    (outcome.iterations, outcome.work.factorisations)
}

#[test]
fn adaptive_directions_mend_a_bad_one_with_a_few_factorisations() {
    let problem = frozen("shear-box-991-sheared").problem;
    for bad in [2.0, 600.0] {
        for subdomains in [1, 4].map(Grid::of_count) {
            let fixed = LatinDd { kappa_l: Some(bad), subdomains, ..LatinDd::default() };
            let adaptive = LatinDd { adaptive: Some(true), ..fixed };
            let (iterations, factorisations) = to_1e_4(&problem, adaptive);
            assert!(3 * iterations < to_1e_4(&problem, fixed).0, "{bad}, {subdomains}: {iterations}");
            assert!(factorisations <= 6 * subdomains.count(), "{factorisations}");
        }
    }
}

#[test]
fn matched_directions_scale_and_a_low_interface_direction_does_not() {
    let problem = frozen("shear-box-991-sheared").problem;
    let iterations = |subdomains, kappa_d| {
        let settings = LatinDd {
            kappa_l: Some(40.0),
            kappa_d: Some(kappa_d),
            subdomains: Grid::of_count(subdomains),
            ..LatinDd::default()
        };
        to_1e_4(&problem, settings).0
    };
    let (one, matched, low) = (iterations(1, 40.0), iterations(25, 40.0), iterations(25, 0.3));
    assert!(10 * matched <= 13 * one, "{one} to {matched}");
    assert!(low > 5 * one, "{one} to {low}");
}

#[test]
fn the_coarse_problem_leaves_no_resultant_on_an_interface() {
    let problem = frozen("shear-box-991-sheared").problem;
    let r0 = vec![0.0; problem.contact_count()];
    let settings = LatinDd { coarse: true, subdomains: Grid::of_count(16), ..LatinDd::default() };
    let mut run = settings.bind(&problem, settings.directions(&problem), &r0).unwrap();
    (0..10).for_each(|_| run.advance());
    run.in_subdomains(Latin::linear_stage);
    let coarse = run.coarse.as_ref().unwrap();
    let before = coarse.resultants(&run.subdomains);
    coarse.correct(&mut run.subdomains);
    let after = coarse.resultants(&run.subdomains);
    let greatest = |resultants: &[Vector2<f64>]| resultants.iter().map(Vector2::norm).fold(0.0, f64::max);
    assert!(coarse.interfaces() > 16 && greatest(&before) > 0.0);
    assert!(greatest(&after) < 1e-10 * greatest(&before), "{} of {}", greatest(&after), greatest(&before));
}
