//! Sweeps and conjugate gradients in single and in mixed precision: that they are those of double precision but for round-off, and where
//! they end.

use crate::problems::{difference, packing};
use cg::{Cg, Suited};
use contact::acceleration::Acceleration;
use contact::precision::Precision;
use contact::{Discs, Mechanics, Packing, RoughDiscs, RoughSpheres, Solver, Spheres};
use nsgs::Nsgs;
use runner::{Outcome, Status, Stop, solve};

const BOTH: [Acceleration; 2] = [Acceleration::None, Acceleration::Nesterov];

fn settings(acceleration: Acceleration, precision: Precision) -> Nsgs {
    Nsgs { acceleration, precision, ..Nsgs::default() }
}

/// A run to a natural map of 1e-10, and the least natural map on its way.
fn run<M: Mechanics>(problem: &Packing<M>, settings: &impl Solver<M>, max_iterations: u64) -> (Outcome, f64) {
    let stop = Stop { tolerance: 1e-10, max_iterations, ..Stop::default() };
    let mut least = f64::INFINITY;
    let outcome = solve(settings, problem, &vec![0.0; problem.impulse_count()], &stop, &mut |progress| {
        least = least.min(progress.measures.map_or(f64::INFINITY, |measures| measures.natural_map));
    });
    (outcome.unwrap(), least)
}

/// Impulses after some iterations.
fn after<M: Mechanics>(problem: &Packing<M>, settings: &impl Solver<M>, iterations: u32) -> Vec<f64> {
    let mut r = vec![0.0; problem.impulse_count()];
    let mut run = settings.start(problem, &r).unwrap();
    (0..iterations).for_each(|_| run.advance());
    run.impulses(&mut r);
    r
}

/// Thirty iterations of each precision. Their impulses differ by the round-off of that many visits of a contact, which the next contacts
/// hand on: with ε = 6e-8 some 2e-6.
fn assert_is_the_double_sweep<M: Mechanics>(problem: &Packing<M>) {
    for acceleration in BOTH {
        let double = after(problem, &settings(acceleration, Precision::Double), 30);
        for precision in [Precision::Single, Precision::Mixed] {
            let off = difference(&after(problem, &settings(acceleration, precision), 30), &double);
            let what = format!("{}, {acceleration:?}, {precision:?}: {off:e}", M::NAME);
            assert!(off > 0.0 && off < 2e-5, "{what}");
        }
    }
}

#[test]
fn sweeps_of_every_precision_are_the_same_but_for_round_off() {
    assert_is_the_double_sweep::<Discs>(&packing("settled-250"));
    assert_is_the_double_sweep::<RoughDiscs>(&packing("rough-250"));
    assert_is_the_double_sweep::<Spheres>(&packing("spheres-250"));
    assert_is_the_double_sweep::<RoughSpheres>(&packing("rough-spheres-250"));
}

/// The natural map that round-off alone makes where impulses r are kept in single precision: ε |s| of each contact, over the scale.
fn round_off<M: Mechanics>(problem: &Packing<M>, r: &[f64]) -> f64 {
    let squared: f64 = r.iter().zip(problem.delassus_diagonal()).map(|(r, w)| w * r * r).sum();
    f64::from(f32::EPSILON / 2.0) * (squared / problem.scale()).sqrt()
}

fn assert_ends_at_round_off<M: Mechanics>(problem: &Packing<M>) {
    let (outcome, least) = run(problem, &settings(Acceleration::Nesterov, Precision::Single), 5_000);
    let expected = round_off(problem, &outcome.impulses);
    println!("{}: least {least:e}, expected {expected:e}, {:e}", M::NAME, least / expected);
    assert_eq!(outcome.status, Status::IterationLimit, "{}", M::NAME);
    assert!(least > expected / 10.0 && least < 10.0 * expected, "{}: {least:e} for {expected:e}", M::NAME);
    assert!(least > 1e-9 && least < 1e-4, "{}: {least:e}", M::NAME);
}

/// A visit cannot change s by less than ε |s|, so that what it would change stays: within a factor of ten of that.
#[test]
fn single_precision_ends_at_its_round_off() {
    assert_ends_at_round_off::<Discs>(&packing("settled-60"));
    assert_ends_at_round_off::<Discs>(&packing("settled-250"));
    assert_ends_at_round_off::<RoughDiscs>(&packing("rough-250"));
    assert_ends_at_round_off::<Spheres>(&packing("spheres-250"));
}

/// In as many plain sweeps, to 1 %; extrapolation and its restarts amplify round-off, which may help or not: within a factor of 1.5.
fn assert_reaches_the_tolerance_of_double<M: Mechanics>(
    problem: &Packing<M>,
    accelerations: &[Acceleration],
) {
    for acceleration in accelerations {
        let [double, mixed] = [Precision::Double, Precision::Mixed]
            .map(|precision| run(problem, &settings(*acceleration, precision), 20_000).0);
        let what = format!("{acceleration:?}: {} and {}", double.iterations, mixed.iterations);
        println!("{what}");
        assert_eq!([double.status, mixed.status], [Status::Converged; 2], "{what}");
        let factor = if *acceleration == Acceleration::None { 1.01 } else { 1.5 };
        assert!((mixed.iterations as f64) < factor * double.iterations as f64, "{what}");
        assert!(mixed.work.delassus_products <= 2 + mixed.iterations / 40, "renewals are rare: {what}");
    }
}

#[test]
fn mixed_precision_reaches_the_tolerance_of_double() {
    assert_reaches_the_tolerance_of_double::<Discs>(&packing("settled-60"), &BOTH);
    assert_reaches_the_tolerance_of_double::<Discs>(&packing("settled-250"), &BOTH[1..]);
    assert_reaches_the_tolerance_of_double::<Spheres>(&packing("spheres-250"), &BOTH);
}

fn gradient(precision: Precision) -> Cg {
    Cg { precision, ..Cg::preconditioned() }
}

/// Some iterations, fewer than those after which u is made from r; with friction one, since a contact then slides as its first impulse
/// points, round-off and all.
fn assert_is_the_double_gradient<M: Suited>(problem: &Packing<M>, iterations: u32) {
    let double = after(problem, &gradient(Precision::Double), iterations);
    for precision in [Precision::Single, Precision::Mixed] {
        let off = difference(&after(problem, &gradient(precision), iterations), &double);
        println!("{}, {precision:?}: {off:e}", M::NAME);
        assert!(off > 0.0 && off < 1e-4, "{}, {precision:?}: {off:e}", M::NAME);
    }
}

#[test]
fn conjugate_gradients_of_every_precision_are_the_same_but_for_round_off() {
    assert_is_the_double_gradient::<Discs>(&packing("settled-250"), 15);
    assert_is_the_double_gradient::<Spheres>(&packing("spheres-250"), 15);
    assert_is_the_double_gradient::<RoughDiscs>(&packing("rough-250"), 1);
    assert_is_the_double_gradient::<RoughSpheres>(&packing("rough-spheres-250"), 1);
}

/// In single precision u is never that of r, and ends where round-off of W r leaves it; in mixed precision it is made in double precision
/// from time to time.
fn assert_mixed_gradient_reaches_the_tolerance_of_double<M: Suited>(problem: &Packing<M>) {
    let [double, mixed, single] = [Precision::Double, Precision::Mixed, Precision::Single]
        .map(|precision| run(problem, &gradient(precision), 5_000));
    println!("{} and {}; {:e}", double.0.iterations, mixed.0.iterations, single.1);
    assert_eq!([double.0.status, mixed.0.status], [Status::Converged; 2], "{}", M::NAME);
    assert!((mixed.0.iterations as f64) < 1.5 * double.0.iterations as f64, "{}", M::NAME);
    assert_eq!(single.0.status, Status::IterationLimit, "{}", M::NAME);
    assert!(single.1 > 1e-9 && single.1 < 1e-4, "{}: {:e}", M::NAME, single.1);
}

#[test]
fn conjugate_gradients_in_mixed_precision_reach_the_tolerance_of_double() {
    assert_mixed_gradient_reaches_the_tolerance_of_double::<Discs>(&packing("settled-60"));
    assert_mixed_gradient_reaches_the_tolerance_of_double::<Discs>(&packing("settled-250"));
    assert_mixed_gradient_reaches_the_tolerance_of_double::<Spheres>(&packing("spheres-250"));
}
