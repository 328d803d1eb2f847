//! Seconds of ranks beside their prediction: one rank's seconds shared by all, and messages at the prices of the machine.

use polars::df;

use crate::charts::declared::MEASURED_ON_RANKS;
use crate::draw::{Series, series};
use crate::read::{Ending, RunRow};
use crate::text::{Part, chosen};

const NOTE: &str = "\nPredicted of an iteration on p ranks: T = w/p + m α + β B. w: the seconds of one rank; m and B: messages and bytes of a rank, \
     those of sums over all ranks included, counted; α and β: what `gravel-mpi ping` measures before the runs. It knows nothing of \
     ranks that share a memory's bandwidth or a processor, of caches, nor of those that are late.\n";

/// Seconds of an iteration: of the own share of work, and of messages.
struct Predicted {
    work: f64,
    messages: f64,
}

impl Predicted {
    /// Returns the prediction for a run of a series whose run on one rank of the same machine and build is there.
    fn of(series: &Series, run: &RunRow) -> Option<Self> {
        let is_alone = |other: &&&RunRow| {
            other.problem == run.problem
                && other.exchange.ranks == 1
                && other.provenance.comparable(&run.provenance)
        };
        let alone = series.runs.iter().find(is_alone)?.seconds_per_iteration()?;
        let exchange = &run.exchange;
        let ranks = f64::from(exchange.ranks);
        let of_rank = |count: u64| count as f64 / (ranks * run.iterations as f64);
        let messages = if exchange.ranks == 1 {
            0.0
        } else {
            of_rank(exchange.messages) * exchange.latency_s
                + of_rank(exchange.message_bytes) * exchange.seconds_per_byte
        };
        Some(Self { work: alone / ranks, messages }).filter(|predicted| predicted.messages.is_finite())
    }
}

/// Measured over predicted (–).
pub(in crate::charts) fn ratio(series: &Series, run: &RunRow) -> Option<f64> {
    let Predicted { work, messages } = Predicted::of(series, run)?;
    Some(run.seconds_per_iteration()? / (work + messages))
}

/// Reports whether some runs were shared by ranks.
pub(super) fn has_ranks(runs: &[RunRow]) -> bool {
    runs.iter().any(|run| run.exchange.ranks > 1)
}

/// The figure `ranks-measured`, and the table `ranks`.
pub(super) fn parts(runs: &[RunRow]) -> Vec<Part> {
    let all = series(runs.iter().filter(|run| run.ending != Ending::Skipped), MEASURED_ON_RANKS.varied);
    let title = "Seconds of an iteration on ranks: measured over predicted, T = w/p + m α + β B.".to_owned();
    vec![MEASURED_ON_RANKS.figure("ranks-measured".to_owned(), &[title], &all, runs), table(&all)]
}

fn table(all: &[Series]) -> Part {
    let mut rows: Vec<(&Series, &RunRow)> =
        all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run))).collect();
    rows.sort_by_key(|(series, run)| (run.grains, run.problem.clone(), series.label(), run.exchange.ranks));
    let of = |value: &dyn Fn(&Series, &RunRow) -> Option<f64>| {
        rows.iter().map(|(series, run)| value(series, run)).collect::<Vec<_>>()
    };
    let part = |part: fn(&Predicted) -> f64| of(&|series, run| Some(part(&Predicted::of(series, run)?)));
    let ranks = rows.iter().map(|(_, run)| run.exchange.ranks).collect::<Vec<_>>();
    let own = df!(
        "method" => rows.iter().map(|(series, _)| series.label()).collect::<Vec<_>>(),
        "ranks" => ranks,
        "seconds_per_iteration" => of(&|_, run| run.seconds_per_iteration()),
        "work_s" => part(|predicted| predicted.work),
        "messages_s" => part(|predicted| predicted.messages),
        "predicted_s" => part(|predicted| predicted.work + predicted.messages),
        "measured_over_predicted" => of(&ratio),
    );
    let names = "problem method ranks iterations seconds_per_iteration work_s messages_s predicted_s \
                 measured_over_predicted";
    Part::table("ranks", chosen(rows.iter().map(|(_, run)| *run), names, own), NOTE)
}
