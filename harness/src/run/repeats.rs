//! A run, repeated for its seconds.

use crate::plan::MOST_REPEATS;
use crate::run::Ended;
use anyhow::{Context, Result, bail};
use contact::Work;
use results::Median;
use results::journal::Record;
use results::schema::{Run, Sample, Snapshot, Timing};
use runner::Status;
use std::time::{Duration, Instant};

/// The curve of a run, and the iterates that the page shows, if any.
pub(crate) type Kept = (Vec<Sample>, Vec<Snapshot>);

/// Outcome of a run and its repeats.
pub(crate) enum Made {
    /// The user asked for an end.
    Halted,
    /// The method cannot start, for this reason.
    Refused(String),
    /// The repeat with the median time, and what all took.
    Ended(Box<Ended>, Kept, Timing),
}

/// The row of a run that is not made, with its reason.
pub(crate) fn refused(row: Run, reason: &str) -> Record {
    let run = Run { reason: reason.to_owned(), ..row };
    Record { run, curve: Vec::new(), snapshots: Vec::new() }
}

/// Time that the method takes in all repeats of a run, over their number as the plan has it, at least (s): clocks and caches make
/// seconds of less uncertain.
const SURE: f64 = 1e-3;

/// Makes the run `name` as often as `timing` says, by calls of `once`, and more often where it is short; a method of ours must count
/// the same each time.
pub(crate) fn repeated(
    name: &str,
    ours: bool,
    timing: &Timing,
    once: impl Fn() -> Result<(Ended, Kept)>,
) -> Result<Made> {
    let clock = Instant::now();
    let mut all = Vec::new();
    // The first of several brings code and data into the caches.
    let mut warm_ups = usize::from(timing.repeats > 1);
    let asked = timing.repeats as usize;
    // Time that the repeats still have to take (s).
    let mut left = if ours && asked > 1 { SURE * asked as f64 } else { 0.0 };
    while all.len() < asked || left > 0.0 && all.len() < MOST_REPEATS.get() as usize {
        let one = match once() {
            Err(reason) => return Ok(Made::Refused(format!("{reason:#}"))),
            Ok((ended, _)) if ended.outcome.status == Status::Interrupted => return Ok(Made::Halted),
            Ok(one) => one,
        };
        // Another code that gave no answer would give none again.
        let has_failed = one.0.failed.is_some();
        if warm_ups > 0 && !has_failed {
            warm_ups -= 1;
            continue;
        }
        left -= (one.0.outcome.setup + one.0.outcome.iterating).as_secs_f64();
        all.push(one);
        if has_failed {
            break;
        }
    }
    // Another code need not count the same twice.
    if ours && all.windows(2).any(|pair| counts(&pair[0].0) != counts(&pair[1].0)) {
        bail!("{name}: it counts other work when it is repeated; a run must not");
    }
    let (ended, kept, timing) = median(all, timing).context("a run is made at least once")?;
    Ok(Made::Ended(Box::new(ended), kept, Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing }))
}

/// Returns the counts, which are the same in every repeat.
fn counts(Ended { outcome, .. }: &Ended) -> (Status, u64, Work) {
    (outcome.status, outcome.iterations, outcome.work)
}

/// The repeat with the median time in `advance`, with the median times in `start` and of each sample, and the widths of the intervals
/// of both; `None` of none.
fn median(mut all: Vec<(Ended, Kept)>, timing: &Timing) -> Option<(Ended, Kept, Timing)> {
    let mut setup: Vec<_> = all.iter().map(|(ended, _)| ended.outcome.setup).collect();
    setup.sort_unstable();
    all.sort_by_key(|(ended, _)| ended.outcome.iterating);
    let (repeats, middle) = (u32::try_from(all.len()).ok()?, all.len().checked_sub(1)? / 2);
    let spread =
        |times: Vec<f64>| Median::of(times).filter(|_| repeats > 1).map_or(f64::NAN, |of| of.high - of.low);
    let timing = Timing {
        repeats,
        setup_spread_s: spread(setup.iter().map(Duration::as_secs_f64).collect()),
        iterating_spread_s: spread(
            all.iter().map(|(ended, _)| ended.outcome.iterating.as_secs_f64()).collect(),
        ),
        ..timing.clone()
    };
    let curves: Vec<_> = all.iter().map(|(_, (curve, _))| &curve[..]).collect();
    let times = median_times(&curves);
    let (mut ended, mut kept) = all.swap_remove(middle);
    ended.outcome.setup = setup[middle];
    kept.0.iter_mut().zip(times).for_each(|(sample, time)| sample.iterating_s = time);
    Some((ended, kept, timing))
}

/// Returns the median time of each sample (s): a pause of one repeat is no plateau of the curve. None where curves have different
/// samples, as those of another code may.
pub(super) fn median_times(curves: &[&[Sample]]) -> Vec<f64> {
    let iterations = |curve: &[Sample]| curve.iter().map(|sample| sample.iteration).collect::<Vec<_>>();
    if curves.windows(2).any(|pair| iterations(pair[0]) != iterations(pair[1])) {
        return Vec::new();
    }
    let median = |k: usize| {
        let mut times: Vec<_> = curves.iter().map(|curve| curve[k].iterating_s).collect();
        times.sort_by(f64::total_cmp);
        times[(times.len() - 1) / 2]
    };
    (0..curves[0].len()).map(median).collect()
}
