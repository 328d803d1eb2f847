//! Tables of the site: all runs, all simulations, the collection, hazards, pairs of methods.

use contact::Measure;
use polars::df;
use polars::prelude::{Column, DataFrame, IdxCa};
use results::name::Name;

use super::{Collected, Facts, Hazard};
use crate::charts::profiles::Pair;
use crate::error::ReportError;
use crate::read::{COSTS, RunRow, Simulation, number, unique};
use crate::text::{chosen, frame};

/// Writes μ as a text, by which rows are chosen.
pub(super) fn friction(mu: Option<f64>) -> String {
    mu.map_or_else(|| "–".to_owned(), |mu| mu.to_string())
}

pub(super) fn start(run: &RunRow) -> &'static str {
    if run.warm_start { "time step before" } else { "r = 0" }
}

/// Returns some rows of a table.
pub(super) fn some(table: &DataFrame, rows: &[usize]) -> Result<DataFrame, ReportError> {
    let rows = rows.iter().map(|row| *row as u32).collect();
    Ok(table.take(&IdxCa::from_vec("rows".into(), rows))?)
}

/// Returns a value of each row, for a column.
fn each<'r, R, V>(rows: &'r [R], of: impl FnMut(&'r R) -> V) -> Vec<V> {
    rows.iter().map(of).collect()
}

/// Makes the table of all runs on problems: study, run and facts of its problem.
pub(super) fn runs(runs: &[(&str, &RunRow, &Facts)]) -> DataFrame {
    let to = |accuracy: f64| each(runs, |(_, run, _)| COSTS[0].to(run, Measure::NaturalMap, accuracy));
    let own = df!(
        "study" => each(runs, |(study, ..)| *study),
        "settings" => each(runs, |(_, run, _)| run.set.as_str()),
        "mechanics" => each(runs, |(.., facts)| facts.mechanics.as_str()),
        "grains" => each(runs, |(_, run, _)| run.grains_asked()),
        "μ" => each(runs, |(.., facts)| friction(Some(facts.friction))),
        "state" => each(runs, |(.., facts)| facts.state.as_str()),
        "start" => each(runs, |(_, run, _)| start(run)),
        "natural_map_1e_2_s" => to(1e-2),
        "natural_map_1e_4_s" => to(1e-4),
        "natural_map_1e_6_s" => to(1e-6),
        "natural_map_1e_8_s" => to(1e-8),
        "least_natural_map" => each(runs, |(_, run, _)| run.least().map(|(least, _)| least)),
    );
    let names = "method settings status iterations natural_map_1e_2_s natural_map_1e_4_s natural_map_1e_6_s \
                 natural_map_1e_8_s least_natural_map mechanics grains μ state start problem study id";
    chosen(runs.iter().map(|(_, run, _)| *run), names, own)
}

/// Makes the table of all simulations: study, simulation and facts of its scene.
pub(super) fn simulations(all: &[(&str, &Simulation, &Facts)]) -> DataFrame {
    let own = df!(
        "study" => each(all, |(study, ..)| *study),
        "mechanics" => each(all, |(.., facts)| facts.mechanics.as_str()),
        "μ" => each(all, |(.., facts)| friction(Some(facts.friction))),
        "tolerance" => each(all, |(_, one, _)| number(one.tolerance, 2)),
        "budget" => each(all, |(_, one, _)| one.max_iterations),
    );
    let names = "study scene mechanics grains μ method variant tolerance budget status time_steps \
                 missed_time_steps iterations id";
    chosen(all.iter().map(|(_, one, _)| *one), names, own)
}

/// Makes the table of the collection.
pub(super) fn collection(problems: &[Collected]) -> DataFrame {
    let text = |key: &str| each(problems, |problem| problem.text(key).to_owned());
    let whole = |key: &str| each(problems, |problem| problem.entry[key].as_u64());
    let known = |key: &str| each(problems, |problem| problem.entry["known"][key].as_f64());
    frame(df!(
        "name" => text("name"),
        "mechanics" => text("mechanics"),
        "grains" => whole("grains"),
        "contacts" => whole("contacts"),
        "μ" => each(problems, |problem| friction(problem.entry["friction"][1].as_f64())),
        "state" => text("state"),
        "status" => each(problems, |problem| problem.status().to_owned()),
        "natural_map" => known("natural_map"),
        "solutions" => each(problems, |problem| problem.entry["known"]["solutions"].as_u64()),
        "spread" => known("spread"),
        "best_by" => text("by"),
        "id" => text("id"),
    ))
}

/// Makes a table of runs on hazards.
pub(super) fn hazards(all: &[&Hazard]) -> DataFrame {
    frame(df!(
        "problem" => each(all, |hazard| hazard.problem.as_str()),
        "method" => each(all, |hazard| hazard.method.as_str()),
        "settings" => each(all, |hazard| hazard.settings.as_str()),
        "status" => each(all, |hazard| hazard.status.as_str()),
        "iterations" => each(all, |hazard| hazard.iterations),
        "why" => each(all, |hazard| hazard.why.as_str()),
    ))
}

/// Counts the endings of each method on hazards.
pub(super) fn stability(methods: &[String], hazards: &[Hazard]) -> Result<DataFrame, ReportError> {
    let count = |of: &dyn Fn(&str, &Hazard) -> bool| {
        each(methods, |method| hazards.iter().filter(|hazard| of(method, hazard)).count() as u64)
    };
    let mut table = frame(df!(
        "method" => methods,
        "runs" => count(&|method, hazard| hazard.method == method),
    ));
    for status in unique(hazards.iter().map(|hazard| hazard.status.as_str())) {
        let ended = count(&|method, hazard| hazard.method == method && hazard.status == status);
        table.with_column(Column::new(status.replace('-', " ").into(), ended))?;
    }
    Ok(table)
}

/// Makes a table with a row and a column for each method: on which share of the problems that either solves the one of the row wins,
/// and on which no difference shows.
pub(super) fn matrix(pairs: &[Pair]) -> Result<DataFrame, ReportError> {
    let methods = unique(pairs.iter().map(|pair| pair.method.as_str()));
    let share = |method: &str, against: &str| {
        let pair = pairs.iter().find(|pair| pair.method == method && pair.against == against);
        let counts = pair.map_or([0; 3], |pair| pair.counts);
        let all = counts.iter().sum::<u64>();
        let [wins, ties, _] = counts.map(|count| (100.0 * count as f64 / all as f64).round());
        if all == 0 { "–".to_owned() } else { format!("{wins}\u{a0}+\u{a0}{ties} of {all}") }
    };
    let mut table = frame(df!("wins_+_ties_%_of_problems" => &methods));
    for against in &methods {
        let cells = each(&methods, |method| share(method, against));
        table.with_column(Column::new(format!("over {against}").into(), cells))?;
    }
    Ok(table)
}

/// Makes the table of the runs of a method that failed, of so many: by study, law and ending.
pub(super) fn failures(failed: &[(&str, &str, String, u64, u64)]) -> DataFrame {
    frame(df!(
        "study" => each(failed, |row| row.0),
        "problems" => each(failed, |row| row.1),
        "ending" => each(failed, |row| row.2.as_str()),
        "runs" => each(failed, |row| row.3),
        "of" => each(failed, |row| row.4),
    ))
}

/// Reports whether an ending on a hazard is convergence.
pub(super) fn converged(hazard: &Hazard) -> bool {
    hazard.status == results::schema::Ending::Converged.name()
}
