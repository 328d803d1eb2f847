//! `gravel-mpi ping`: α and β of a machine, a message of n bytes taking α + β n, by messages that go to and fro.

use crate::team::share::Posted;
use crate::terminal::say;
use anyhow::{Result, bail};
use partition::Parcel;
use serde_json::json;
use std::process::ExitCode;
use std::time::Instant;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Numbers in the short messages, and in the long ones.
const SHORT: usize = 1;
const LONG: usize = 1 << 17;
/// Messages to and fro, and how often they are timed: the least counts, since others only add to it.
const TIMES: [(usize, u32); 2] = [(SHORT, 2000), (LONG, 50)];
const REPEATS: u32 = 9;

pub(crate) fn run(posted: &Posted, args: &Args) -> Result<ExitCode> {
    if posted.size() < 2 {
        bail!("a message needs two ranks: mpirun -n 2");
    }
    let (latency_s, seconds_per_byte) = prices(posted);
    let told = if posted.rank() > 0 {
        Ok(())
    } else if args.json {
        say(format_args!("{}", json!({ "latency_s": latency_s, "seconds_per_byte": seconds_per_byte })))
    } else {
        let rate = 1e-9 / seconds_per_byte;
        say(format_args!("a message takes {:.2} µs, and its bytes go at {rate:.2} GB/s", 1e6 * latency_s))
    };
    posted.agree(told)?;
    Ok(ExitCode::SUCCESS)
}

/// α (s) and β (s/B), as rank 0 measures them; undefined of one rank.
pub(crate) fn prices(posted: &Posted) -> (f64, f64) {
    if posted.size() < 2 {
        return (f64::NAN, f64::NAN);
    }
    let [short, long] = TIMES.map(|(numbers, times)| {
        (0..REPEATS).map(|_| one_way_s(posted, numbers, times)).fold(f64::INFINITY, f64::min)
    });
    // α + β n of both lengths.
    let seconds_per_byte = (long - short) / (8 * (LONG - SHORT)) as f64;
    (short - seconds_per_byte * (8 * SHORT) as f64, seconds_per_byte)
}

/// Measures the time of a message of so many numbers between ranks 0 and 1 (s).
fn one_way_s(posted: &Posted, numbers: usize, times: u32) -> f64 {
    let (rank, post) = (posted.rank(), &posted.0);
    let parcel = |rank| [Parcel { rank, numbers: vec![1.0; numbers] }];
    let clock = Instant::now();
    match rank {
        0 => {
            let (sent, mut received) = (parcel(1), parcel(1));
            for _ in 0..times {
                post.swap(&sent, &mut []);
                post.swap(&[], &mut received);
            }
        }
        1 => {
            let (sent, mut received) = (parcel(0), parcel(0));
            for _ in 0..times {
                post.swap(&[], &mut received);
                post.swap(&sent, &mut []);
            }
        }
        _ => {}
    }
    clock.elapsed().as_secs_f64() / f64::from(2 * times)
}
