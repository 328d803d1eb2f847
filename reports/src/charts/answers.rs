//! Cost of each mechanics and what it changes: medians over packings of the ends of simulations and of their times.

use polars::df;
use polars::prelude::DataFrame;
use results::Median;
use results::simulation::{Observed, SimulationEnding};

use super::macroscopic::panel;
use crate::draw::{Look, Plot, SPARE, Scale, Side, log};
use crate::read::{Simulation, rising, unique};
use crate::text::{Part, frame};

/// A simulation that came to its end, by what it is a sample of.
struct Ended<'s> {
    simulation: &'s Simulation,
    /// Name of the case, and the method where there are several.
    case: String,
    /// μ of the grains (–).
    grains: f64,
}

/// A quantity of a simulation.
struct Answer {
    name: &'static str,
    title: &'static str,
    /// `None` where it is not defined.
    of: fn(&Simulation) -> Option<f64>,
}

const ANSWERS: [Answer; 6] = [
    Answer {
        name: "height_mean_diameters",
        title: "mean height (mean diameters)",
        of: |s| Some(last(s)?.mean_height_m / s.mean_diameter_m),
    },
    Answer {
        name: "side_walls_share",
        title: "impulses, side walls / floor (–)",
        of: |s| {
            let sum = |of: fn(&Observed) -> f64| late(s).iter().map(of).sum::<f64>();
            let sides = sum(|row| row.left_impulse_n_s) + sum(|row| row.right_impulse_n_s);
            let floor = sum(|row| row.floor_impulse_n_s);
            (floor > 0.0).then_some(sides / floor)
        },
    },
    Answer {
        name: "contacts_per_grain",
        title: "contacts per grain (–)",
        of: |s| Some(f64::from(last(s)?.contacts) / f64::from(s.grains)),
    },
    Answer {
        name: "iterations_per_time_step",
        title: "iterations per time step",
        of: |s| Some(s.totals.iterations as f64 / s.totals.time_steps as f64),
    },
    Answer {
        name: "nanoseconds_per_visit",
        title: "time per contact visited (ns)",
        of: |s| {
            Some(1e9 * s.totals.iterating_s / s.totals.work.contact_updates as f64)
                .filter(|time| time.is_finite())
        },
    },
    Answer {
        name: "microseconds_per_grain",
        title: "time per step and grain (µs)",
        of: |s| {
            let seconds = s.totals.setup_s + s.totals.iterating_s;
            Some(1e6 * seconds / s.totals.time_steps as f64 / f64::from(s.grains))
                .filter(|time| !time.is_nan())
        },
    },
];

fn last(simulation: &Simulation) -> Option<&Observed> {
    simulation.series().last()
}

/// The second half of a series.
fn late(simulation: &Simulation) -> &[Observed] {
    let series = simulation.series();
    &series[series.len() / 2..]
}

fn ended(all: &[Simulation]) -> Vec<Ended<'_>> {
    let runs = || all.iter().filter(|simulation| simulation.is_run());
    let several = unique(runs().map(Simulation::label)).len() > 1;
    let ended = |simulation| {
        let case = Simulation::case(simulation);
        let case = if several { format!("{case}, {}", simulation.label()) } else { case.to_owned() };
        Ended { simulation, case, grains: simulation.friction().unwrap_or(0.0) }
    };
    runs().filter(|simulation| simulation.status == SimulationEnding::Completed).map(ended).collect()
}

/// The figure and the table `answers`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let ended = ended(all);
    let note = "\nMedians over packings, with intervals that hold them with a probability of 90 % or more, of fewer than five the least and the \
                greatest; of simulations that came to their end, of which some time step missed the tolerance in as many as `missed` says. \
                The mean height and the contacts are those at the end; the walls' impulses those of the second half of the time. Time: \
                set-up and iterations.\n";
    let mut parts = Vec::new();
    if !ended.is_empty() {
        parts.push(Part::figure("answers", figure(&ended)));
    }
    parts.push(Part::table("answers", table(&ended), note));
    parts
}

/// The median of an answer in a case with a friction.
fn median(ended: &[Ended], (case, grains): (&str, f64), answer: &Answer) -> Option<Median> {
    let own = ended.iter().filter(|one| one.case == case && one.grains == grains);
    Median::of(own.filter_map(|one| (answer.of)(one.simulation)).collect())
}

/// A panel for each answer, against the friction of the grains.
fn figure(ended: &[Ended]) -> String {
    let cases = unique(ended.iter().map(|one| one.case.as_str()));
    let frictions = rising(ended.iter().map(|one| one.grains));
    let look = |(n, case): (usize, &&str)| ((*case).to_owned(), SPARE[(3 + n) % SPARE.len()].dashed(0));
    let looks: Vec<(String, Look)> = cases.iter().enumerate().map(look).collect();
    let panels = ANSWERS.iter().map(|answer| {
        let places = |case: &str| {
            let at = |grains: &f64| {
                let Median { low, median, high } = median(ended, (case, *grains), answer)?;
                Some((*grains, [low, median, high].map(log)))
            };
            frictions.iter().filter_map(at).collect()
        };
        let x = Side::new(Scale::Share, "friction μ of the grains (–)").holding(frictions.clone());
        panel(&looks, &places, &frictions, [x, Side::new(Scale::Ten, answer.title)])
    });
    let title = vec!["What friction and the third dimension change, and what they cost: medians over packings, with intervals.".to_owned()];
    Plot { title, panels: panels.collect(), ..Plot::default() }.svg()
}

fn table(ended: &[Ended]) -> DataFrame {
    let mut rows = Vec::new();
    for case in unique(ended.iter().map(|one| one.case.as_str())) {
        for grains in rising(ended.iter().filter(|one| one.case == case).map(|one| one.grains)) {
            let own = || ended.iter().filter(|one| one.case == case && one.grains == grains);
            let missed = own().filter(|one| one.simulation.totals.missed_time_steps > 0).count();
            rows.extend(ANSWERS.iter().map(|answer| Row {
                case,
                grains,
                packings: own().count(),
                missed,
                answer: answer.name,
                median: median(ended, (case, grains), answer),
            }));
        }
    }
    let of = |of: fn(&Median) -> f64| rows.iter().map(|row| row.median.as_ref().map(of)).collect::<Vec<_>>();
    frame(df!(
        "case" => rows.iter().map(|row| row.case).collect::<Vec<_>>(),
        "friction_of_grains" => rows.iter().map(|row| row.grains).collect::<Vec<_>>(),
        "packings" => rows.iter().map(|row| row.packings as u64).collect::<Vec<_>>(),
        "missed" => rows.iter().map(|row| row.missed as u64).collect::<Vec<_>>(),
        "answer" => rows.iter().map(|row| row.answer).collect::<Vec<_>>(),
        "median" => of(|of| of.median),
        "low" => of(|of| of.low),
        "high" => of(|of| of.high),
    ))
}

/// A row of the table.
struct Row<'e> {
    case: &'e str,
    grains: f64,
    packings: usize,
    /// Number of packings of which a time step missed the tolerance.
    missed: usize,
    answer: &'static str,
    median: Option<Median>,
}

#[cfg(test)]
mod tests;
