//! The table of all runs, or of all simulations, with a row for each in the order of the study.

use polars::df;
use polars::prelude::{DataFrame, PolarsResult};
use results::columns::table;
use results::name::Name;
use results::schema::{Ending, Run};
use results::simulation::Simulation as Row;
use results::study::Study as Stored;

use crate::error::ReportError;
use crate::read::{Problems, Simulation, Study};
use crate::text::{Kind, Part, Table, markdown};

/// Columns of the table of runs that fit on a page, with the headings there.
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

/// Columns of the table of simulations that fit on a page, with the headings there.
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
    Ok(Part::new(name, Kind::Table(table)))
}

/// The table of runs or simulations as text, less what a page has no room for; below it, why runs were skipped or ended
/// early.
///
/// # Errors
///
/// Those of polars.
pub fn summary(study: &Stored) -> Result<String, ReportError> {
    let Kind::Table(Table { shown, note, .. }) = rows(&study.into())?.kind else { return Ok(String::new()) };
    Ok(markdown(&shown)? + &note)
}

/// Columns in the files of a table of runs.
const RUNS: &str = "\
    problem method variant subdomains status iterations_to_zeta_1e_3 iterations_to_zeta_1e_4 \
    iterations_to_natural_map_1e_2 iterations_to_natural_map_1e_4 iterations contact_updates \
    delassus_products triangular_solve_entries factorisations setup_s iterating_s natural_map \
    velocity_error last_change_moves cycle_iterations solutions spread polished_to polished_by reason id";

/// Columns in the files of a table of simulations.
const SIMULATIONS: &str = "\
    scene role time_step_s method variant warm_start tolerance max_iterations status time_steps \
    missed_time_steps iterations contact_updates delassus_products setup_s iterating_s walls_work_j gap_work_j shock_work_j sliding_work_j \
    energy_moved_j energy_left_over_j reason";

fn of_runs(study: &Problems) -> Result<Table, ReportError> {
    let rows = || study.runs.iter().chain(&study.given);
    let all = table::<Run>(rows().map(|run| &**run))?.select(RUNS.split(' '))?;
    let skipped = rows().filter(|run| run.status == Ending::Skipped).map(|run| {
        let method = format!("{} {}", run.method, run.variant);
        format!("\nskipped: {} on {}: {}\n", method.trim_end(), run.problem, run.reason)
    });
    Ok(Table { shown: shown(&all, &OF_RUNS)?, all, note: skipped.collect() })
}

fn of_simulations(simulations: &[Simulation]) -> Result<Table, ReportError> {
    let all =
        table::<Row>(simulations.iter().map(|simulation| &**simulation))?.select(SIMULATIONS.split(' '))?;
    let costs: Vec<Option<f64>> = simulations.iter().map(Simulation::seconds_per_second).collect();
    let note = simulations.iter().filter(|s| !s.reason.is_empty()).map(|s| {
        let method = format!("{} {}", s.method, s.variant);
        format!("\n{}: {} on {}: {}\n", s.status.name(), method.trim_end(), s.scene, s.reason)
    });
    let shown = shown(&all, &OF_SIMULATIONS)?.hstack(df!("s per s" => costs)?.columns())?;
    Ok(Table { all, shown, note: note.collect() })
}

/// Some columns of a table, under their headings.
fn shown(all: &DataFrame, columns: &[(&str, &str)]) -> PolarsResult<DataFrame> {
    let column = |(name, heading): &(&str, &str)| Ok(all.column(name)?.clone().with_name((*heading).into()));
    let columns = columns.iter().map(column).collect::<PolarsResult<Vec<_>>>()?;
    DataFrame::new(all.height(), columns)
}
