//! The declared charts: a new one is one more declaration here, and its line in `CHARTS`.

use super::lines::{Each, Ideal, Lines, Panel, Through, X};
use super::ranks::{measured, seconds, speed_up};
use super::scaling::{counted_speed_up, measured_speed_up, path};
use crate::draw::Scale;
use crate::read::Ending;

const SUBDOMAINS: X = X { title: "subdomains", scale: Scale::Two, of: |run| run.subdomains };
const GRAINS: X = X { title: "grains", scale: Scale::Ten, of: |run| run.grains };
const RANKS: X = X { title: "ranks", scale: Scale::Two, of: |run| run.exchange.ranks };

/// Iterations of runs that converged; of others those that they made.
const ITERATIONS: Panel =
    Panel::new("iterations", "iterations to the tolerance", |_, run| Some(run.iterations as f64));
const ITERATIONS_TO_1E_2: Panel =
    Panel::new("to_natural_map_1e_2", "iterations to a natural map of 10⁻²", |_, run| {
        run.iterations_to_natural_map_1e_2.map(|iterations| iterations as f64)
    })
    .on_the_way();
const AS_MANY: Ideal = Ideal::X("ideal: as many times faster as there are subdomains");

pub(super) const OF_SUBDOMAINS: Lines = Lines {
    name: "subdomains",
    x: SUBDOMAINS,
    panels: &[
        ITERATIONS,
        Panel::new("seconds_per_iteration", "seconds per iteration (s)", |_, run| {
            run.seconds_per_iteration()
        }),
    ],
    varied: &["subdomains"],
    each: Each::Problem,
    through: Through::Points,
    of: |_| true,
    notes: &[],
    columns: "problem method subdomains status iterations growth seconds_per_iteration setup_s seconds",
    note: "\nGrowth: iterations over those of the same method and settings with the fewest subdomains.\n",
};

pub(super) const CRITICAL_PATH: Lines = Lines {
    name: "critical-path",
    x: SUBDOMAINS,
    panels: &[
        Panel::new("counted", "counted speed-up, a machine per subdomain (–)", counted_speed_up)
            .ideal(AS_MANY),
        Panel::new("measured", "measured speed-up of the iterations, {threads} (–)", measured_speed_up)
            .ideal(AS_MANY),
    ],
    varied: &["subdomains"],
    each: Each::Problem,
    through: Through::Points,
    of: |run| run.ending != Ending::Skipped && path(run).is_some(),
    notes: &[
        ("Counted: multiply-adds of the longest subdomain, no communication cost.", |_| true),
        ("Above the ideal: fewer iterations, or factors with fewer entries per contact.", |all| {
            all.iter().any(|series| {
                let times = |run| counted_speed_up(series, run).unwrap_or_default();
                series.runs.iter().any(|run| times(run) > f64::from(run.subdomains))
            })
        }),
    ],
    columns: "problem method contacts subdomains status iterations path_per_iteration counted_speed_up \
              measured_speed_up ns_per_contact",
    note: "\nThe critical path of an iteration is the multiply-adds of the longest subdomain, exchange with its \
           neighbours included; messages between machines cost nothing in it. A speed-up is over the run of the same \
           method and settings on the same problem with the fewest subdomains, both to the same tolerance. It passes \
           the ideal where the factors of smaller subdomains have fewer entries per contact, or iterations are fewer.\n",
};

pub(super) const WEAK: Lines = Lines {
    name: "weak",
    x: SUBDOMAINS,
    panels: &[
        ITERATIONS_TO_1E_2,
        ITERATIONS,
        Panel::new("longest_subdomain", "longest subdomain (multiply-adds)", |_, run| path(run)),
        Panel::new("time", "time per iteration and grain (ns)", |_, run| {
            Some(1e9 * run.seconds_per_iteration()? / f64::from(run.grains))
        })
        .on_the_way(),
    ],
    each: Each::Study,
    notes: &[],
    columns: "method grains_per_subdomain subdomains grains status to_natural_map_1e_2 iterations growth \
              longest_subdomain seconds_per_iteration",
    note: "\nThe longest subdomain: its multiply-adds in all iterations, exchange with its neighbours included; with a \
           machine per subdomain the time to the tolerance goes with it, and constant is ideal. Growth: iterations over \
           those with the fewest subdomains, as many grains in each.\n",
    ..CRITICAL_PATH
};

pub(super) const SIZE: Lines = Lines {
    name: "size",
    x: GRAINS,
    panels: &[
        ITERATIONS_TO_1E_2,
        ITERATIONS,
        Panel::new("seconds", "set-up and iterations (s)", |_, run| run.seconds()),
        Panel::new("work", "counted work (sweeps)", |_, run| run.curve.last()?.work(run)),
    ],
    varied: &[],
    each: Each::Study,
    through: Through::Fit,
    of: |_| true,
    notes: &[],
    columns: "",
    note: "\nCost = a · grains^exponent, least squares in logarithms over the runs that converged, or reached 10⁻² on their \
           way; none on fewer than 3 sizes. {WORK}\n",
};

/// With a rank for each subdomain, from counts.
pub(super) const ON_RANKS: Lines = Lines {
    name: "ranks",
    panels: &[
        ITERATIONS,
        Panel::new("predicted", "predicted seconds to the tolerance (s)", seconds),
        Panel::new("speed_up", "predicted speed-up (–)", speed_up).ideal(AS_MANY),
    ],
    notes: &[("Predicted for a rank per subdomain, messages of 1.5 µs and 12 GB/s.", |_| true)],
    ..OF_SUBDOMAINS
};

/// Seconds of runs on ranks over their prediction.
pub(super) const MEASURED_ON_RANKS: Lines = Lines {
    name: "ranks",
    x: RANKS,
    panels: &[Panel::new("measured", "measured / predicted, {grains} (–)", measured::ratio)
        .on_the_way()
        .ideal(Ideal::One("as predicted; of one rank by definition"))],
    varied: &["ranks"],
    each: Each::PanelOfProblem,
    notes: &[("More ranks than processors take longer.", |_| true)],
    ..OF_SUBDOMAINS
};
