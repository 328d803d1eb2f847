//! Cost of each mechanics and what it changes: medians over packings of the ends of simulations and of their times.

use polars::df;
use polars::prelude::DataFrame;
use results::Median;
use results::simulation::{Observed, SimulationEnding};

use super::macroscopic::{FRICTION, panel};
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

const ANSWERS: [Answer; 5] = [
    Answer {
        name: "height_mean_diameters",
        title: "mean height (mean diameters)",
        of: |s| Some(last(s)?.mean_height_m / s.mean_diameter_m),
    },
    Answer {
        name: "side_walls_share",
        title: "side walls over floor (–)",
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
        title: "iterations of a step",
        of: |s| Some(s.totals.iterations as f64 / s.totals.time_steps as f64),
    },
    Answer {
        name: "microseconds_per_grain",
        title: "time of a step, a grain (µs)",
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
    let of = |simulation: &'_ Simulation| {
        // A scene has the name of its case, and what is replaced in it.
        let case = simulation.scene.split(' ').next().unwrap_or_default();
        let case = if several { format!("{case}, {}", simulation.label()) } else { case.to_owned() };
        (case, simulation.scene_settings.get(FRICTION).and_then(serde_json::Value::as_f64).unwrap_or(0.0))
    };
    let completed = runs().filter(|simulation| simulation.status == SimulationEnding::Completed);
    completed
        .map(|simulation| (of(simulation), simulation))
        .map(|((case, grains), simulation)| Ended { simulation, case, grains })
        .collect()
}

/// The figure and the table `answers`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let ended = ended(all);
    let note = "\nMedians over packings, with intervals that hold them with a probability of 90 % or more, of fewer than five the least and the \
                greatest; of simulations that came to their end. The mean height and the contacts are those at the end; the walls' impulses those of the second half of the time. Time: set-up and iterations.\n";
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
            let packings = ended.iter().filter(|one| one.case == case && one.grains == grains).count();
            rows.extend(
                ANSWERS.iter().map(|answer| {
                    (case, grains, packings, answer.name, median(ended, (case, grains), answer))
                }),
            );
        }
    }
    let of = |of: fn(&Median) -> f64| rows.iter().map(|row| row.4.as_ref().map(of)).collect::<Vec<_>>();
    frame(df!(
        "case" => rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        "friction_of_grains" => rows.iter().map(|row| row.1).collect::<Vec<_>>(),
        "packings" => rows.iter().map(|row| row.2 as u64).collect::<Vec<_>>(),
        "answer" => rows.iter().map(|row| row.3).collect::<Vec<_>>(),
        "median" => of(|of| of.median),
        "low" => of(|of| of.low),
        "high" => of(|of| of.high),
    ))
}

#[cfg(test)]
mod tests;
