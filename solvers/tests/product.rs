//! The product with W that methods share, against the plain one, and its bits on threads.

use crate::problems::{any_problem, difference, impulses, start};
use apgd::{Apgd, Preconditioner};
use cg::Cg;
use contact::{Contact, Packing, Solver};
use gradient::Gradient;
use mprgp::{Expansion, Mprgp};
use nalgebra::Vector2;
use product::Product;
use proptest::prelude::*;

struct At {
    p: f64,
    of_p: f64,
}

/// W p in the problem's order, and pᵗ p, pᵗ W p, each found twice.
struct Found {
    of_p: Vec<f64>,
    squared: [f64; 2],
    curvature: [f64; 2],
}

fn found(problem: &Packing, p: &[f64], scaled: bool) -> Found {
    let mut product =
        Product::new(problem, scaled, |k, unit| (At { p: p[k] * unit, of_p: 0.0 }, ())).unwrap();
    let squared = product.push(|at| at.p);
    let curvature = product.curvature();
    product.pull(|at, (), of_p| at.of_p = of_p);
    let squared = [squared, product.sum_of(|at| at.p * at.p)];
    let curvature = [curvature, product.sum_of(|at| at.p * at.of_p)];
    let mut of_p = vec![f64::NAN; p.len()];
    product.impulses(|at| at.of_p, &mut of_p);
    if scaled {
        // Read as if it were an impulse, (W p)_α/√W_αα has become (W p)_α/W_αα.
        of_p.iter_mut().zip(problem.delassus_diagonal()).for_each(|(of_p, w)| *of_p *= w);
    }
    Found { of_p, squared, curvature }
}

/// Asserts that W p and pᵗ W p are those of the plain product, and pᵗ p is Σ p² or Σ `W_αα` p², round-off apart.
#[track_caller]
fn assert_is_the_product(problem: &Packing, p: &[f64], scaled: bool) {
    let mut expected = vec![0.0; p.len()];
    problem.delassus_product(p, &mut expected, &mut vec![Vector2::zeros(); problem.grain_count()]);
    let found = found(problem, p, scaled);
    // W p may be next to nothing where p is not: round-off is that of the terms.
    let terms = || p.iter().zip(problem.delassus_diagonal()).map(|(p, w)| (p * w).abs());
    let size = terms().fold(f64::MIN_POSITIVE, f64::max);
    for (found, expected) in found.of_p.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-12 * size, "{found} instead of {expected} of {size}");
    }
    let dot = |a: &[f64]| a.iter().zip(p).map(|(a, p)| a * p).sum::<f64>();
    let energy: f64 = terms().zip(p).map(|(term, p)| (term * p).abs()).sum();
    assert!(found.curvature.iter().all(|found| (found - dot(&expected)).abs() < 1e-12 * energy));
    let unit = problem.delassus_diagonal().into_iter().map(|w| if scaled { w } else { 1.0 });
    let squared: f64 = p.iter().zip(unit).map(|(p, unit)| p * p * unit).sum();
    assert!(found.squared.iter().all(|found| (found - squared).abs() <= 1e-12 * squared));
}

proptest! {
    #[test]
    fn two_passes_are_the_product(problem in any_problem(), values in prop::collection::vec(-1.0..1.0_f64, 60)) {
        for scaled in [false, true] {
            assert_is_the_product(&problem, &values[..problem.contact_count()], scaled);
        }
    }
}

/// A square lattice of unequal grains with 40,000 contacts: several blocks, and enough of them to wake threads for.
fn lattice() -> Packing {
    let n = 142_u32;
    let grain = |k: u32| f64::from(k * 7919 % 101) / 101.0;
    let grains = || 0..n * n;
    let position = |k: u32| Vector2::new(f64::from(k % n), f64::from(k / n));
    let along = |k: u32, normal: Vector2<f64>, neighbour: u32| Contact {
        candidate: k,
        antagonist: Some(neighbour),
        normal,
        offset: 0.0,
    };
    let contacts = grains().flat_map(|k| {
        let right = (k % n + 1 < n).then(|| along(k, -Vector2::x(), k + 1));
        let above = (k / n + 1 < n).then(|| along(k, -Vector2::y(), k + n));
        [right, above].into_iter().flatten()
    });
    let velocity = |k: u32| Vector2::new(grain(k) - 0.5, grain(k + 1) - 0.6);
    Packing::new(
        grains().map(|k| 0.5 + grain(k)).collect(),
        grains().map(position).collect(),
        grains().map(velocity).collect(),
        contacts.collect(),
    )
    .unwrap()
}

#[test]
fn blocks_make_the_same_product() {
    let problem = lattice();
    let p: Vec<f64> = (0..problem.contact_count()).map(|k| (k as f64).sin()).collect();
    for scaled in [false, true] {
        assert_is_the_product(&problem, &p, scaled);
    }
}

/// Also for the methods on top of it.
#[test]
fn bits_are_the_same_on_any_number_of_threads() {
    let problem = lattice();
    let p: Vec<f64> = (0..problem.contact_count()).map(|k| (k as f64).sin()).collect();
    let diagonal = Apgd { preconditioner: Preconditioner::Diagonal, ..Apgd::default() };
    let fixed = Mprgp { expansion: Expansion::FixedStep, ..Mprgp::default() };
    let cg = Cg::default();
    let solvers =
        [&Gradient::default() as &dyn Solver, &Apgd::default(), &diagonal, &cg, &Mprgp::default(), &fixed];
    let iterates = || {
        let of = |solver: &&dyn Solver| {
            let mut run = start(*solver, &problem);
            (0..20).for_each(|_| run.advance());
            impulses(&*run, &problem)
        };
        solvers.iter().map(of).collect::<Vec<_>>()
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let Found { of_p, squared, curvature } = found(&problem, &p, true);
            (of_p, squared, curvature, iterates())
        })
    };
    let one = on(1);
    assert!(one.3.iter().all(|r| r.iter().any(|r| *r > 0.0)), "contacts press");
    for threads in [2, 5] {
        assert!(on(threads) == one, "{threads} threads");
    }
}

/// In blocks the iterates of the gradient are those of its formula.
#[test]
fn gradient_is_its_formula() {
    let problem = lattice();
    let (contacts, b) = (problem.contact_count(), problem.b());
    let step = 1.0 / analysis::delassus_bound(&problem);
    let (mut r, mut v) = (vec![0.0; contacts], vec![0.0; contacts]);
    let mut scratch = vec![Vector2::zeros(); problem.grain_count()];
    let mut run = start(&Gradient::default(), &problem);
    for _ in 0..20 {
        problem.delassus_product(&r, &mut v, &mut scratch);
        r.iter_mut().zip(v.iter().zip(&b)).for_each(|(r, (v, b))| *r = (*r - step * (v + b)).max(0.0));
        run.advance();
        assert!(difference(&r, &impulses(&*run, &problem)) < 1e-12);
    }
}
