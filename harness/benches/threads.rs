//! One thread against as many as there are: prints Markdown; `just threads` keeps it in `reports/out/threads.md`.
//!
//! Rounds on one thread and on all take turns, so that what else the machine does, and how fast it runs at the moment,
//! meets both alike.

mod common;

use analysis::Meter;
use cases::Frozen;
use cg::Cg;
use contact::{Discs, Mechanics, RoughDiscs, Solver};
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
    let subdomains = Grid::of(SIDE, SIDE);
    let partition = Scheme::Balanced;
    let nsgs_dd = NsgsDd { subdomains, partition, ..NsgsDd::default() };
    // Directions that stay, so that no iteration factorises.
    let latin_dd = LatinDd { subdomains, partition, kappa_l: Some(40.0), ..LatinDd::default() };
    println!("# Iterations on one thread and on {threads}\n");
    println!(
        "Medians of {ROUNDS} rounds of {ITERATIONS} iterations, in turns; {subdomains} subdomains, those of cg are its own."
    );
    println!("In a run, measures come between two iterations: caches forget, threads fall asleep.\n");
    println!(
        "| method | friction | contacts | between iterations | one thread, ms | {threads} threads, ms | ratio |"
    );
    println!("|---|--:|--:|---|--:|--:|--:|");
    for grains in common::sizes() {
        let cg = Cg::default();
        table::<Discs>(&pools, "0", &common::packing(grains), [&nsgs_dd, &latin_dd, &cg]);
        table::<RoughDiscs>(&pools, "0.3", &common::rough_packing(grains), [&nsgs_dd, &latin_dd, &cg]);
    }
}

/// The rows of one packing.
fn table<M: Mechanics>(
    pools: &[ThreadPool; 2],
    friction: &str,
    frozen: &Frozen<M>,
    methods: [&dyn Solver<M>; 3],
) {
    let contacts = frozen.problem.contact_count();
    for (name, solver) in ["nsgs-dd", "latin-dd", "cg"].iter().zip(methods) {
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
            println!("| {name} | {friction} | {contacts} | {between} | {one:.3} | {all:.3} | {ratio:.2} |");
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
