//! Answers of simulations, medians over packings: properties of the packing, of what it does, and the cost.

use polars::df;
use polars::prelude::DataFrame;
use results::Median;
use results::settings::FRICTION;
use results::simulation::{Observed, SimulationEnding};
use serde_json::Value;

use super::macroscopic::panel;
use crate::draw::{Look, Plot, SPARE, Scale, Side, log};
use crate::read::{Simulation, rising, unique};
use crate::text::{Part, frame};

/// A simulation that came to its end, by what it is a sample of.
struct Ended<'s> {
    simulation: &'s Simulation,
    /// Name of the case, with the settings in which its simulations differ beside friction and seed, and the method where there are several.
    case: String,
    /// μ of the grains, where the study sets it (–).
    grains: Option<f64>,
}

/// A quantity of a simulation.
struct Answer {
    name: &'static str,
    /// Title of its panel; those without one are in the table alone.
    title: Option<&'static str>,
    /// `None` where it is not defined.
    of: fn(&Simulation) -> Option<f64>,
}

const ANSWERS: [Answer; 17] = [
    Answer {
        name: "height_mean_diameters",
        title: Some("mean height (mean diameters)"),
        of: |s| Some(last(s)?.mean_height_m / s.mean_diameter_m),
    },
    Answer {
        name: "side_walls_share",
        title: Some("impulses, side walls / floor (–)"),
        of: |s| {
            let sum = |of: fn(&Observed) -> f64| late(s).iter().map(of).sum::<f64>();
            let sides = sum(|row| row.left_impulse_n_s) + sum(|row| row.right_impulse_n_s);
            let floor = sum(|row| row.floor_impulse_n_s);
            (floor > 0.0).then_some(sides / floor)
        },
    },
    Answer {
        name: "contacts_per_grain",
        title: Some("contacts per grain (–)"),
        of: |s| Some(f64::from(last(s)?.contacts) / f64::from(s.grains)),
    },
    Answer {
        name: "iterations_per_time_step",
        title: Some("iterations per time step"),
        of: |s| Some(s.totals.iterations as f64 / s.totals.time_steps as f64),
    },
    Answer {
        name: "nanoseconds_per_visit",
        title: Some("time per contact visited (ns)"),
        of: |s| finite(1e9 * s.totals.iterating_s / s.totals.work.contact_updates as f64),
    },
    Answer {
        name: "microseconds_per_grain",
        title: Some("time per step and grain (µs)"),
        of: |s| {
            let seconds = s.totals.setup_s + s.totals.iterating_s;
            Some(1e6 * seconds / s.totals.time_steps as f64 / f64::from(s.grains))
                .filter(|time| !time.is_nan())
        },
    },
    Answer {
        name: "floor_share",
        title: None,
        of: |s| {
            let impulse: f64 = late(s).iter().map(|row| row.floor_impulse_n_s).sum();
            finite(impulse / (s.mass_kg * s.gravity_m_per_s2 * (last(s)?.time_s - before_late(s)?.time_s)))
        },
    },
    Answer {
        name: "shear_over_normal",
        title: None,
        of: |s| mean(s, |row| row.stress.ratio().unwrap_or(f64::NAN)),
    },
    Answer { name: "bulk_solid_fraction", title: None, of: |s| mean(s, |row| row.bulk.solid_fraction) },
    Answer { name: "bulk_coordination", title: None, of: |s| mean(s, |row| row.bulk.coordination) },
    Answer { name: "weak_contacts", title: None, of: |s| mean(s, |row| row.shape.weak_contacts) },
    Answer {
        name: "bed_angle_degrees",
        title: None,
        of: |s| mean(s, |row| row.shape.bed_angle.to_degrees()),
    },
    Answer {
        name: "aspect",
        title: None,
        of: |s| s.series().first().and_then(|row| finite(2.0 * row.mean_height_m / row.shape.width)),
    },
    Answer {
        name: "run_out",
        title: None,
        of: |s| finite(last(s)?.shape.width / s.series().first()?.shape.width - 1.0),
    },
    Answer { name: "passed_share", title: None, of: |s| finite(last(s)?.shape.passed_mass / s.mass_kg) },
    Answer { name: "discharge_kg_per_s", title: None, of: discharge },
    Answer {
        name: "walls_power_w",
        title: None,
        of: |s| {
            let work: f64 = late(s).iter().map(|row| row.energy.walls).sum();
            finite(work / (last(s)?.time_s - before_late(s)?.time_s))
        },
    },
];

/// Shares of the mass between which a silo's rate is taken: after its beginning and before its end.
const FLOWING: [f64; 2] = [0.1, 0.4];

fn last(simulation: &Simulation) -> Option<&Observed> {
    simulation.series().last()
}

/// The second half of a series.
fn late(simulation: &Simulation) -> &[Observed] {
    let series = simulation.series();
    &series[series.len() / 2..]
}

/// Returns a value where it is finite.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The last row before the second half.
fn before_late(simulation: &Simulation) -> Option<&Observed> {
    let series = simulation.series();
    (series.len() / 2).checked_sub(1).map(|row| &series[row])
}

/// The mean of a quantity over the second half, where every row has it.
fn mean(simulation: &Simulation, of: fn(&Observed) -> f64) -> Option<f64> {
    let late = late(simulation);
    finite(late.iter().map(of).sum::<f64>() / late.len() as f64)
}

/// Returns the rate at which mass passes below all segments, while [`FLOWING`] of it does (kg/s).
fn discharge(simulation: &Simulation) -> Option<f64> {
    let at = |share: f64| {
        simulation.series().iter().find(|row| row.shape.passed_mass >= share * simulation.mass_kg)
    };
    let [begin, end] = FLOWING.map(at);
    let (begin, end) = (begin?, end?);
    finite((end.shape.passed_mass - begin.shape.passed_mass) / (end.time_s - begin.time_s))
}

/// The settings of a simulation, beside friction and seed, that are not the same in all of its case, as they are read.
fn set_apart(simulation: &Simulation, all: &[Simulation]) -> Vec<String> {
    let same_case = || all.iter().filter(|other| other.is_run() && other.case() == simulation.case());
    let differs =
        |key: &str, value: &Value| same_case().any(|other| other.scene_settings.get(key) != Some(value));
    let set = simulation.scene_settings.iter();
    let set =
        set.filter(|(key, value)| ![FRICTION, "sample.seed"].contains(&key.as_str()) && differs(key, value));
    set.map(|(key, value)| format!("{} = {value}", key.rsplit('.').next().unwrap_or(key))).collect()
}

fn ended(all: &[Simulation]) -> Vec<Ended<'_>> {
    let runs = || all.iter().filter(|simulation| simulation.is_run());
    let several = unique(runs().map(Simulation::label)).len() > 1;
    let ended = |simulation| {
        let case = std::iter::once(Simulation::case(simulation).to_owned());
        let case = case.chain(set_apart(simulation, all)).chain(several.then(|| simulation.label()));
        let case = case.collect::<Vec<_>>().join(", ");
        Ended { simulation, case, grains: simulation.friction() }
    };
    runs().filter(|simulation| simulation.status == SimulationEnding::Completed).map(ended).collect()
}

/// The figure and the table `answers`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let ended = ended(all);
    let note = "\nMedians over packings, with intervals that hold them with a probability of 90 % or more, of fewer than five the least and the \
                greatest; of simulations that came to their end, of which some time step missed the tolerance in as many as `missed` says. \
                The mean height and the contacts are those at the end; the walls' impulses, the floor's share of the weight, stresses, the \
                bulk, weak contacts, the angle of a bed and the power of walls those of the second half of the time; aspect: twice the mean height over the width, of \
                the first row; run-out: growth of the width since then, over it; discharge: while 10 to 40 % of the mass passes. Time: set-up and iterations.\n";
    let mut parts = Vec::new();
    if ended.iter().any(|one| one.grains.is_some()) {
        parts.push(Part::figure("answers", figure(&ended)));
    }
    parts.push(Part::table("answers", table(&ended), note));
    parts
}

/// The median of an answer in a case with a friction.
fn median(ended: &[Ended], (case, grains): (&str, Option<f64>), answer: &Answer) -> Option<Median> {
    let own = ended.iter().filter(|one| one.case == case && one.grains == grains);
    Median::of(own.filter_map(|one| (answer.of)(one.simulation)).collect())
}

/// A panel for each answer, against the friction of the grains; of the simulations whose study sets that.
fn figure(ended: &[Ended]) -> String {
    let cases = unique(ended.iter().map(|one| one.case.as_str()));
    let frictions = rising(ended.iter().filter_map(|one| one.grains));
    let look = |(n, case): (usize, &&str)| ((*case).to_owned(), SPARE[(3 + n) % SPARE.len()].dashed(0));
    let looks: Vec<(String, Look)> = cases.iter().enumerate().map(look).collect();
    let panels = ANSWERS.iter().filter_map(|answer| Some((answer, answer.title?))).map(|(answer, title)| {
        let places = |case: &str| {
            let at = |grains: &f64| {
                let Median { low, median, high } = median(ended, (case, Some(*grains)), answer)?;
                Some((*grains, [low, median, high].map(log)))
            };
            frictions.iter().filter_map(at).collect()
        };
        let x = Side::new(Scale::Share, "friction μ of the grains (–)").holding(frictions.clone());
        panel(&looks, &places, &frictions, [x, Side::new(Scale::Ten, title)])
    });
    let title = vec!["What friction and the third dimension change, and what they cost: medians over packings, with intervals.".to_owned()];
    Plot { title, panels: panels.collect(), ..Plot::default() }.svg()
}

fn table(ended: &[Ended]) -> DataFrame {
    let mut rows = Vec::new();
    for case in unique(ended.iter().map(|one| one.case.as_str())) {
        let of_case = || ended.iter().filter(|one| one.case == case);
        let set = rising(of_case().filter_map(|one| one.grains)).into_iter().map(Some);
        let unset = of_case().any(|one| one.grains.is_none()).then_some(None);
        for grains in set.chain(unset) {
            let own = || ended.iter().filter(|one| one.case == case && one.grains == grains);
            let missed = own().filter(|one| one.simulation.totals.missed_time_steps > 0).count();
            rows.extend(ANSWERS.iter().filter_map(|answer| {
                let median = median(ended, (case, grains), answer);
                // A scene without a drum has no row for its angle.
                let is_told = answer.title.is_some() || median.is_some();
                is_told.then(|| Row {
                    case,
                    grains,
                    packings: own().count(),
                    missed,
                    answer: answer.name,
                    median,
                })
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
    grains: Option<f64>,
    packings: usize,
    /// Number of packings of which a time step missed the tolerance.
    missed: usize,
    answer: &'static str,
    median: Option<Median>,
}

#[cfg(test)]
mod tests;
