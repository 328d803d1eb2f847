//! One thread against as many as there are: prints Markdown; `just threads` keeps it in `reports/out/threads.md`.
//!
//! Rounds on one thread and on all take turns, so that what else the machine does, and how fast it runs at the moment,
//! meets both alike.

mod common;

use analysis::Meter;
use cases::Frozen;
use cg::Cg;
use contact::acceleration::Acceleration;
use contact::{Discs, Mechanics, RoughDiscs, RoughSpheres, Solver, Spheres};
use latin_dd::LatinDd;
use nsgs_dd::NsgsDd;
use partition::{Grid, Scheme};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::time::Instant;

const ROUNDS: usize = 15;
const ITERATIONS: usize = 50;

/// Columns and rows of subdomains.
const SIDE: u32 = 8;

fn main() {
    let threads = rayon::current_num_threads();
    let pools = [1, threads].map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap_or_else(|error| panic!("{error}"))
    });
    println!("# Iterations on one thread and on {threads}\n");
    println!(
        "Medians of {ROUNDS} rounds of {ITERATIONS} iterations, in turns; {SIDE} × {SIDE} subdomains, those of cg are its own."
    );
    println!("In a run, measures come between two iterations: caches forget, threads fall asleep.\n");
    println!(
        "| mechanics | method | contacts | between iterations | one thread, ms | {threads} threads, ms | ratio |"
    );
    println!("|---|---|--:|---|--:|--:|--:|");
    for grains in common::sizes() {
        table::<Discs>(&pools, "discs", &common::packing(grains));
        table::<RoughDiscs>(&pools, "discs with friction", &common::rough_packing(grains));
        table::<Spheres>(&pools, "spheres", &common::packing_in_space(grains, 0.0));
        table::<RoughSpheres>(&pools, "spheres with friction", &common::packing_in_space(grains, 0.3));
    }
}

/// Prints the rows of one packing.
fn table<M: Mechanics>(pools: &[ThreadPool; 2], mechanics: &str, frozen: &Frozen<M>)
where
    NsgsDd: Solver<M>,
    LatinDd: Solver<M>,
    Cg: Solver<M>,
{
    let (subdomains, partition) = (Grid::of(SIDE, SIDE), Scheme::Balanced);
    let nsgs_dd = NsgsDd { subdomains, partition, ..NsgsDd::default() };
    let accelerated = NsgsDd { acceleration: Acceleration::Nesterov, ..nsgs_dd };
    // Directions that stay, so that no iteration factorises.
    let latin_dd = LatinDd { subdomains, partition, kappa_l: Some(40.0), ..LatinDd::default() };
    let methods: [(&str, &dyn Solver<M>); 4] = [
        ("nsgs-dd", &nsgs_dd),
        ("nsgs-dd, accelerated", &accelerated),
        ("latin-dd", &latin_dd),
        ("cg", &Cg::default()),
    ];
    let contacts = frozen.problem.contact_count();
    for (name, solver) in methods {
        for (between, measured) in [("nothing", false), ("measures", true)] {
            let mut times = [Vec::new(), Vec::new()];
            for _ in 0..ROUNDS {
                for (pool, times) in pools.iter().zip(&mut times) {
                    times.push(round(pool, frozen, solver, measured));
                }
            }
            let ratios = times[0].iter().zip(&times[1]).map(|(one, all)| one / all).collect();
            let [one, all] = times.map(|times| 1e3 * median(times));
            let ratio = median(ratios);
            println!("| {mechanics} | {name} | {contacts} | {between} | {one:.3} | {all:.3} | {ratio:.2} |");
        }
    }
}

/// The median time of an iteration (s).
fn round<M: Mechanics>(pool: &ThreadPool, frozen: &Frozen<M>, solver: &dyn Solver<M>, measured: bool) -> f64 {
    pool.install(|| {
        let problem = &frozen.problem;
        let mut r = frozen.start(false);
        let mut iteration = solver.start(problem, &r).unwrap_or_else(|error| panic!("{error}"));
        let mut meter = Meter::new(problem);
        (0..5).for_each(|_| iteration.advance());
        let times = (0..ITERATIONS).map(|_| {
            let clock = Instant::now();
            iteration.advance();
            let seconds = clock.elapsed().as_secs_f64();
            if measured {
                iteration.impulses(&mut r);
                meter.measure_after(&[], &r, iteration.velocity_jump());
            }
            seconds
        });
        median(times.collect())
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
