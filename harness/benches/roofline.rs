//! The roofline note: what a contact update moves and computes, what the machine's memory gives, and the share of it that
//! each method reaches. Prints Markdown; `just roofline` keeps it in `reports/out/roofline.md`.

mod common;

use cg::{Cg, Preconditioner};
use contact::{Packing, Solver};
use nsgs::{Nsgs, Order};
use nsgs_dd::NsgsDd;
use partition::Grid;
use std::hint::black_box;
use std::time::Instant;

/// What an iteration costs at one contact, counted in its loops.
struct Cost {
    /// Read or written once per iteration, whatever the caches keep: columns, vectors; grains are apart (bytes).
    bytes: f64,
    /// Bytes of a grain, read or written once per pass over contacts or grains.
    grain_bytes: f64,
    /// Additions, multiplications, maxima.
    flops: f64,
    /// Those at a grain.
    grain_flops: f64,
}

/// A column of 32 bytes, an offset of 8, s read and written; v takes 9 flops with its offset, the change 2, the push 8, s 1.
const SWEEP: Cost = Cost { bytes: 32.0 + 8.0 + 16.0, grain_bytes: 32.0, flops: 20.0, grain_flops: 0.0 };

/// Two passes over a column of 32 bytes; what the maximum adds, and the product of every 16th iteration, are left out. Beside it,
/// they read p, read and write r and u (40); read r and u, read and write p (32). The product with a column takes 7 flops, a push
/// 8; the sums and the vectors take 7 and 4 more. A grain's y is squared with its weight (24 bytes, 5 flops), read (16), cleared
/// (16) and pushed (32).
const CG: Cost = Cost { bytes: 2.0 * 32.0 + 40.0 + 32.0, grain_bytes: 88.0, flops: 26.0, grain_flops: 5.0 };

/// The least time of one call, of as many as fit into about a second (s).
fn least_seconds(mut call: impl FnMut()) -> f64 {
    let clock = Instant::now();
    let mut least = f64::INFINITY;
    while clock.elapsed().as_secs_f64() < 1.0 {
        let clock = Instant::now();
        call();
        least = least.min(clock.elapsed().as_secs_f64());
    }
    least
}

/// a = b + 3 c over arrays of `bytes` in all (bytes/s).
fn triad(bytes: usize) -> f64 {
    let n = bytes / 24;
    let (mut a, b, c) = (vec![0.0; n], vec![1.0; n], vec![2.0; n]);
    let seconds = least_seconds(|| {
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + 3.0 * c;
        }
        black_box(&mut a);
    });
    24.0 * n as f64 / seconds
}

fn row(name: &str, solver: &dyn Solver, cost: &Cost, problem: &Packing) {
    let contacts = problem.contact_count() as f64;
    let grains_per_contact = problem.grain_count() as f64 / contacts;
    let bytes = cost.bytes + cost.grain_bytes * grains_per_contact;
    let flops = cost.flops + cost.grain_flops * grains_per_contact;
    let r0 = vec![0.0; problem.contact_count()];
    let mut iteration = solver.start(problem, &r0).unwrap_or_else(|error| panic!("{error}"));
    (0..3).for_each(|_| iteration.advance());
    let seconds = least_seconds(|| iteration.advance()) / contacts;
    // What fits beside it in memory is as large as what the method moves.
    let bandwidth = triad((bytes * contacts) as usize);
    println!(
        "| {name} | {} | {:.2} | {bytes:.0} | {:.0} | {:.2} | {:.1} | {:.1} | {:.0} |",
        problem.contact_count(),
        1e9 * seconds,
        flops,
        1e-9 * flops / seconds,
        1e-9 * bytes / seconds,
        1e-9 * bandwidth,
        100.0 * bytes / seconds / bandwidth,
    );
}

fn main() {
    println!("# What an iteration moves, and how fast\n");
    println!(
        "Least of many iterations, {} thread(s). The triad a = b + 3 c runs on as many bytes as an",
        rayon::current_num_threads()
    );
    println!("iteration moves, so on the same level of caches; on one thread.\n");
    println!(
        "| method | contacts | ns per contact | bytes per contact | flops per contact | Gflop/s | GB/s | triad, GB/s | of it, % |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    for grains in common::sizes() {
        let problem = common::packing(grains).problem;
        let side = (problem.contact_count() / 1000).max(1).isqrt() as u32;
        let small = NsgsDd { subdomains: Grid::of(side, side), ..NsgsDd::default() };
        row("nsgs, natural order", &Nsgs::default(), &SWEEP, &problem);
        row("nsgs, coloured", &Nsgs { order: Order::Coloured, ..Nsgs::default() }, &SWEEP, &problem);
        row("nsgs-dd, small subdomains", &small, &SWEEP, &problem);
        row("cg", &Cg { preconditioner: Preconditioner::None }, &CG, &problem);
    }
}
