//! Starts of time steps: iterations and seconds over those of a start from nothing.

#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    At, Curve, Guide, Look, MARKS, Panel, Plot, Scale, Side, Sign, TOLERANCE, Through, log, looks_in_time,
};
use crate::read::Simulation;
use crate::text::{Part, chosen};

const KEY: &str = "next-step";

/// Cost by which starts are compared.
type Cost = fn(&Simulation) -> f64;
const COSTS: [(&str, Cost); 2] = [
    ("iterations", |s| s.totals.iterations as f64 / s.totals.time_steps.max(1) as f64),
    ("seconds", |s| s.seconds_per_second().unwrap_or(f64::NAN)),
];

const MEANING: &str = "\nStarts: nothing, the previous impulses r⁻, or 2 r⁻ − r⁻⁻ extrapolated from the last two time steps, \
                       contact by contact and clipped into its cone. Seconds are those in the method alone. Over nothing: over \
                       those of the same started from nothing, where both met the tolerance in every time step.\n";

/// The simulation that differs from `one` in its start alone.
fn started<'s>(all: &'s [Simulation], one: &Simulation, start: &str) -> Option<&'s Simulation> {
    let is_like = |other: &&Simulation| {
        (&other.scene, other.time_step_s, other.tolerance, other.label())
            == (&one.scene, one.time_step_s, one.tolerance, one.label())
    };
    all.iter().filter(|other| other.is_run() && other.start == start).find(is_like)
}

/// The cost of a simulation over that of the same started from nothing, if both were solved.
fn over_nothing(all: &[Simulation], one: &Simulation, cost: Cost) -> Option<f64> {
    let nothing = started(all, one, "nothing").filter(|nothing| nothing.is_solved() && one.is_solved())?;
    let ratio = cost(one) / cost(nothing);
    (ratio.is_finite() && ratio > 0.0).then_some(ratio)
}

/// The figure and the table `next-step`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let figure =
        all.iter().any(|s| s.is_run() && s.start == "extrapolated").then(|| Part::figure(KEY, figure(all)));
    figure.into_iter().chain([Part::table(KEY, table(all), MEANING)]).collect()
}

fn table(all: &[Simulation]) -> DataFrame {
    let runs: Vec<&Simulation> = all.iter().filter(|s| s.is_run()).collect();
    let of = |cost: Cost| runs.iter().map(|s| cost(s)).collect::<Vec<_>>();
    let over = |cost: Cost| runs.iter().map(|s| over_nothing(all, s, cost)).collect::<Vec<_>>();
    let own = df!(
        "method" => runs.iter().map(|s| s.label()).collect::<Vec<_>>(),
        "iterations_per_time_step" => of(COSTS[0].1),
        "seconds_per_second" => of(COSTS[1].1),
        "iterations_over_nothing" => over(COSTS[0].1),
        "seconds_over_nothing" => over(COSTS[1].1),
    );
    let names = "scene time_step_s tolerance method start status time_steps missed_time_steps iterations \
                 iterations_per_time_step seconds_per_second iterations_over_nothing seconds_over_nothing";
    chosen(runs, names, own)
}

/// A panel for each cost: that from previous impulses to the right, that from extrapolated ones upwards.
fn figure(all: &[Simulation]) -> String {
    let extrapolated = || all.iter().filter(|s| s.is_run() && s.start == "extrapolated");
    let point = |one: &Simulation, cost: Cost| {
        let previous = over_nothing(all, started(all, one, "previous")?, cost)?;
        Some((log(previous), log(over_nothing(all, one, cost)?)))
    };
    let (looks, key) = (looks_in_time(all), "the same; below it extrapolated impulses cost less");
    let panel = |(name, cost): &(&str, Cost)| {
        let curves = looks.iter().zip(MARKS.into_iter().cycle()).map(|((label, look), mark)| {
            let points = extrapolated().filter(|s| s.label() == *label).filter_map(|s| point(s, *cost));
            Curve::of(label.clone(), Look { mark, ..*look }, points, Through::Nothing)
        });
        let side = |start: &str| Side::new(Scale::Ten, format!("{name} from {start} impulses (–)"));
        let guide = Guide::new(At::Diagonal, TOLERANCE, key);
        Panel::new(side("previous"), side("extrapolated"), curves.collect()).guided([guide])
    };
    let left_out = extrapolated().filter(|one| point(one, COSTS[0].1).is_none()).count();
    let text = format!(
        "Not drawn, since they missed their tolerance in a time step or have nothing to be compared with: {left_out}."
    );
    let signs = if left_out > 0 { vec![(Sign::Word, text)] } else { Vec::new() };
    let title =
        "Cost of the time steps, started from earlier impulses, over that of the same started from nothing";
    let panels = COSTS.iter().map(panel).collect();
    Plot { title: vec![title.to_owned()], panels, signs, ..Plot::default() }.svg()
}
