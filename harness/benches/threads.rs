//! One thread against as many as there are: prints Markdown; `just threads` keeps it in `reports/out/threads.md`.
//!
//! Rounds on one thread and on all take turns, so that what else the machine does, and how fast it runs at the moment,
//! meets both alike.
//!
//! What n threads would do is predicted from counted work and barriers. An iteration takes
//!
//! T(n) = s(n) T(1) + k b log₂ n / log₂ n₀
//!
//! with s(n) the greatest share of the contacts that one of n threads has, where each takes the largest subdomain that is left; k the
//! parallel sections of an iteration, counted; and b the time of an empty one on the n₀ threads that there are. Work between sections
//! and memory that threads share are not in it: the prediction for n₀ stands beside the ratio that was measured.

mod common;

use analysis::Meter;
use cases::Frozen;
use cg::Cg;
use contact::acceleration::Acceleration;
use contact::{Discs, Mechanics, RoughDiscs, RoughSpheres, Solver, Spheres, threads};
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

/// Threads for which a ratio is predicted, after those that there are.
const PREDICTED: [usize; 2] = [16, 64];

/// The machine: a pool of one thread and one of all, and the time of an empty parallel section on all (ms).
struct Machine {
    pools: [ThreadPool; 2],
    barrier: f64,
}

fn main() {
    let all = rayon::current_num_threads();
    let pools = [1, all].map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap_or_else(|error| panic!("{error}"))
    });
    let barrier = 1e3 * pools[1].install(empty_section);
    let machine = Machine { pools, barrier };
    println!("# Iterations on one thread and on {all}\n");
    println!(
        "Medians of {ROUNDS} rounds of {ITERATIONS} iterations, in turns; {SIDE} × {SIDE} subdomains, those of cg are its own."
    );
    println!("In a run, measures come between two iterations: caches forget, threads fall asleep.");
    println!("An empty parallel section takes {:.1} µs.\n", 1e3 * barrier);
    let [first, second] = PREDICTED;
    println!(
        "| mechanics | method | contacts | between iterations | one thread, ms | {all} threads, ms | ratio | sections | predicted on {all} | on {first} | on {second} |"
    );
    println!("|---|---|--:|---|--:|--:|--:|--:|--:|--:|--:|");
    for grains in common::sizes() {
        table::<Discs>(&machine, "discs", &common::packing(grains));
        table::<RoughDiscs>(&machine, "discs with friction", &common::rough_packing(grains));
        table::<Spheres>(&machine, "spheres", &common::packing_in_space(grains, 0.0));
        table::<RoughSpheres>(&machine, "spheres with friction", &common::packing_in_space(grains, 0.3));
    }
}

/// Prints the rows of one packing.
fn table<M: Mechanics>(machine: &Machine, mechanics: &str, frozen: &Frozen<M>)
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
            let mut sections = 0;
            for _ in 0..ROUNDS {
                for (pool, times) in machine.pools.iter().zip(&mut times) {
                    let (seconds, counted) = round(pool, frozen, solver, measured);
                    times.push(seconds);
                    // The pool of all threads comes last.
                    sections = counted;
                }
            }
            let ratios = times[0].iter().zip(&times[1]).map(|(one, all)| one / all).collect();
            let [one, all] = times.map(|times| 1e3 * median(times));
            let predicted = |threads| {
                let steps = (threads as f64).log2() / (rayon::current_num_threads() as f64).log2().max(1.0);
                one / (share(parts, threads) * one + sections as f64 * machine.barrier * steps)
            };
            let ratio = median(ratios);
            let [here, first, second] =
                [rayon::current_num_threads(), PREDICTED[0], PREDICTED[1]].map(predicted);
            println!(
                "| {mechanics} | {name} | {contacts} | {between} | {one:.3} | {all:.3} | {ratio:.2} | {sections} | {here:.2} | {first:.1} | {second:.1} |"
            );
        }
    }
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

/// Returns the median time of an iteration (s), and the parallel sections of one.
fn round<M: Mechanics>(
    pool: &ThreadPool,
    frozen: &Frozen<M>,
    solver: &dyn Solver<M>,
    measured: bool,
) -> (f64, usize) {
    pool.install(|| {
        let problem = &frozen.problem;
        let mut r = frozen.start(false);
        let mut iteration = solver.start(problem, &r).unwrap_or_else(|error| panic!("{error}"));
        let mut meter = Meter::new(problem);
        (0..5).for_each(|_| iteration.advance());
        let mut sections = 0;
        let times = (0..ITERATIONS).map(|_| {
            let (clock, before) = (Instant::now(), threads::sections());
            iteration.advance();
            let seconds = clock.elapsed().as_secs_f64();
            sections += threads::sections() - before;
            if measured {
                iteration.impulses(&mut r);
                meter.measure_after(&[], &r, iteration.velocity_jump());
            }
            seconds
        });
        (median(times.collect()), sections / ITERATIONS)
    })
}

/// Returns the median time of a parallel section without work (s).
fn empty_section() -> f64 {
    let mut items = [(); (SIDE * SIDE) as usize];
    let section = |_| {
        let clock = Instant::now();
        threads::each(&mut items, usize::MAX, &|_, ()| ());
        clock.elapsed().as_secs_f64()
    };
    median((0..1000).map(section).collect())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
