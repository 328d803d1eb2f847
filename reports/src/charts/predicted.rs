//! Predicted seconds of an iteration on ranks: of a rank for each subdomain from counts, and of runs on ranks from one on a rank alone.

use crate::draw::Series;
use crate::read::RunRow;

/// α: what a message takes whatever its length, and β: what each of its bytes takes (s); of an InfiniBand network of 100 Gbit/s.
const LATENCY_S: f64 = 1.5e-6;
const BYTE_S: f64 = 1.0 / 12e9;

/// Predicted parts of an iteration: work, messages to neighbours, sums over all ranks (s).
pub(super) struct Predicted {
    pub(super) work: f64,
    pub(super) messages: f64,
    pub(super) sums: f64,
}

impl Predicted {
    pub(super) fn iteration_s(&self) -> f64 {
        self.work + self.messages + self.sums
    }
}

/// Returns the prediction for a run of a series, with a rank for each subdomain if no run of the series was shared by ranks.
pub(super) fn predicted(series: &Series, run: &RunRow) -> Option<Predicted> {
    if has_ranks(series.runs.iter().copied()) { on_ranks(series, run) } else { of_subdomains(series, run) }
}

/// Returns the prediction from counts, if messages are counted, and the fewest subdomains were timed on one thread.
fn of_subdomains(series: &Series, run: &RunRow) -> Option<Predicted> {
    let fewest = series.fewest(run).filter(|fewest| fewest.provenance.threads == 1)?;
    let seconds = fewest.seconds_per_iteration()?;
    let (exchanges, sums) = run.exchanges_and_sums()?;
    let share = match (run.path_per_iteration(), fewest.path_per_iteration()) {
        (Some(own), Some(fewest)) => own / fewest,
        _ => f64::from(fewest.subdomains) / f64::from(run.subdomains),
    };
    let counted = |key: &str| if run.subdomains == 1 { Some(0.0) } else { run.spectrum.get(key)?.as_f64() };
    Some(Predicted {
        work: seconds * share,
        messages: exchanges * (counted("neighbours")? * LATENCY_S + counted("sent_bytes")? * BYTE_S),
        sums: sums * LATENCY_S * f64::from(run.subdomains).log2().ceil(),
    })
}

/// Returns the prediction for a run on ranks: the seconds of one rank of the same machine and build shared by all, and messages
/// at the prices of the machine.
fn on_ranks(series: &Series, run: &RunRow) -> Option<Predicted> {
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
    Some(Predicted { work: alone / ranks, messages, sums: 0.0 })
        .filter(|predicted| predicted.messages.is_finite())
}

/// Reports whether some runs were shared by ranks.
pub(super) fn has_ranks<'r>(runs: impl IntoIterator<Item = &'r RunRow>) -> bool {
    runs.into_iter().any(|run| run.exchange.ranks > 1)
}
