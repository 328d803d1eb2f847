//! Quantities of a run by name: what the axes of declared charts and the columns of their tables hold.

use polars::prelude::{Column, DataFrame};
use thiserror::Error;

use super::predicted::predicted;
use crate::draw::{Scale, Series};
use crate::read::{RunRow, ending_text};
use crate::text::chosen;

/// Value of a run, beside the others of its series.
type Number = fn(&Series, &RunRow) -> Option<f64>;

/// A named quantity.
#[derive(Clone, Copy)]
pub(super) struct Quantity {
    /// Name in declarations and of its column.
    pub(super) name: &'static str,
    /// Name of an axis; `{threads}` and `{grains}` stand for those of the runs.
    pub(super) title: &'static str,
    pub(super) of: Number,
    pub(super) scale: Scale,
    /// True if it was reached however the run ended.
    pub(super) on_the_way: bool,
    /// True where a column holds counts.
    whole: bool,
}

const fn quantity(name: &'static str, title: &'static str, of: Number) -> Quantity {
    Quantity { name, title, of, scale: Scale::Ten, on_the_way: false, whole: false }
}

impl Quantity {
    const fn octaves(self) -> Self {
        Self { scale: Scale::Two, ..self }
    }

    const fn on_the_way(self) -> Self {
        Self { on_the_way: true, ..self }
    }

    const fn whole(self) -> Self {
        Self { whole: true, ..self }
    }
}

/// All that a chart may be declared by.
const QUANTITIES: &[Quantity] = &[
    quantity("subdomains", "subdomains", |_, run| Some(run.subdomains.into())).octaves().whole(),
    quantity("grains", "grains", |_, run| Some(run.grains.into())).whole(),
    quantity("contacts", "contacts", |_, run| Some(run.contacts.into())).whole(),
    quantity("ranks", "ranks", |_, run| Some(run.exchange.ranks.into())).octaves().whole(),
    quantity("dimensions", "dimensions", |_, run| spectral(run, "dimensions")).whole(),
    quantity("iterations", "iterations to the tolerance", |_, run| Some(run.iterations as f64)).whole(),
    quantity("to_natural_map_1e_2", "iterations to a natural map of 10⁻²", |_, run| {
        run.iterations_to_natural_map_1e_2.map(|iterations| iterations as f64)
    })
    .on_the_way()
    .whole(),
    quantity("to_zeta_1e_3", "iterations to ζ = 10⁻³", |_, run| {
        run.iterations_to_zeta_1e_3.map(|iterations| iterations as f64)
    })
    .on_the_way()
    .whole(),
    quantity("to_natural_map_1e_4", "iterations to a natural map of 10⁻⁴", |_, run| {
        run.iterations_to_natural_map_1e_4.map(|iterations| iterations as f64)
    })
    .on_the_way()
    .whole(),
    // Of NSGS l⁺ = 1/W_αα.
    quantity("kappa_l", "κ_l, search direction at contacts over 1/W_αα (–)", |_, run| {
        run.settings.get("kappa_l").map_or(Some(1.0), serde_json::Value::as_f64)
    }),
    quantity("growth", "iterations over those with the fewest subdomains (–)", |series, run| {
        series.growth(run)
    }),
    quantity("seconds", "set-up and iterations (s)", |_, run| run.seconds()),
    quantity("seconds_per_iteration", "seconds per iteration (s)", |_, run| run.seconds_per_iteration()),
    quantity("time", "time per iteration and grain (ns)", |_, run| {
        Some(1e9 * run.seconds_per_iteration()? / f64::from(run.grains))
    })
    .on_the_way(),
    quantity("ns_per_contact", "time per iteration and contact (ns)", |_, run| {
        let visits = f64::from(run.contacts) * run.iterations as f64;
        Some(1e9 * run.iterating_s? / visits).filter(|ns| ns.is_finite())
    }),
    quantity("work", "counted work (sweeps)", |_, run| run.work(run.curve.last()?)),
    quantity("entries_per_grain", "entries of factors per grain", |_, run| {
        let solves = run.solves_with_factors()?;
        let entries = run.end.work.triangular_solve_entries as f64 / 2.0;
        (solves > 0).then(|| entries / solves as f64 / f64::from(run.grains))
    }),
    quantity("boundary_share", "grains on boundaries (–)", |_, run| spectral(run, "boundary_share"))
        .on_the_way(),
    quantity("neighbours", "neighbours", |_, run| spectral(run, "neighbours")).on_the_way().whole(),
    quantity("sent_bytes", "bytes sent", |_, run| spectral(run, "sent_bytes")).on_the_way().whole(),
    quantity("grains_per_subdomain", "grains per subdomain", |_, run| {
        Some(f64::from(run.grains) / f64::from(run.subdomains))
    }),
    quantity("path_per_iteration", "longest subdomain of an iteration (multiply-adds)", |_, run| {
        run.path_per_iteration()
    }),
    quantity("longest_subdomain", "multiply-adds on the longest subdomain, all iterations", |_, run| {
        path(run)
    }),
    quantity("counted_speed_up", "counted speed-up, a machine per subdomain (–)", |series, run| {
        Some(path(series.fewest_converged(run)?)? / path(run)?)
    }),
    quantity("measured_speed_up", "measured speed-up of the iterations, {threads} (–)", |series, run| {
        Some(series.fewest_converged(run)?.iterating_s? / run.iterating_s?)
    }),
    quantity("work_s", "predicted work of an iteration (s)", |series, run| {
        Some(predicted(series, run)?.work)
    }),
    quantity("messages_s", "predicted messages of an iteration (s)", |series, run| {
        Some(predicted(series, run)?.messages)
    }),
    quantity("sums_s", "predicted sums of an iteration (s)", |series, run| {
        Some(predicted(series, run)?.sums)
    }),
    quantity("iteration_s", "predicted seconds of an iteration (s)", |series, run| {
        Some(predicted(series, run)?.iteration_s())
    }),
    quantity("predicted_s", "predicted seconds to the tolerance (s)", predicted_s),
    quantity("predicted_speed_up", "predicted speed-up (–)", |series, run| {
        Some(predicted_s(series, series.fewest(run)?)? / predicted_s(series, run)?)
    }),
    quantity("measured_over_predicted", "measured / predicted, {grains} (–)", |series, run| {
        Some(run.seconds_per_iteration()? / predicted(series, run)?.iteration_s())
    })
    .on_the_way(),
];

/// A name that no quantity has.
#[derive(Debug, Error)]
#[error("no quantity `{0}`: there are {names}", names = names())]
pub struct UnknownQuantity(pub(super) String);

fn names() -> String {
    QUANTITIES.iter().map(|quantity| quantity.name).collect::<Vec<_>>().join(", ")
}

/// The quantity of a name.
pub(super) fn named(name: &str) -> Option<&'static Quantity> {
    QUANTITIES.iter().find(|quantity| quantity.name == name)
}

fn spectral(run: &RunRow, key: &str) -> Option<f64> {
    run.spectrum.get(key)?.as_f64()
}

/// Multiply-adds of the longest subdomain in all iterations.
fn path(run: &RunRow) -> Option<f64> {
    Some(run.iterations as f64 * run.path_per_iteration()?)
}

fn predicted_s(series: &Series, run: &RunRow) -> Option<f64> {
    let predicted = predicted(series, run)?;
    run.has_converged().then(|| run.iterations as f64 * predicted.iteration_s())
}

/// One row per run, with the columns `names`: quantities, one of them perhaps by another name as `name=quantity`, or as they are
/// stored.
pub(super) fn table(all: &[Series], names: &'static str) -> DataFrame {
    let rows: Vec<(&Series, &RunRow)> =
        all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run))).collect();
    let split = |column: &'static str| column.split_once('=').unwrap_or((column, column));
    let column = |(title, name): (&'static str, &str)| {
        let values = |of: Number| rows.iter().map(move |(series, run)| of(series, run));
        let title = title.into();
        Some(match (name, named(name)) {
            ("method", _) => Column::new(title, rows.iter().map(|(s, _)| s.label()).collect::<Vec<_>>()),
            ("status", _) => {
                Column::new(title, rows.iter().map(|(_, r)| ending_text(r.status)).collect::<Vec<_>>())
            }
            (_, Some(Quantity { of, whole: true, .. })) => {
                Column::new(title, values(*of).map(|value| Some(value? as u64)).collect::<Vec<_>>())
            }
            (_, Some(Quantity { of, .. })) => Column::new(title, values(*of).collect::<Vec<_>>()),
            (_, None) => return None,
        })
    };
    let columns = || names.split_whitespace().map(split);
    let own = DataFrame::new(rows.len(), columns().filter_map(column).collect());
    let titles: Vec<&str> = columns().map(|(title, _)| title).collect();
    chosen(rows.iter().map(|(_, run)| *run), &titles.join(" "), own)
}
