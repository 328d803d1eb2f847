//! The roofline: what an iteration moves at a contact, how fast the machine's memory and the kernel alone would let it, and what stands
//! between. Prints Markdown; `just roofline` keeps it in `reports/out/roofline.md`.

mod common;

use cases::Frozen;
use cg::Cg;
use contact::acceleration::Acceleration;
use contact::visit::Row;
use contact::{Discs, Mechanics, RoughDiscs, RoughSpheres, Solver, Spheres};
use nsgs::Nsgs;
use std::hint::black_box;
use std::time::Instant;

/// Bytes of an iteration, read or written once whatever the caches keep.
struct Moves {
    /// At a contact.
    contact: usize,
    /// At a grain, over all passes.
    grain: usize,
}

/// Returns the bytes of a sweep: a row and s of each contact, y of each grain; accelerated, x of both as well. What is changed is read and written.
fn of_sweep<M: Mechanics>(acceleration: Acceleration) -> Moves {
    let lists = if acceleration == Acceleration::None { 1 } else { 2 };
    Moves {
        contact: size_of::<Row<M::Column>>() + lists * 2 * size_of::<M::Impulse>(),
        grain: lists * 2 * size_of::<M::Velocity>(),
    }
}

/// Returns those of conjugate gradients without friction: two passes, each of which reads the columns, and reads and writes the states of
/// five numbers. A grain's y is cleared, pushed, and squared with its weight; then it is read, and that of what the maximum adds is
/// cleared. What the maximum adds, and the product of every 16th iteration, are left out.
fn of_cg<M: Mechanics>() -> Moves {
    Moves {
        contact: 2 * (size_of::<M::Column>() + 2 * 5 * size_of::<M::Impulse>()),
        grain: 6 * size_of::<M::Velocity>() + size_of::<f64>(),
    }
}

/// Returns the least time of one call, of as many as fit into about a second (s).
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

/// Prints the rows of one mechanics, whose `packing` has so many grains.
fn rows<M: Mechanics>(
    mechanics: &str,
    packing: impl Fn(usize) -> Frozen<M>,
    methods: &[(&str, Box<dyn Solver<M>>, Moves)],
) {
    // Seconds at a contact of the smallest packing, which the nearest caches hold: what the kernel itself takes.
    let mut alone = vec![None; methods.len()];
    for grains in common::sizes() {
        let Frozen { problem, .. } = packing(grains);
        let contacts = problem.contact_count();
        let r0 = vec![0.0; problem.impulse_count()];
        for ((name, solver, moves), alone) in methods.iter().zip(&mut alone) {
            let bytes =
                (moves.contact * contacts + moves.grain * problem.grain_count()) as f64 / contacts as f64;
            let mut iteration = solver.start(&problem, &r0).unwrap_or_else(|error| panic!("{error}"));
            (0..3).for_each(|_| iteration.advance());
            let seconds = least_seconds(|| iteration.advance()) / contacts as f64;
            drop(iteration);
            let kernel = *alone.get_or_insert(seconds);
            // What fits beside it in memory is as large as what the method moves.
            let bandwidth = triad((bytes * contacts as f64) as usize);
            let memory = bytes / bandwidth;
            println!(
                "| {mechanics} | {name} | {contacts} | {bytes:.0} | {:.1} | {:.1} | {:.1} | {:.1} | {:.2} |",
                1e-9 * bandwidth,
                1e9 * memory,
                1e9 * kernel,
                1e9 * seconds,
                seconds / memory.max(kernel),
            );
        }
    }
}

/// Returns plain and accelerated sweeps.
fn sweeps<M: Mechanics>() -> Vec<(&'static str, Box<dyn Solver<M>>, Moves)>
where
    Nsgs: Solver<M>,
{
    [("nsgs", Acceleration::None), ("nsgs, accelerated", Acceleration::Nesterov)]
        .into_iter()
        .map(|(name, acceleration)| {
            let solver: Box<dyn Solver<M>> = Box::new(Nsgs { acceleration, ..Nsgs::default() });
            (name, solver, of_sweep::<M>(acceleration))
        })
        .collect()
}

/// Returns sweeps and conjugate gradients.
fn smooth<M: Mechanics>() -> Vec<(&'static str, Box<dyn Solver<M>>, Moves)>
where
    Nsgs: Solver<M>,
    Cg: Solver<M>,
{
    let mut methods = sweeps::<M>();
    methods.push(("cg", Box::new(Cg::default()), of_cg::<M>()));
    methods
}

fn main() {
    println!("# What an iteration moves, and how fast\n");
    println!(
        "Least of many iterations, {} thread(s). Memory's limit is the bytes over the",
        rayon::current_num_threads()
    );
    println!(
        "bandwidth of the triad a = b + 3 c on as many bytes, so on the same level of caches. The kernel's limit"
    );
    println!(
        "is the time at a contact of the smallest packing, which the nearest caches hold. The last column is the"
    );
    println!(
        "time over the larger of the two: what is above 1 neither limit explains, such as the scatter of grains in memory.\n"
    );
    println!(
        "| mechanics | method | contacts | bytes per contact | triad, GB/s | memory's limit, ns | kernel's limit, ns | ns per contact | over the larger |"
    );
    println!("|---|---|--:|--:|--:|--:|--:|--:|--:|");
    rows::<Discs>("discs", common::packing, &smooth());
    rows::<RoughDiscs>("discs with friction", common::rough_packing, &sweeps());
    rows::<Spheres>("spheres", |grains| common::packing_in_space(grains, 0.0), &smooth());
    rows::<RoughSpheres>("spheres with friction", |grains| common::packing_in_space(grains, 0.3), &sweeps());
}
