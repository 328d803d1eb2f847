//! The kernels alone, on the packings that the studies use: time per contact is the number to compare.

use cases::{Frozen, detect};
use cg::Cg;
use contact::{Meter, Solver};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use latin_dd::LatinDd;
use nalgebra::Vector2;
use nsgs::{Jacobi, Nsgs, Order};
use nsgs_dd::NsgsDd;
use partition::Grid;
use std::path::Path;

fn packing() -> Frozen {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/frozen");
    Frozen::read(&folder.join("shear-box-991-sheared.json")).unwrap_or_else(|error| panic!("{error}"))
}

/// One `advance` of each method, after the first hundred.
fn iterations(criterion: &mut Criterion) {
    let frozen = packing();
    let problem = &frozen.problem;
    let r0 = frozen.start(false);
    let nsgs = |order| Nsgs { order, ..Nsgs::default() };
    let methods: [(&str, &dyn Solver); 9] = [
        ("nsgs natural", &nsgs(Order::Natural)),
        ("nsgs bottom-up", &nsgs(Order::BottomUp)),
        ("nsgs shuffled", &nsgs(Order::Shuffled)),
        ("nsgs coloured", &nsgs(Order::Coloured)),
        ("jacobi", &Jacobi::default()),
        ("cg", &Cg::default()),
        ("nsgs-dd 4x2", &NsgsDd { subdomains: Grid { nx: 4, ny: 2 }, ..NsgsDd::default() }),
        ("latin-dd 1x1", &LatinDd::default()),
        ("latin-dd 4x2", &LatinDd { subdomains: Grid { nx: 4, ny: 2 }, ..LatinDd::default() }),
    ];
    let mut group = criterion.benchmark_group("iteration");
    group.throughput(Throughput::Elements(problem.contact_count() as u64));
    for (name, solver) in methods {
        let mut iteration = solver.start(problem, &r0).unwrap_or_else(|error| panic!("{error}"));
        (0..100).for_each(|_| iteration.advance());
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| iteration.advance());
        });
    }
    group.finish();
}

/// What a problem's operators and measures cost.
fn operators(criterion: &mut Criterion) {
    let frozen = packing();
    let problem = &frozen.problem;
    let r = vec![1.0; problem.contact_count()];
    let mut product = r.clone();
    let mut scratch = vec![Vector2::zeros(); problem.grain_count()];
    let mut meter = Meter::new(problem);
    let mut group = criterion.benchmark_group("operator");
    group.throughput(Throughput::Elements(problem.contact_count() as u64));
    group.bench_function("W p", |bencher| {
        bencher.iter(|| problem.delassus_product(&r, &mut product, &mut scratch));
    });
    group.bench_function("measures", |bencher| bencher.iter(|| meter.measure(&r, 0.0)));
    group.bench_function("detection", |bencher| {
        bencher.iter(|| detect(problem.position(), &frozen.radius, 1e-3));
    });
    group.finish();
}

criterion_group!(kernels, iterations, operators);
criterion_main!(kernels);
