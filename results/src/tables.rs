//! From rows to tables: one column per field, named after it; an undefined (NaN) value is a null.

use polars::df;
use polars::prelude::{
    DataFrame, DataType, Float64Type, IntoSeries, ListBuilderTrait, ListPrimitiveChunkedBuilder, PolarsResult,
};

use crate::schema::{ContactRow, GrainRow, Provenance, Run, Sample, Snapshot, Timing};

/// One row per run, flat: its own fields, the counts and measures of its last sample, its provenance.
///
/// # Errors
///
/// Those of polars.
pub fn runs_table(runs: &[Run]) -> PolarsResult<DataFrame> {
    let timings: Vec<&Timing> = runs.iter().map(|r| &r.timing).collect();
    let origins: Vec<&Provenance> = runs.iter().map(|r| &r.provenance).collect();
    let parts = [asked(runs)?, reached(runs)?, timing(&timings)?, end(runs)?, provenance(&origins)?];
    let columns = parts.into_iter().flat_map(DataFrame::into_columns).collect();
    DataFrame::new(runs.len(), columns)
}

/// What was asked: the problem, the method, the rule that stops the run.
fn asked(runs: &[Run]) -> PolarsResult<DataFrame> {
    df!(
        "run" => column(runs, |r| r.run),
        "id" => column(runs, |r| r.id.as_str()),
        "plan" => column(runs, |r| r.plan.as_str()),
        "problem" => column(runs, |r| r.problem.as_str()),
        "problem_hash" => column(runs, |r| r.problem_hash.as_str()),
        "problem_settings" => column(runs, |r| r.problem_settings.as_str()),
        "grains" => column(runs, |r| r.grains),
        "contacts" => column(runs, |r| r.contacts),
        "method" => column(runs, |r| r.method.as_str()),
        "settings" => column(runs, |r| r.settings.as_str()),
        "derived" => column(runs, |r| r.derived.as_str()),
        "spectrum" => column(runs, |r| r.spectrum.as_str()),
        "variant" => column(runs, |r| r.variant.as_str()),
        "subdomains" => column(runs, |r| r.subdomains),
        "warm_start" => column(runs, |r| r.warm_start),
        "stop_on" => column(runs, |r| r.stop_on.as_str()),
        "tolerance" => column(runs, |r| defined(r.tolerance)),
        "max_iterations" => column(runs, |r| r.max_iterations),
    )
}

/// How the run ended and what it took.
fn reached(runs: &[Run]) -> PolarsResult<DataFrame> {
    df!(
        "status" => column(runs, |r| r.status.as_str()),
        "reason" => column(runs, |r| r.reason.as_str()),
        "iterations" => column(runs, |r| r.iterations),
        "setup_s" => column(runs, |r| defined(r.setup_s)),
        "iterating_s" => column(runs, |r| defined(r.iterating_s)),
        "iterations_to_zeta_1e_3" => column(runs, |r| r.iterations_to_zeta_1e_3),
        "iterations_to_zeta_1e_4" => column(runs, |r| r.iterations_to_zeta_1e_4),
        "iterations_to_natural_map_1e_2" => column(runs, |r| r.iterations_to_natural_map_1e_2),
        "iterations_to_natural_map_1e_4" => column(runs, |r| r.iterations_to_natural_map_1e_4),
        "iterations_to_velocity_error_1e_2" => column(runs, |r| r.iterations_to_velocity_error_1e_2),
        "iterations_to_velocity_error_1e_4" => column(runs, |r| r.iterations_to_velocity_error_1e_4),
    )
}

/// How the seconds were taken.
pub(crate) fn timing(timings: &[&Timing]) -> PolarsResult<DataFrame> {
    df!(
        "repeats" => column(timings, |t| t.repeats),
        "timed_alone" => column(timings, |t| t.timed_alone),
        "setup_spread_s" => column(timings, |t| defined(t.setup_spread_s)),
        "iterating_spread_s" => column(timings, |t| defined(t.iterating_spread_s)),
        "wall_s" => column(timings, |t| defined(t.wall_s)),
        "load_average" => column(timings, |t| defined(t.load_average)),
    )
}

/// The last sample, without the iterations and the seconds that the run states itself.
fn end(runs: &[Run]) -> PolarsResult<DataFrame> {
    let samples: Vec<Sample> = runs.iter().map(|r| r.end).collect();
    measures(&samples)
}

pub(crate) fn provenance(origins: &[&Provenance]) -> PolarsResult<DataFrame> {
    df!(
        "commit" => column(origins, |p| p.commit.as_str()),
        "processor" => column(origins, |p| p.processor.as_str()),
        "threads" => column(origins, |p| p.threads),
        "rustc" => column(origins, |p| p.rustc.as_str()),
        "profile" => column(origins, |p| p.profile.as_str()),
        "started_utc" => column(origins, |p| p.started_utc.as_str()),
    )
}

fn measures(samples: &[Sample]) -> PolarsResult<DataFrame> {
    df!(
        "zeta" => column(samples, |s| defined(s.zeta)),
        "natural_map" => column(samples, |s| defined(s.natural_map)),
        "penetration_rate_m_per_s" => column(samples, |s| defined(s.penetration_rate_m_per_s)),
        "quad_dv" => column(samples, |s| defined(s.quad_dv)),
        "max_dv" => column(samples, |s| defined(s.max_dv)),
        "velocity_error" => column(samples, |s| defined(s.velocity_error)),
        "energy_gap" => column(samples, |s| defined(s.energy_gap)),
        "velocity_jump_m_per_s" => column(samples, |s| defined(s.velocity_jump_m_per_s)),
        "energy_j" => column(samples, |s| defined(s.energy_j)),
        "contact_updates" => column(samples, |s| s.contact_updates),
        "delassus_products" => column(samples, |s| s.delassus_products),
        "interface_values" => column(samples, |s| s.interface_values),
        "triangular_solve_entries" => column(samples, |s| s.triangular_solve_entries),
        "factorisations" => column(samples, |s| s.factorisations),
    )
}

/// The curves of the runs, one below the other: `run`, then the fields of [`Sample`].
///
/// # Errors
///
/// Those of polars.
pub fn curves_table<Curve: AsRef<[Sample]>>(curves: &[(u32, Curve)]) -> PolarsResult<DataFrame> {
    let curves = || curves.iter().map(|(run, curve)| (*run, curve.as_ref()));
    let runs: Vec<u32> = curves().flat_map(|(run, curve)| vec![run; curve.len()]).collect();
    let samples: Vec<Sample> = curves().flat_map(|(_, curve)| curve.iter().copied()).collect();
    let progress = df!(
        "run" => runs,
        "iteration" => column(&samples, |s| s.iteration),
        "iterating_s" => column(&samples, |s| defined(s.iterating_s)),
    )?;
    progress.hstack(measures(&samples)?.columns())
}

/// The grains, one row per grain, problem and partition.
///
/// # Errors
///
/// Those of polars.
pub fn grains_table(rows: &[GrainRow]) -> PolarsResult<DataFrame> {
    df!(
        "problem" => column(rows, |g| g.problem.as_str()),
        "partition" => column(rows, |g| g.partition.as_str()),
        "grain" => column(rows, |g| g.grain),
        "x_m" => column(rows, |g| defined(g.x_m)),
        "y_m" => column(rows, |g| defined(g.y_m)),
        "radius_m" => column(rows, |g| defined(g.radius_m)),
        "subdomain" => column(rows, |g| g.subdomain),
        "multiplicity" => column(rows, |g| g.multiplicity),
    )
}

/// The contacts, one row per contact, problem and partition.
///
/// # Errors
///
/// Those of polars.
pub fn contacts_table(rows: &[ContactRow]) -> PolarsResult<DataFrame> {
    df!(
        "problem" => column(rows, |c| c.problem.as_str()),
        "partition" => column(rows, |c| c.partition.as_str()),
        "contact" => column(rows, |c| c.contact),
        "x0_m" => column(rows, |c| defined(c.x0_m)),
        "y0_m" => column(rows, |c| defined(c.y0_m)),
        "x1_m" => column(rows, |c| defined(c.x1_m)),
        "y1_m" => column(rows, |c| defined(c.y1_m)),
        "wall" => column(rows, |c| c.wall),
        "subdomain" => column(rows, |c| c.subdomain),
        "impulse_n_s" => column(rows, |c| defined(c.impulse_n_s)),
    )
}

/// The snapshots, one row for each, with a list of its impulses.
///
/// # Errors
///
/// Those of polars.
pub fn snapshots_table<Snapshots: AsRef<[Snapshot]>>(runs: &[(u32, Snapshots)]) -> PolarsResult<DataFrame> {
    let mut rows: Vec<(u32, &Snapshot)> = Vec::new();
    for run in runs {
        rows.extend(run.1.as_ref().iter().map(|snapshot| (run.0, snapshot)));
    }
    let values = rows.iter().map(|row| row.1.impulses_n_s.len()).sum();
    let name = "impulses_n_s".into();
    let mut impulses =
        ListPrimitiveChunkedBuilder::<Float64Type>::new(name, rows.len(), values, DataType::Float64);
    for (_, snapshot) in &rows {
        impulses.append_slice(&snapshot.impulses_n_s);
    }
    df!(
        "run" => column(&rows, |row| row.0),
        "iteration" => column(&rows, |row| row.1.iteration),
        "natural_map" => column(&rows, |row| defined(row.1.natural_map)),
        "impulses_n_s" => impulses.finish().into_series(),
    )
}

pub(crate) fn column<'a, Row, Value>(rows: &'a [Row], field: impl Fn(&'a Row) -> Value) -> Vec<Value> {
    rows.iter().map(field).collect()
}

/// NaN means "undefined" in a row and would be taken for a number in a table.
pub(crate) fn defined(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::fixture::{run, sample};

    #[test]
    fn no_rows_give_tables_with_all_their_columns() {
        assert_eq!(runs_table(&[]).unwrap().shape(), (0, 55));
        assert_eq!(curves_table::<Vec<Sample>>(&[]).unwrap().shape(), (0, 17));
        assert_eq!(curves_table(&[(4, Vec::new())]).unwrap().shape(), (0, 17));
        assert_eq!(grains_table(&[]).unwrap().shape(), (0, 8));
        assert_eq!(contacts_table(&[]).unwrap().shape(), (0, 10));
        assert_eq!(snapshots_table::<Vec<Snapshot>>(&[]).unwrap().shape(), (0, 4));
    }

    #[test]
    fn undefined_measure_is_null_and_infinite_one_is_kept() {
        let curve = vec![Sample { zeta: f64::NAN, natural_map: f64::INFINITY, ..sample(1) }];
        let table = curves_table(&[(3, curve)]).unwrap();
        assert_eq!(table.column("zeta").unwrap().f64().unwrap().get(0), None);
        assert_eq!(table.column("natural_map").unwrap().f64().unwrap().get(0), Some(f64::INFINITY));
    }

    #[test]
    fn run_ends_with_the_measures_of_its_last_sample() {
        let end = Sample { natural_map: 0.25, contact_updates: 12, ..sample(7) };
        let table = runs_table(&[Run { end, ..run(0) }]).unwrap();
        assert_eq!(table.column("natural_map").unwrap().f64().unwrap().get(0), Some(0.25));
        assert_eq!(table.column("contact_updates").unwrap().u64().unwrap().get(0), Some(12));
    }

    #[test]
    fn each_sample_names_its_run() {
        let table = curves_table(&[(5, vec![sample(1), sample(2)]), (6, vec![sample(1)])]).unwrap();
        let runs: Vec<u32> = table.column("run").unwrap().u32().unwrap().into_no_null_iter().collect();
        assert_eq!(runs, [5, 5, 6]);
    }
}
