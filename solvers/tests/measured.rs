//! Whichever iterates are measured, a run is the same; and what its measures are, in the plainest way.

use crate::fuzz::{methods, worst_problem};
use crate::problems::{any_problem, first_problem, frozen, impulses, start};
use analysis::Meter;
use apgd::Apgd;
use cg::Cg;
use contact::{Measure, Measures, Packing, Solver, Truth, greatest};
use latin_dd::LatinDd;
use nalgebra::Vector2;
use nncg::Nncg;
use nsgs::{Nsgs, Order};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use runner::{Measured, Outcome, Stop, solve_against};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// The run, and the measures of the iterates that were measured; `None` if the method refuses the problem.
fn run(
    measured: Measured,
    solver: &dyn Solver,
    problem: &Packing,
    truth: Option<&Truth>,
    stop: &Stop,
) -> Option<(Outcome, BTreeMap<u64, Measures>)> {
    let (r0, mut seen) = (vec![0.0; problem.contact_count()], BTreeMap::new());
    let ended = solve_against(truth, solver, problem, &r0, stop, measured, &mut |progress| {
        seen.extend(progress.measures.map(|measures| (progress.iteration, *measures)));
        ControlFlow::Continue(())
    });
    Some((ended.ok()?, seen))
}

/// All bits of an iterate's measures.
fn bits(measures: &Measures) -> (Vec<u64>, Option<usize>) {
    let others = [measures.energy_gap, measures.velocity_jump, measures.energy];
    let all = Measure::ALL.into_iter().map(|measure| measures.get(measure)).chain(others);
    (all.map(f64::to_bits).collect(), measures.worst_contact)
}

/// Asserts that the run is the same whatever is measured; returns how many iterates were measured of how many.
fn assert_same(
    what: &str,
    solver: &dyn Solver,
    problem: &Packing,
    truth: Option<&Truth>,
    stop: &Stop,
) -> [usize; 2] {
    let Some((every, all)) = run(Measured::Every, solver, problem, truth, stop) else { return [0; 2] };
    let iterations = every.iterations;
    assert!(all.keys().copied().eq(0..=iterations), "{what}");
    let mut count = all.len();
    for measured in [Measured::Grid, Measured::Needed] {
        let (ended, seen) = run(measured, solver, problem, truth, stop).expect("it was not refused before");
        let what = format!("{what}, {measured:?}, {stop:?}");
        assert_eq!((ended.status, ended.iterations), (every.status, iterations), "{what}");
        assert_eq!(bits(&ended.measures), bits(&every.measures), "{what}");
        assert_eq!(ended.work, every.work, "{what}");
        let equal = |a: &f64, b: &f64| a.to_bits() == b.to_bits();
        assert!(ended.impulses.iter().zip(&every.impulses).all(|(a, b)| equal(a, b)), "{what}");
        assert!(seen.contains_key(&iterations), "{what}: the last iterate is measured");
        for (iteration, measures) in &seen {
            assert_eq!(bits(measures), bits(&all[iteration]), "{what}, iteration {iteration}");
        }
        if measured == Measured::Grid {
            assert!((0..=iterations.min(200)).all(|iteration| seen.contains_key(&iteration)), "{what}");
            let known: Vec<u64> = seen.keys().copied().collect();
            let gap = |pair: &[u64]| pair[1] - pair[0] <= (pair[0] / 200).max(1);
            assert!(known.windows(2).all(gap), "{what}: iterates in a ratio of at most 1.005");
        }
        count = seen.len();
    }
    [count, all.len()]
}

fn any_stop(max_iterations: u64) -> impl Strategy<Value = Stop> {
    (0..Measure::ALL.len(), 0.5..9.0_f64).prop_map(move |(on, digits)| Stop {
        on: Measure::ALL[on],
        tolerance: 10_f64.powf(-digits),
        max_iterations,
    })
}

/// The impulses before and after the last of so many sweeps.
fn last_two(problem: &Packing, sweeps: u32) -> (Vec<f64>, Vec<f64>) {
    let mut iteration = start(&Nsgs::default(), problem);
    (1..sweeps).for_each(|_| iteration.advance());
    let before = impulses(&*iteration, problem);
    iteration.advance();
    (before, impulses(&*iteration, problem))
}

/// A truth for the measures that want one: any velocity that impulses can make does.
fn any_truth(problem: &Packing) -> Truth {
    let mut iteration = start(&Cg::default(), problem);
    (0..30).for_each(|_| iteration.advance());
    let r: Vec<f64> =
        impulses(&*iteration, problem).iter().map(|r| if r.is_finite() { *r } else { 0.0 }).collect();
    Truth::new(problem, &r)
}

proptest! {
    #[test]
    fn a_run_is_the_same_whichever_iterates_are_measured(
        problem in prop_oneof![any_problem(), worst_problem()], stop in any_stop(1500), method in 0..methods().len()
    ) {
        let (name, solver) = methods().swap_remove(method);
        let truth = any_truth(&problem);
        assert_same(name, &*solver, &problem, Some(&truth), &stop);
    }

    #[test]
    fn an_iterate_that_goes_on_has_a_measure_above_the_tolerance(
        problem in any_problem(), digits in 0.0..6.0_f64, sweeps in 1..40_u32
    ) {
        let (before, r) = last_two(&problem, sweeps);
        let truth = any_truth(&problem);
        let mut meter = Meter::new(&problem).against(&truth);
        let measures = meter.measure_after(&before, &r, 0.0);
        for on in Measure::ALL {
            for tolerance in [10_f64.powf(-digits), measures.get(on), 0.999 * measures.get(on)] {
                let goes_on = meter.goes_on(on, tolerance, f64::INFINITY, (&before, &r));
                prop_assert!(!goes_on || !(measures.get(on) <= tolerance), "{on} {tolerance}");
            }
            // Nor one of too much energy.
            let goes_on = meter.goes_on(on, 0.0, 0.5 * measures.energy, (&before, &r));
            prop_assert!(!goes_on || measures.energy <= 0.0, "{on}: {}", measures.energy);
        }
    }

    #[test]
    fn measures_are_those_of_the_plainest_sums(problem in any_problem(), sweeps in 2..40_u32) {
        let (before, r) = last_two(&problem, sweeps);
        let truth = any_truth(&problem);
        let measures = Meter::new(&problem).against(&truth).measure_after(&before, &r, 0.0);
        for (name, is, expected) in plain(&problem, &truth, (&before, &r), &measures) {
            let equal = is.is_nan() && expected.is_nan() || is == expected;
            // Impulses of some kg m/s, masses over four decades, and differences of what nearly cancels.
            prop_assert!(equal || (is - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{name}: {is:e}, {expected:e}");
        }
    }
}

/// Each measure by its name, as it is, and from its definition in sums one after the other.
fn plain<'n>(
    problem: &Packing,
    truth: &Truth,
    (before, r): (&[f64], &[f64]),
    is: &Measures,
) -> [(&'n str, f64, f64); 8] {
    let (mut velocity, mut v) = (vec![Vector2::zeros(); problem.grain_count()], vec![0.0; r.len()]);
    problem.velocity(r, &mut velocity);
    problem.relative_velocity(&velocity, &mut v);
    let (w, b) = (problem.delassus_diagonal(), problem.b());
    let r_plus: Vec<f64> = (0..r.len()).map(|k| (r[k] - v[k] / w[k]).max(0.0)).collect();
    let sum = |term: &dyn Fn(usize) -> f64| (0..r.len()).map(term).sum::<f64>();
    let product = sum(&|k| r[k] * before[k]);
    let zeta = (sum(&|k| (r[k] - before[k]).powi(2)) / product).sqrt();
    let dv = |k: usize| w[k] * (r_plus[k] - r[k]);
    let wr = 0.5 * sum(&|k| (w[k] * r[k]).powi(2) + (w[k] * r_plus[k]).powi(2));
    let active = (0..r.len()).filter(|k| r[*k] > 0.0 || r_plus[*k] > 0.0).count().max(1) as f64;
    let over = |a: f64, b: f64| if a == 0.0 { 0.0 } else { a / b };
    let natural_map = over(sum(&|k| dv(k).powi(2) / w[k]).sqrt(), problem.scale().sqrt());
    let distance = |v: &[Vector2<f64>]| problem.velocity_distance(v, truth.velocity());
    [
        ("zeta", is.zeta, if product > 0.0 { zeta } else { f64::NAN }),
        ("natural_map", is.natural_map, natural_map),
        ("penetration_rate", is.penetration_rate, greatest(v.iter().map(|v| -v))),
        ("quad_dv", is.quad_dv, over(sum(&|k| dv(k).powi(2)).sqrt(), wr.sqrt())),
        ("max_dv", is.max_dv, over(greatest((0..r.len()).map(|k| dv(k).abs())), (wr / active).sqrt())),
        ("energy", is.energy, 0.5 * sum(&|k| r[k] * (v[k] + b[k]))),
        ("velocity_error", is.velocity_error, over(distance(&velocity), distance(problem.free_velocity()))),
        ("rate at the worst contact", is.worst_contact.map_or(0.0, |k| -v[k]), is.penetration_rate),
    ]
}

#[test]
fn runs_on_packings_end_at_the_same_iterate_whichever_are_measured() {
    let methods: [(&str, Box<dyn Solver>); 7] = [
        ("nsgs", Box::new(Nsgs::default())),
        ("nsgs, ω = 1.93", Box::new(Nsgs { relaxation: 1.93, order: Order::Coloured, ..Nsgs::default() })),
        ("cg", Box::new(Cg::default())),
        ("cg, preconditioned", Box::new(Cg::preconditioned())),
        ("apgd", Box::new(Apgd::default())),
        ("nncg", Box::new(Nncg::default())),
        ("latin-dd", Box::new(LatinDd::default())),
    ];
    let problem = frozen("shear-box-991-sheared").problem;
    let truth = any_truth(&problem);
    for (name, solver) in methods {
        for on in Measure::ALL {
            for tolerance in [1e-2, 3e-4, 1e-6] {
                let stop = Stop { on, tolerance, max_iterations: 900 };
                let [measured, all] = assert_same(name, &*solver, &problem, Some(&truth), &stop);
                if on == Measure::NaturalMap && all > 800 && tolerance < 1e-5 {
                    assert!(
                        4 * measured < all,
                        "{name}: {measured} of {all} were measured for the stop rule"
                    );
                }
            }
        }
    }
}

#[test]
fn measures_have_the_same_bits_with_any_number_of_threads() {
    let overrides = [("sample.grains", "20000"), ("scene.box.width_m", "21.5")];
    let problem = first_problem("deposited-box", &overrides).problem;
    let mut iteration = start(&Nsgs::default(), &problem);
    (0..5).for_each(|_| iteration.advance());
    let before = impulses(&*iteration, &problem);
    iteration.advance();
    let r = impulses(&*iteration, &problem);
    let truth = any_truth(&problem);
    let measured = [1, 2, 5].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bits(&Meter::new(&problem).against(&truth).measure_after(&before, &r, 0.0)))
    });
    assert!(measured[0] == measured[1] && measured[0] == measured[2], "{measured:?}");
}
