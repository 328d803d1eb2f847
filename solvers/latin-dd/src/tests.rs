//! The interface conditions (3) at convergence, and what the settings may be.

use super::*;
use crate::balance::Balance;
use crate::run::Run;
use crate::subdomain::Latin;
use analysis::Spectrum;
use cases::{Case, Frozen, March};
use contact::{Measure, RoughDiscs};
use nalgebra::{SVector, Vector2};
use runner::{Status, Stop};
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
        assert!(run.velocity_jump() < 1e-9, "{subdomains}: {} m/s", run.velocity_jump());

        let (mut sum, mut scale) = (0.0_f64, 0.0_f64);
        let Run { decomposition, subdomains: latins, directions, .. } = &run;
        for copies in &decomposition.boundary {
            let mut of_grain = Vector2::zeros();
            for (e, k) in copies {
                let (v, tau, share) = latins[*e as usize].copy(*k as usize);
                let f = tau - (directions.d_minus * share.mass).component_mul(&v);
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
        assert!(refused(LatinDd { kappa_t: bad, ..default }).contains("`kappa_t` is"));
    }
    assert!(refused(LatinDd { kappa_l_minus: Some(-1.0), ..default }).contains("`kappa_l_minus` is -1"));
    assert!(refused(LatinDd { kappa_d_minus: Some(f64::NAN), ..default }).contains("`kappa_d_minus` is NaN"));
    for bad in [0.0, -0.5, 1.01, f64::NAN] {
        assert!(refused(LatinDd { relaxation: bad, ..default }).contains("`relaxation`"));
    }
    assert!(
        refused(LatinDd { subdomains: Grid::of(2000, 1), ..default })
            .contains(&problem.contact_count().to_string())
    );
    let no_l_minus = LatinDd { kappa_l_minus: Some(0.0), ..default };
    assert!(refused(LatinDd { adaptive: Some(true), ..no_l_minus }).contains("`adaptive`"));
    let no_d_minus = LatinDd { kappa_d_minus: Some(0.0), ..default };
    assert!(refused(LatinDd { coarse: true, ..no_d_minus }).contains("`coarse`"));
    assert!(no_l_minus.start(&problem, &r0).is_ok(), "l⁻ = 0 works");
}

/// Iterations to natural map 1e-4 and factorisations, of at most 3000.
fn to_1e_4(problem: &Packing, settings: LatinDd) -> (u64, u64) {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-4, max_iterations: 3000 };
    let r0 = vec![0.0; problem.contact_count()];
    let outcome = runner::solve(&settings, problem, &r0, &stop, &mut |_| ()).unwrap();
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

/// The first problem of three discs that walls squeeze upwards, over a time step (s).
fn almost_closing(time_step: &str) -> Packing {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/almost-closing.toml");
    let case = Case::read(&file, &[("scene.time_step_s".into(), time_step.into())]).unwrap();
    March::new(&case).and_then(|march| march.next()).unwrap().frozen.problem
}

/// While its impulses grow against each other, velocities change by round-off alone.
#[test]
fn directions_do_not_run_away_from_round_off() {
    for time_step in ["0.05", "0.07", "0.1", "0.15", "0.2"] {
        let problem = almost_closing(time_step);
        let r0 = vec![0.0; problem.contact_count()];
        let outcome =
            runner::solve(&LatinDd::default(), &problem, &r0, &Stop::default(), &mut |_| ()).unwrap();
        let kappa = outcome.derived.iter().find(|(key, _)| *key == "kappa_l_minus").unwrap().1;
        assert_eq!(outcome.status, Status::Converged, "{time_step} s: κ = {kappa:e}");
        assert!(kappa < 1e4, "{time_step} s: {kappa:e}");
    }
}

#[test]
fn best_direction_of_any_closed_contacts_is_within_the_limits() {
    let frozen = ["settled-60", "settled-250"].map(|name| frozen(name).problem);
    for problem in frozen.into_iter().chain(["0.005", "0.1"].map(almost_closing)) {
        let limits =
            Balance::new::<contact::Discs>(analysis::scaled_delassus_bound(&problem), 0, 1.0).limits();
        for every in 1..10 {
            let closed: Vec<bool> =
                (0..problem.contact_count()).map(|contact| contact % every == 0).collect();
            if let Some(closed) = Spectrum::of(&problem, Some(&closed)).closed {
                let best = closed.best_direction();
                assert!(limits.contains(&best), "{best} is not in {limits:?}");
            }
        }
    }
}

/// A run on 16 subdomains with a coarse problem.
fn coarse_run(problem: &Packing) -> Run<'_> {
    let settings = LatinDd { coarse: true, subdomains: Grid::of_count(16), ..LatinDd::default() };
    let r0 = vec![0.0; problem.contact_count()];
    settings.bind(problem, settings.directions(problem), &r0).unwrap()
}

/// At κ = 1e18 nothing is left of M in the coarse matrix.
#[test]
fn a_turn_whose_coarse_problem_cannot_be_factorised_changes_nothing() {
    let problem = frozen("shear-box-991-sheared").problem;
    let (mut turned, mut other) = (coarse_run(&problem), coarse_run(&problem));
    for run in [&mut turned, &mut other] {
        (0..5).for_each(|_| run.advance());
    }
    let before = turned.directions;
    let steep = Directions { d_minus: 1e18, ..before };
    turned.turn(steep);
    assert_eq!(turned.directions, before);
    assert!(turned.coarse.is_some());
    (0..5).for_each(|_| turned.advance());
    (0..5).for_each(|_| other.advance());
    let impulses = |run: &Run| {
        let mut r = vec![0.0; problem.contact_count()];
        run.impulses(&mut r);
        r
    };
    assert_eq!(impulses(&turned), impulses(&other));
    assert_eq!(turned.work().factorisations, other.work().factorisations + 16 + 1, "they were tried");

    let settings =
        LatinDd { coarse: true, subdomains: Grid::of_count(16), kappa_d: Some(1e18), ..LatinDd::default() };
    let r0 = vec![0.0; problem.contact_count()];
    let error = settings.start(&problem, &r0).err().unwrap().to_string();
    assert!(error.starts_with("`coarse` is true: it must be false where kappa_d_minus is 1e18"), "{error}");
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

fn assert_leaves_no_resultant<M, const D: usize, const T: usize>(problem: &Packing<M>)
where
    M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
{
    let r0 = vec![0.0; problem.impulse_count()];
    let settings = LatinDd { coarse: true, subdomains: Grid::of_count(16), ..LatinDd::default() };
    let mut run = settings.bind(problem, settings.directions(problem), &r0).unwrap();
    (0..10).for_each(|_| run.advance());
    run.in_subdomains(Latin::linear_stage);
    let coarse = run.coarse.as_mut().unwrap();
    let before = coarse.resultants(&run.subdomains);
    coarse.correct(&mut run.subdomains);
    let after = coarse.resultants(&run.subdomains);
    let greatest = |resultants: &[SVector<f64, T>]| resultants.iter().map(SVector::norm).fold(0.0, f64::max);
    assert!(coarse.interfaces() > 16 && greatest(&before) > 0.0);
    assert!(greatest(&after) < 1e-10 * greatest(&before), "{} of {}", greatest(&after), greatest(&before));
}

#[test]
fn the_coarse_problem_leaves_no_resultant_on_an_interface() {
    assert_leaves_no_resultant(&frozen("shear-box-991-sheared").problem);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/frozen");
    assert_leaves_no_resultant(
        &Frozen::<RoughDiscs>::read(&folder.join("rough-991-mu08.json")).unwrap().problem,
    );
}
