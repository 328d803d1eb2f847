//! One thread against as many as there are: prints Markdown; `just threads` keeps it in `reports/out/threads.md`.
//!
//! Rounds on one thread and on all take turns, so that what else the machine does, and how fast it runs at the moment,
//! meets both alike.
//!
//! What more threads would do is predicted from these times and from the contacts of each subdomain: an iteration takes
//!
//! T(n) = s(n) T(1) + w log₂ n,   w = max(0, T(n₀) − s(n₀) T(1)) / log₂ n₀
//!
//! with s(n) the greatest share of the contacts that one of n threads has, where each takes the largest subdomain that is left, and w all that
//! kept the n₀ threads that there were from it: sections that end together, and memory that threads share.

mod common;

use analysis::Meter;
use cases::Frozen;
use cg::Cg;
use contact::acceleration::Acceleration;
use contact::{Discs, Mechanics, RoughDiscs, RoughSpheres, Solver, Spheres};
use latin_dd::LatinDd;
use nsgs_dd::NsgsDd;
use partition::{Grid, Partition, Scheme};
use product::Layout;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::time::Instant;

const ROUNDS: usize = 15;
const ITERATIONS: usize = 50;

/// Columns and rows of subdomains.
const SIDE: u32 = 8;

/// Threads for which a ratio is predicted.
const PREDICTED: [usize; 2] = [16, 64];

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
    let [first, second] = PREDICTED;
    println!(
        "| mechanics | method | contacts | between iterations | one thread, ms | {threads} threads, ms | ratio | predicted on {first} | on {second} |"
    );
    println!("|---|---|--:|---|--:|--:|--:|--:|--:|");
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
    let cut = Partition::of_contacts(&frozen.problem, partition, subdomains)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut of_subdomains = vec![0; cut.count as usize];
    cut.subdomain.iter().for_each(|e| of_subdomains[*e as usize] += 1);
    let blocks = Layout::new(&frozen.problem).unwrap_or_else(|error| panic!("{error}")).contacts();
    for (name, solver) in methods {
        let parts = if name == "cg" { &blocks } else { &of_subdomains };
        for (between, measured) in [("nothing", false), ("measures", true)] {
            let mut times = [Vec::new(), Vec::new()];
            for _ in 0..ROUNDS {
                for (pool, times) in pools.iter().zip(&mut times) {
                    times.push(round(pool, frozen, solver, measured));
                }
            }
            let ratios = times[0].iter().zip(&times[1]).map(|(one, all)| one / all).collect();
            let [one, all] = times.map(|times| 1e3 * median(times));
            let (ratio, [first, second]) =
                (median(ratios), PREDICTED.map(|n| predicted(parts, [one, all], n)));
            println!(
                "| {mechanics} | {name} | {contacts} | {between} | {one:.3} | {all:.3} | {ratio:.2} | {first:.1} | {second:.1} |"
            );
        }
    }
}

/// Returns the predicted ratio on `threads`, from the times on one thread and on all.
fn predicted(parts: &[usize], [one, all]: [f64; 2], threads: usize) -> f64 {
    let measured = rayon::current_num_threads();
    let waits = (all - share(parts, measured) * one).max(0.0) / (measured as f64).log2().max(1.0);
    one / (share(parts, threads) * one + waits * (threads as f64).log2())
}

/// Returns the greatest share of the contacts that one of so many threads has.
fn share(parts: &[usize], threads: usize) -> f64 {
    let mut parts = parts.to_vec();
    parts.sort_unstable_by(|a, b| b.cmp(a));
    let mut of_threads = vec![0; threads];
    for part in &parts {
        if let Some(least) = of_threads.iter_mut().min() {
            *least += part;
        }
    }
    of_threads.iter().max().map_or(1.0, |most| *most as f64 / parts.iter().sum::<usize>().max(1) as f64)
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
