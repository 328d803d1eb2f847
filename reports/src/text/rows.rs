//! The table of all runs, or of all simulations, with a row for each in the order of the study.

use polars::df;
use polars::prelude::{DataFrame, PolarsResult};
use results::simulation::SimulationTables;
use results::store::Tables;

use crate::error::ReportError;
use crate::read::{Problems, RunRow, Simulation, Study};
use crate::text::{Kind, Part, Table, markdown};

/// What of the table of runs a page is wide enough for, with the headings there.
const OF_RUNS: [(&str, &str); 11] = [
    ("problem", "problem"),
    ("method", "method"),
    ("variant", "variant"),
    ("status", "status"),
    ("iterations_to_zeta_1e_3", "ζ ≤ 10⁻³"),
    ("iterations_to_zeta_1e_4", "ζ ≤ 10⁻⁴"),
    ("iterations_to_natural_map_1e_2", "natural map ≤ 10⁻²"),
    ("iterations_to_natural_map_1e_4", "≤ 10⁻⁴"),
    ("iterations", "iterations"),
    ("iterating_s", "seconds"),
    ("velocity_error", "error at the end"),
];

/// The same of the table of simulations.
const OF_SIMULATIONS: [(&str, &str); 11] = [
    ("scene", "scene"),
    ("role", "role"),
    ("time_step_s", "h (s)"),
    ("method", "method"),
    ("variant", "variant"),
    ("warm_start", "warm"),
    ("tolerance", "tolerance"),
    ("max_iterations", "budget"),
    ("status", "status"),
    ("missed_time_steps", "missed"),
    ("iterations", "iterations"),
];

/// `iterations`, with the iterations to each accuracy, counted work and seconds of each run; or `simulations`.
pub(crate) fn rows(study: &Study) -> Result<Part, ReportError> {
    let (name, table) = match study {
        Study::Problems(study) => ("iterations", of_runs(study)?),
        Study::Simulations(all) => ("simulations", of_simulations(all)?),
    };
    Ok(Part { name: name.to_owned(), kind: Kind::Table(table) })
}

/// The table of runs as text, less what a page has no room for; below it, why runs were skipped.
///
/// # Errors
///
/// If a table lacks a column.
pub fn iterations_text(tables: &Tables) -> Result<String, ReportError> {
    text(&Study::of(tables.into())?)
}

/// The same of simulations; below it, why some ended early.
///
/// # Errors
///
/// If a table lacks a column.
pub fn simulations_text(tables: &SimulationTables) -> Result<String, ReportError> {
    text(&Study::of(tables.into())?)
}

fn text(study: &Study) -> Result<String, ReportError> {
    let Kind::Table(Table { shown, note, .. }) = rows(study)?.kind else { return Ok(String::new()) };
    Ok(markdown(&shown)? + &note)
}

fn of_runs(study: &Problems) -> Result<Table, ReportError> {
    let rows: Vec<&RunRow> = study.runs.iter().chain(&study.given).collect();
    let text = |of: fn(&RunRow) -> &str| rows.iter().map(|run| of(run)).collect::<Vec<_>>();
    let count = |of: fn(&RunRow) -> u64| rows.iter().map(|run| of(run)).collect::<Vec<_>>();
    let to = |of: fn(&RunRow) -> Option<u64>| rows.iter().map(|run| of(run)).collect::<Vec<_>>();
    let value = |of: fn(&RunRow) -> Option<f64>| rows.iter().map(|run| of(run)).collect::<Vec<_>>();
    let all = df!(
        "problem" => text(|run| &run.problem),
        "method" => text(|run| &run.method),
        "variant" => text(|run| &run.variant),
        "subdomains" => rows.iter().map(|run| run.subdomains).collect::<Vec<_>>(),
        "status" => text(|run| &run.status),
        "iterations_to_zeta_1e_3" => to(|run| run.iterations_to_zeta_1e_3),
        "iterations_to_zeta_1e_4" => to(|run| run.iterations_to_zeta_1e_4),
        "iterations_to_natural_map_1e_2" => to(|run| run.iterations_to_natural_map_1e_2),
        "iterations_to_natural_map_1e_4" => to(|run| run.iterations_to_natural_map_1e_4),
        "iterations" => count(|run| run.iterations),
        "contact_updates" => count(|run| run.end.contact_updates),
        "delassus_products" => count(|run| run.end.delassus_products),
        "triangular_solve_entries" => count(|run| run.end.triangular_solve_entries),
        "factorisations" => count(|run| run.end.factorisations),
        "setup_s" => value(|run| run.setup_s),
        "iterating_s" => value(|run| run.iterating_s),
        "natural_map" => value(|run| run.end.natural_map),
        "velocity_error" => value(|run| run.end.velocity_error),
        "reason" => text(|run| &run.reason),
        "id" => text(|run| &run.id),
    )?;
    let skipped = rows.iter().filter(|run| run.status == "skipped").map(|run| {
        let method = format!("{} {}", run.method, run.variant);
        format!("\nskipped: {} on {}: {}\n", method.trim_end(), run.problem, run.reason)
    });
    Ok(Table { shown: shown(&all, &OF_RUNS)?, all, note: skipped.collect() })
}

fn of_simulations(all: &[Simulation]) -> Result<Table, ReportError> {
    let text = |of: fn(&Simulation) -> &str| all.iter().map(of).collect::<Vec<_>>();
    let count = |of: fn(&Simulation) -> u64| all.iter().map(of).collect::<Vec<_>>();
    let value = |of: fn(&Simulation) -> Option<f64>| all.iter().map(of).collect::<Vec<_>>();
    let table = df!(
        "scene" => text(|s| &s.scene),
        "role" => text(|s| &s.role),
        "time_step_s" => value(|s| Some(s.time_step_s)),
        "method" => text(|s| &s.method),
        "variant" => text(|s| &s.variant),
        "warm_start" => all.iter().map(|s| s.warm_start).collect::<Vec<_>>(),
        "tolerance" => value(|s| Some(s.tolerance)),
        "max_iterations" => count(|s| s.max_iterations),
        "status" => text(|s| &s.status),
        "time_steps" => count(|s| s.time_steps),
        "missed_time_steps" => count(|s| s.missed_time_steps),
        "iterations" => count(|s| s.iterations),
        "contact_updates" => count(|s| s.contact_updates),
        "delassus_products" => count(|s| s.delassus_products),
        "setup_s" => value(|s| s.setup_s),
        "iterating_s" => value(|s| s.iterating_s),
        "reason" => text(|s| &s.reason),
    )?;
    let costs = df!("s per s" => value(Simulation::seconds_per_second))?;
    let note = all.iter().filter(|s| !s.reason.is_empty()).map(|s| {
        let method = format!("{} {}", s.method, s.variant);
        format!("\n{}: {} on {}: {}\n", s.status, method.trim_end(), s.scene, s.reason)
    });
    let shown = shown(&table, &OF_SIMULATIONS)?.hstack(costs.columns())?;
    Ok(Table { all: table, shown, note: note.collect() })
}

/// Some columns of a table, under their headings.
fn shown(all: &DataFrame, columns: &[(&str, &str)]) -> PolarsResult<DataFrame> {
    let column = |(name, heading): &(&str, &str)| Ok(all.column(name)?.clone().with_name((*heading).into()));
    let columns = columns.iter().map(column).collect::<PolarsResult<Vec<_>>>()?;
    DataFrame::new(all.height(), columns)
}
