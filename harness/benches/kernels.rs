//! The kernels alone, on packings of several sizes: time per contact is the number to compare.
//!
//! One thread: `RAYON_NUM_THREADS=1`. The sizes: `GRAINS="1000 100000 1000000"`.

mod common;

use analysis::Meter;
use cases::{Frozen, detect};
use cg::Cg;
use contact::acceleration::Acceleration;
use contact::{Iteration, Mechanics, RoughSpheres, Solver, Spheres};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jacobi::Jacobi;
use latin_dd::LatinDd;
use nalgebra::Vector2;
use nsgs::{Nsgs, Order};
use nsgs_dd::NsgsDd;
use partition::{CopySums, Decomposition, Grid, Partition, Scheme};
use std::time::Instant;

/// Subdomains of about a thousand contacts.
fn small_subdomains(frozen: &Frozen) -> Grid {
    let n = (frozen.problem.contact_count() / 1000).max(1).isqrt() as u32;
    Grid::of(n, n)
}

/// One `advance` of each method, after the first ten.
fn iterations(criterion: &mut Criterion) {
    for grains in common::sizes() {
        let frozen = common::packing(grains);
        let (problem, subdomains) = (&frozen.problem, small_subdomains(&frozen));
        let r0 = frozen.start(false);
        let nsgs = |order| Nsgs { order, ..Nsgs::default() };
        // Directions that stay, so that no iteration factorises.
        let latin = |subdomains| LatinDd { subdomains, kappa_l: Some(40.0), ..LatinDd::default() };
        let methods: [(&str, &dyn Solver); 10] = [
            ("nsgs natural", &nsgs(Order::Natural)),
            ("nsgs bottom-up", &nsgs(Order::BottomUp)),
            ("nsgs shuffled", &nsgs(Order::Shuffled)),
            ("nsgs coloured", &nsgs(Order::Coloured)),
            ("jacobi", &Jacobi::default()),
            ("cg", &Cg::default()),
            ("nsgs-dd, one subdomain", &NsgsDd::default()),
            ("nsgs-dd, small subdomains", &NsgsDd { subdomains, ..NsgsDd::default() }),
            ("latin-dd, one subdomain", &latin(Grid::ONE)),
            ("latin-dd, small subdomains", &latin(subdomains)),
        ];
        let mut group = criterion.benchmark_group("iteration");
        group.throughput(Throughput::Elements(problem.contact_count() as u64));
        for (name, solver) in methods {
            let mut iteration = solver.start(problem, &r0).unwrap_or_else(|error| panic!("{error}"));
            (0..10).for_each(|_| iteration.advance());
            group.bench_function(BenchmarkId::new(name, grains), |bencher| {
                bencher.iter(|| iteration.advance());
            });
        }
        group.finish();
    }
}

/// Sweeps that are timed in a run, after its first ten: later ones, near round-off, compute with numbers that no user's run has.
const A_RUN: u64 = 500;

/// One sweep in each mechanics, plain and accelerated.
fn sweeps(criterion: &mut Criterion) {
    for grains in common::sizes() {
        sweeps_of(criterion, "discs", &common::packing(grains));
        sweeps_of(criterion, "discs with friction", &common::rough_packing(grains));
        sweeps_of(criterion, "spheres", &common::packing_in_space::<Spheres>(grains, 0.0));
        sweeps_of(criterion, "spheres with friction", &common::packing_in_space::<RoughSpheres>(grains, 0.3));
    }
}

fn sweeps_of<M: Mechanics>(criterion: &mut Criterion, mechanics: &str, frozen: &Frozen<M>) {
    let (problem, r0) = (&frozen.problem, frozen.start(false));
    let mut group = criterion.benchmark_group(format!("sweep of {mechanics}"));
    group.throughput(Throughput::Elements(problem.contact_count() as u64));
    for (name, acceleration) in [("plain", Acceleration::None), ("accelerated", Acceleration::Nesterov)] {
        let solver = Nsgs { acceleration, ..Nsgs::default() };
        group.bench_function(BenchmarkId::new(name, problem.grain_count()), |bencher| {
            bencher.iter_custom(|iterations| {
                let of_a_run = |first| {
                    let mut iteration = solver.start(problem, &r0).unwrap_or_else(|error| panic!("{error}"));
                    (0..10).for_each(|_| iteration.advance());
                    let start = Instant::now();
                    (first..iterations.min(first + A_RUN)).for_each(|_| iteration.advance());
                    start.elapsed()
                };
                (0..iterations).step_by(A_RUN as usize).map(of_a_run).sum()
            });
        });
    }
    group.finish();
}

/// The two stages of LATIN-DD, the gluing of the boundary grains in the second.
fn stages(criterion: &mut Criterion) {
    for grains in common::sizes() {
        let frozen = common::packing(grains);
        let (problem, r0) = (&frozen.problem, frozen.start(false));
        let mut group = criterion.benchmark_group("stage");
        group.throughput(Throughput::Elements(problem.contact_count() as u64));
        for (name, subdomains) in
            [("one subdomain", Grid::ONE), ("small subdomains", small_subdomains(&frozen))]
        {
            let latin = LatinDd { subdomains, kappa_l: Some(40.0), ..LatinDd::default() };
            let mut run = latin.run(problem, &r0).unwrap_or_else(|error| panic!("{error}"));
            (0..10).for_each(|_| run.advance());
            group.bench_function(BenchmarkId::new(format!("linear, {name}"), grains), |bencher| {
                bencher.iter(|| run.linear_stage());
            });
            group.bench_function(BenchmarkId::new(format!("local, {name}"), grains), |bencher| {
                bencher.iter(|| run.local_stage());
            });
        }
        group.finish();
    }
}

/// What goes before the first iteration: layout, partition, factorisation.
fn starts(criterion: &mut Criterion) {
    for grains in common::sizes() {
        let frozen = common::packing(grains);
        let r0 = frozen.start(false);
        let mut group = criterion.benchmark_group("start");
        group.throughput(Throughput::Elements(frozen.problem.contact_count() as u64)).sample_size(10);
        let latin = LatinDd { kappa_l: Some(40.0), ..LatinDd::default() };
        let methods: [(&str, &dyn Solver); 4] = [
            ("nsgs", &Nsgs::default()),
            ("cg", &Cg::default()),
            ("nsgs-dd", &NsgsDd::default()),
            ("latin-dd", &latin),
        ];
        for (name, solver) in methods {
            group.bench_function(BenchmarkId::new(name, grains), |bencher| {
                bencher.iter(|| solver.start(&frozen.problem, &r0).map(drop));
            });
        }
        group.finish();
    }
}

/// What a problem's operators, the sums over copies, its measures and its detection cost.
fn operators(criterion: &mut Criterion) {
    for grains in common::sizes() {
        let frozen = common::packing(grains);
        let problem = &frozen.problem;
        let r = vec![1.0; problem.contact_count()];
        let mut product = r.clone();
        let mut scratch = vec![Vector2::zeros(); problem.grain_count()];
        let mut meter = Meter::new(problem);
        let mut group = criterion.benchmark_group("operator");
        group.throughput(Throughput::Elements(problem.contact_count() as u64));
        group.bench_function(BenchmarkId::new("W p", grains), |bencher| {
            bencher.iter(|| problem.delassus_product(&r, &mut product, &mut scratch));
        });
        group.bench_function(BenchmarkId::new("measures", grains), |bencher| {
            bencher.iter(|| meter.measure(&r, 0.0));
        });
        group.bench_function(BenchmarkId::new("detection", grains), |bencher| {
            bencher.iter(|| detect(problem.position(), &frozen.radius, 1e-3));
        });
        let partition = Partition::of_contacts(problem, Scheme::Balanced, small_subdomains(&frozen));
        let partition = partition.unwrap_or_else(|error| panic!("{error}"));
        let decomposition = Decomposition::new(problem, &partition);
        let mut sums = CopySums::new(&decomposition);
        let subdomains = decomposition.subdomains.iter();
        let mut y: Vec<_> = subdomains.map(|e| vec![Vector2::<f64>::x(); e.boundary.len()]).collect();
        group.bench_function(BenchmarkId::new("sums over copies, small subdomains", grains), |bencher| {
            bencher.iter(|| {
                sums.send(&mut y, 0, |y, sent| sent.copy_from_slice(y));
                sums.receive(&mut y, 0, |y, sums| y.iter_mut().zip(sums).for_each(|(y, sum)| *y = 0.5 * sum));
            });
        });
        group.finish();
    }
}

/// What goes before a problem: the deposit of the discs, and the problem of a time step whose pairs are known.
fn scenes(criterion: &mut Criterion) {
    for grains in common::sizes() {
        let march = common::scene(grains);
        let mut group = criterion.benchmark_group("scene");
        group.throughput(Throughput::Elements(grains as u64)).sample_size(10);
        group.bench_function(BenchmarkId::new("deposit", grains), |bencher| {
            bencher.iter(|| common::scene(grains));
        });
        group.bench_function(BenchmarkId::new("problem of a time step", grains), |bencher| {
            bencher.iter(|| march.next());
        });
        group.finish();
    }
}

criterion_group!(kernels, iterations, sweeps, stages, starts, operators, scenes);
criterion_main!(kernels);
