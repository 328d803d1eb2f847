//! Prediction of a rank for each subdomain: the work of the longest, counted and timed, and its messages, counted, at a cluster's
//! prices.

pub(super) mod measured;

use polars::df;
use serde_json::Value;

use super::declared::ON_RANKS;
use super::scaling::{fewest, path_per_iteration, same_problem};
use crate::draw::{Series, series, title};
use crate::read::{Ending, Problems, RunRow, file_name, problems};
use crate::text::{Part, chosen};

/// α: what a message takes whatever its length, and β: what each of its bytes takes (s); of an InfiniBand network of 100 Gbit/s.
const LATENCY_S: f64 = 1.5e-6;
const BYTE_S: f64 = 1.0 / 12e9;

const NOTE: &str = "\nPredicted, with a rank for each subdomain, of nsgs-dd with one exchange an iteration, latin-dd and cg: T = w + e (m α + β B) + k α ⌈log₂ p⌉ for an iteration. w: the \
                    seconds of the run with the fewest subdomains, on one thread, in proportion to the counted work of the longest subdomain; of cg, \
                    to their number. m and B: counted neighbours and bytes of the subdomain that has most; e: exchanges, of cg one for \
                    each product with W; k: sums over all ranks, of cg four, of coarse problems one. α = 1.5 µs and 1/β = 12 GB/s, \
                    those of a cluster. It knows nothing of ranks that share a memory's bandwidth, of caches, nor of those that \
                    are late.\n";

/// Predicted parts of an iteration: work, messages to neighbours, sums over all ranks (s).
struct Predicted {
    work: f64,
    messages: f64,
    sums: f64,
}

/// Exchanges with the neighbours in an iteration, and sums over all ranks, of the methods of which they are known.
fn exchanges_and_sums(run: &RunRow) -> Option<(f64, f64)> {
    let setting = |key: &str| run.settings.get(key);
    match run.method.as_str() {
        "cg" => Some((run.end.work.delassus_products as f64 / run.iterations as f64, 4.0)),
        "latin-dd" => {
            let is_coarse = setting("coarse").and_then(Value::as_bool) == Some(true);
            Some((1.0, f64::from(u8::from(is_coarse))))
        }
        // The other exchange takes one for each colour.
        "nsgs-dd" => {
            (setting("exchange").and_then(Value::as_str) != Some("gauss-seidel")).then_some((1.0, 0.0))
        }
        _ => None,
    }
}

impl Predicted {
    /// Returns the prediction for a run of a series, if its messages are counted, and the fewest subdomains were timed on one thread.
    fn of(series: &Series, run: &RunRow) -> Option<Self> {
        let fewest = fewest(series, run, same_problem).filter(|fewest| fewest.provenance.threads == 1)?;
        let seconds = fewest.seconds_per_iteration()?;
        let (exchanges, sums) = exchanges_and_sums(run)?;
        let share = match (path_per_iteration(run), path_per_iteration(fewest)) {
            (Some(own), Some(fewest)) => own / fewest,
            _ => f64::from(fewest.subdomains) / f64::from(run.subdomains),
        };
        let counted =
            |key: &str| if run.subdomains == 1 { Some(0.0) } else { run.spectrum.get(key)?.as_f64() };
        Some(Self {
            work: seconds * share,
            messages: exchanges * (counted("neighbours")? * LATENCY_S + counted("sent_bytes")? * BYTE_S),
            sums: sums * LATENCY_S * f64::from(run.subdomains).log2().ceil(),
        })
    }

    fn iteration_s(&self) -> f64 {
        self.work + self.messages + self.sums
    }
}

/// To the tolerance, of a run that met it.
pub(super) fn seconds(series: &Series, run: &RunRow) -> Option<f64> {
    let predicted = Predicted::of(series, run)?;
    run.has_converged().then(|| run.iterations as f64 * predicted.iteration_s())
}

/// Over the run with the fewest subdomains.
pub(super) fn speed_up(series: &Series, run: &RunRow) -> Option<f64> {
    Some(seconds(series, fewest(series, run, same_problem)?)? / seconds(series, run)?)
}

/// The runs that were made; those of cg, whose iterates do not depend on subdomains, on as many as others have too.
fn on_ranks(study: &Problems) -> Vec<RunRow> {
    let made = || study.runs.iter().filter(|run| run.ending != Ending::Skipped);
    let shared = made().filter(|run| run.method == "cg").flat_map(|run| {
        let mut seen = vec![run.subdomains];
        let others = made().filter(move |other| {
            let is_new = other.problem == run.problem
                && other.spectrum.contains_key("neighbours")
                && !seen.contains(&other.subdomains);
            if is_new {
                seen.push(other.subdomains);
            }
            is_new
        });
        others.map(|other| run.shared_as(other))
    });
    made().cloned().chain(shared).collect()
}

/// `ranks-<problem>` for each problem, and the table `ranks`; `ranks-measured` instead where ranks made runs.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    if measured::has_ranks(&study.runs) {
        return measured::parts(&study.runs);
    }
    let runs = on_ranks(study);
    let mut parts = Vec::new();
    for problem in problems(&runs) {
        let of_problem = runs.iter().filter(|run| run.problem == problem);
        let name = format!("ranks-{}", file_name(problem));
        let made: Vec<&RunRow> = study.runs.iter().filter(|run| run.problem == problem).collect();
        let all = series(of_problem, ON_RANKS.varied);
        parts.push(ON_RANKS.figure(name, &[title(problem, &made)], &all, &study.runs));
    }
    parts.push(table(&runs));
    parts
}

fn table(runs: &[RunRow]) -> Part {
    let all = series(runs, &["subdomains"]);
    let mut rows: Vec<(&Series, &RunRow)> =
        all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run))).collect();
    rows.sort_by_key(|(series, run)| (run.problem.clone(), series.label(), run.subdomains));
    let of = |value: &dyn Fn(&Series, &RunRow) -> Option<f64>| {
        rows.iter().map(|(series, run)| value(series, run)).collect::<Vec<_>>()
    };
    let part = |part: fn(&Predicted) -> f64| of(&|series, run| Some(part(&Predicted::of(series, run)?)));
    let counted = |key: &str| {
        let of_run = |run: &RunRow| run.spectrum.get(key)?.as_u64();
        rows.iter().map(|(_, run)| of_run(run)).collect::<Vec<_>>()
    };
    let own = df!(
        "method" => rows.iter().map(|(series, _)| series.label()).collect::<Vec<_>>(),
        "status" => rows.iter().map(|(_, run)| run.ending.text()).collect::<Vec<_>>(),
        "neighbours" => counted("neighbours"),
        "sent_bytes" => counted("sent_bytes"),
        "work_s" => part(|predicted| predicted.work),
        "messages_s" => part(|predicted| predicted.messages),
        "sums_s" => part(|predicted| predicted.sums),
        "predicted_s" => of(&seconds),
        "predicted_speed_up" => of(&speed_up),
    );
    let names = "problem method subdomains status iterations neighbours sent_bytes work_s messages_s sums_s \
                 predicted_s predicted_speed_up";
    Part::table("ranks", chosen(rows.iter().map(|(_, run)| *run), names, own), NOTE)
}

#[cfg(test)]
mod tests;
