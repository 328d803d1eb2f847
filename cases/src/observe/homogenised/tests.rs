use super::*;
use crate::{Case, March};
use cg::Cg;
use contact::{Discs, Measure, RoughDiscs, Spheres};
use runner::Stop;
use std::path::Path;

/// A case after so many time steps, and the impulses of the last.
fn solved<M: Marched>(case: &str, time_steps: u64, changes: &[(&str, &str)]) -> (Frozen<M>, usize, Vec<f64>)
where
    Cg: contact::Solver<M>,
{
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("{case}.toml"));
    let changes: Vec<_> =
        changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let mut march = March::<M>::new(&Case::read(&path, &changes).unwrap()).unwrap();
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-8, max_iterations: 2000 };
    let solver = Cg::preconditioned();
    let mut last = None;
    for _ in 0..time_steps {
        let next = march.next().unwrap();
        let outcome = march.solve(&next, &solver, &stop, crate::Start::Previous, &|| false).unwrap().0;
        last = Some((next.frozen, outcome.impulses));
    }
    let (frozen, r) = last.unwrap();
    (frozen, march.grain_count(), r)
}

/// Contacts by the quarter of the box that their candidates lie in.
fn quarters<M: Marched>(frozen: &Frozen<M>) -> Vec<u32> {
    let position = frozen.problem.position();
    let middle = |axis: usize| position.iter().map(|x| x[axis]).sum::<f64>() / position.len() as f64;
    let at = |k: usize, axis: usize| {
        let x = position[frozen.problem.contacts()[k].ends().0 as usize];
        u32::from(x[axis] > middle(axis))
    };
    (0..frozen.problem.contact_count()).map(|k| at(k, 0) + 2 * at(k, 1)).collect()
}

fn sums_to_the_whole<M: Marched>((frozen, grains, r): (Frozen<M>, usize, Vec<f64>)) {
    let whole = Homogenised::of(&frozen, grains, (&vec![0; frozen.problem.contact_count()], 1), &r)[0];
    let all = Homogenised::of(&frozen, grains, (&quarters(&frozen), 4), &r);
    let size = whole.stress.iter().fold(0.0, |size, s| f64::max(size, s.abs()));
    assert!(size > 0.0 && whole.coordination > 1.0);
    for k in 0..6 {
        let sum: f64 = all.iter().map(|one| one.volume * one.stress[k]).sum();
        assert!((sum - whole.volume * whole.stress[k]).abs() < 1e-12 * whole.volume * size);
    }
    for one in &all {
        assert!((one.fabric[..3].iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
    let grains: f64 = all.iter().map(|one| one.grains).sum();
    assert!((grains - whole.grains).abs() < 1e-9);
}

#[test]
fn stresses_of_subdomains_weighted_by_their_areas_sum_to_that_of_the_whole() {
    sums_to_the_whole(solved::<Discs>("settled-box", 3, &[]));
    sums_to_the_whole(solved::<RoughDiscs>("rough-box", 40, &[("scene.time_step_s", "0.01")]));
    sums_to_the_whole(solved::<Spheres>("sphere-box", 40, &[]));
}

#[test]
fn column_bears_its_weight_in_each_half() {
    let (frozen, grains, r) = solved::<Discs>("column", 1, &[]);
    // Contacts 0 to 9 of 20; disc 9 is in both halves.
    let half: Vec<u32> = (0..20).map(|k| u32::from(k >= 10)).collect();
    let all = Homogenised::of(&frozen, grains, (&half, 2), &r);
    // Disc k has m g (20 − k) below and m g (19 − k) above it at R = ½ m each: σ_yy = ½ (2(20 − k) − 1) m g / (1 m).
    let mg = 1000.0 * std::f64::consts::PI * 0.25 * 9.81;
    let of = |k: u32| mg * 0.5 * (39.0 - 2.0 * f64::from(k));
    let lower = ((0..9).map(of).sum::<f64>() + 0.5 * of(9)) / 9.5;
    let upper = ((10..20).map(of).sum::<f64>() + 0.5 * of(9)) / 10.5;
    for (one, expected) in all.iter().zip([lower, upper]) {
        assert!((one.stress[1] / expected - 1.0).abs() < 1e-6, "{} for {expected}", one.stress[1]);
        assert_eq!((one.stress[0], one.fabric[1]), (0.0, 1.0));
    }
}

/// 4 × 4 discs of radius ½ m on a square lattice between four walls, all contacts of which push with one impulse.
#[test]
fn crystal_under_pressure_has_that_pressure_in_every_subdomain() {
    use contact::{Contact, Packing};
    use nalgebra::Vector2;
    let side = 4_u32;
    let at = |i: u32, j: u32| i + side * j;
    let mut contacts = Vec::new();
    for (i, j) in (0..side * side).map(|k| (k % side, k / side)) {
        let mut touch = |antagonist, x: f64, y: f64| {
            contacts.push(Contact {
                candidate: at(i, j),
                antagonist,
                normal: Vector2::new(x, y),
                offset: 0.0,
            });
        };
        touch((i > 0).then(|| at(i - 1, j)), 1.0, 0.0);
        touch((j > 0).then(|| at(i, j - 1)), 0.0, 1.0);
        if i == side - 1 {
            touch(None, -1.0, 0.0);
        }
        if j == side - 1 {
            touch(None, 0.0, -1.0);
        }
    }
    let count = (side * side) as usize;
    let place = |k: u32| Vector2::new(f64::from(k % side), f64::from(k / side));
    let position = (0..side * side).map(place).collect();
    let (gap, start) = (vec![0.0; contacts.len()], Vec::new());
    let problem = Packing::new(vec![1.0; count], position, vec![Vector2::zeros(); count], contacts).unwrap();
    let (name, source) = (String::new(), String::new());
    let frozen: Frozen = Frozen {
        name,
        source,
        time_step: 0.01,
        radius: vec![0.5; count],
        gap,
        problem,
        start,
        missed_before: None,
    };
    let r = vec![0.03; frozen.problem.contact_count()];
    // A force of 3 N on each metre of wall.
    for one in Homogenised::of(&frozen, count, (&quarters(&frozen), 4), &r) {
        for (stress, expected) in one.stress.iter().zip([3.0, 3.0, 0.0, 0.0, 0.0, 0.0]) {
            assert!((stress - expected).abs() < 1e-12, "{:?}", one.stress);
        }
        assert!((one.pressure(2) - 3.0).abs() < 1e-12 && (one.coordination - 4.0).abs() < 1e-12);
        assert!((one.fabric[0] - 0.5).abs() < 1e-12 && one.fabric[3] == 0.0);
    }
}
