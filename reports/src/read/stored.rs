//! The seam between stored tables and the rows that everything else reads: nothing but this file, and `columns.rs` for it, knows a stored data frame.

use std::collections::BTreeMap;

use minijinja::Value as Cell;
use polars::prelude::{AnyValue, DataFrame};
use results::schema::Snapshot;
use results::simulation::SimulationTables;
use results::store::Tables;
use serde_json::Map;

use super::columns::{bools, counts, f64s, json, lists, measures, newer, texts, u32s, u64s};
use super::groups::differing;
use super::run::{Origin, Point, RunRow, words};
use super::scene::{Contact, Grain};
use super::simulation::{Instant, Simulation};
use super::{Ending, Problems, Scenes};
use crate::error::ReportError;

/// Impulses that another code gave are no run.
const GIVEN: &str = "given";

/// A study of runs on problems.
pub(crate) fn problems(tables: &Tables) -> Result<Problems, ReportError> {
    let mut curves = by_run(&tables.curves, points(&tables.curves, "iteration")?)?;
    let mut snapshots = by_run(&tables.snapshots, snapshots(&tables.snapshots)?)?;
    let mut rows = runs(&tables.runs)?;
    for row in &mut rows {
        row.curve = curves.remove(&row.run).unwrap_or_default();
        row.curve.sort_by_key(|point| point.iteration);
        row.snapshots = snapshots.remove(&row.run).unwrap_or_default();
    }
    let (given, mut runs): (Vec<RunRow>, Vec<RunRow>) = rows.into_iter().partition(|row| row.status == GIVEN);
    let differing = differing(runs.iter().map(|run| (&run.method, &run.settings)), &[]);
    for run in &mut runs {
        run.words = words(&run.variant, (&run.method, &run.settings), &differing);
    }
    Ok(Problems { runs, given, scenes: scenes(&tables.grains, &tables.contacts)? })
}

fn runs(table: &DataFrame) -> Result<Vec<RunRow>, ReportError> {
    let (run, id, grains) = (u32s(table, "run")?, texts(table, "id")?, u32s(table, "grains")?);
    let (contacts, subdomains) = (u32s(table, "contacts")?, u32s(table, "subdomains")?);
    let (problem, method) = (texts(table, "problem")?, texts(table, "method")?);
    let (settings, derived) = (json(table, "settings")?, json(table, "derived")?);
    let problem_settings = json(table, "problem_settings")?;
    let older = table.column("spectrum").is_err();
    let spectrum = if older { vec![Map::new(); table.height()] } else { json(table, "spectrum")? };
    let (reason, max_iterations) = (texts(table, "reason")?, u64s(table, "max_iterations")?);
    let (variant, status) = (texts(table, "variant")?, texts(table, "status")?);
    let (stop_on, tolerance) = (texts(table, "stop_on")?, measures(table, "tolerance")?);
    let (iterations, repeats) = (u64s(table, "iterations")?, u32s(table, "repeats")?);
    let (setup_s, iterating_s) = (measures(table, "setup_s")?, measures(table, "iterating_s")?);
    let (zeta_3, zeta_4) =
        (counts(table, "iterations_to_zeta_1e_3")?, counts(table, "iterations_to_zeta_1e_4")?);
    let (map_2, map_4) =
        (counts(table, "iterations_to_natural_map_1e_2")?, counts(table, "iterations_to_natural_map_1e_4")?);
    let (end, origin) = (points(table, "iterations")?, origins(table)?);
    let row = |i: usize| RunRow {
        run: run[i],
        id: id[i].clone(),
        problem: problem[i].clone(),
        problem_settings: problem_settings[i].clone(),
        grains: grains[i],
        contacts: contacts[i],
        method: method[i].clone(),
        settings: settings[i].clone(),
        derived: derived[i].clone(),
        spectrum: spectrum[i].clone(),
        variant: variant[i].clone(),
        words: String::new(),
        subdomains: subdomains[i],
        stop_on: stop_on[i].clone(),
        tolerance: tolerance[i],
        max_iterations: max_iterations[i],
        reason: reason[i].clone(),
        ending: Ending::of(&status[i]),
        status: status[i].clone(),
        iterations: iterations[i],
        iterations_to: [zeta_3[i], zeta_4[i], map_2[i], map_4[i]],
        setup_s: setup_s[i],
        iterating_s: iterating_s[i],
        repeats: repeats[i],
        end: end[i],
        curve: Vec::new(),
        snapshots: Vec::new(),
        origin: origin[i].clone(),
    };
    Ok((0..table.height()).map(row).collect())
}

/// Samples, whose iterations have this name.
fn points(table: &DataFrame, iteration: &str) -> Result<Vec<Point>, ReportError> {
    let (iteration, iterating_s) = (u64s(table, iteration)?, measures(table, "iterating_s")?);
    let (zeta, natural_map) = (measures(table, "zeta")?, measures(table, "natural_map")?);
    let (penetration_rate, max_dv) = (newer(table, "penetration_rate_m_per_s")?, newer(table, "max_dv")?);
    let (quad_dv, velocity_error) = (measures(table, "quad_dv")?, newer(table, "velocity_error")?);
    let (updates, products) = (u64s(table, "contact_updates")?, u64s(table, "delassus_products")?);
    let (entries, factorisations) =
        (u64s(table, "triangular_solve_entries")?, u64s(table, "factorisations")?);
    let row = |i: usize| Point {
        iteration: iteration[i],
        iterating_s: iterating_s[i],
        zeta: zeta[i],
        natural_map: natural_map[i],
        penetration_rate: penetration_rate[i],
        quad_dv: quad_dv[i],
        max_dv: max_dv[i],
        velocity_error: velocity_error[i],
        contact_updates: updates[i],
        delassus_products: products[i],
        triangular_solve_entries: entries[i],
        factorisations: factorisations[i],
    };
    Ok((0..table.height()).map(row).collect())
}

fn origins(table: &DataFrame) -> Result<Vec<Origin>, ReportError> {
    let (commit, processor) = (texts(table, "commit")?, texts(table, "processor")?);
    let (rustc, profile) = (texts(table, "rustc")?, texts(table, "profile")?);
    let (threads, started_utc) = (u32s(table, "threads")?, texts(table, "started_utc")?);
    let timed_alone = bools(table, "timed_alone")?;
    let row = |i: usize| Origin {
        commit: commit[i].clone(),
        processor: processor[i].clone(),
        threads: threads[i],
        rustc: rustc[i].clone(),
        profile: profile[i].clone(),
        started_utc: started_utc[i].clone(),
        timed_alone: timed_alone[i],
    };
    Ok((0..table.height()).map(row).collect())
}

fn snapshots(table: &DataFrame) -> Result<Vec<Snapshot>, ReportError> {
    let (iteration, map) = (u64s(table, "iteration")?, measures(table, "natural_map")?);
    let impulses = lists(table, "impulses_n_s")?;
    let row = |(i, impulses_n_s): (usize, _)| Snapshot {
        iteration: iteration[i],
        natural_map: map[i].unwrap_or(f64::NAN),
        impulses_n_s,
    };
    Ok(impulses.into_iter().enumerate().map(row).collect())
}

fn by_run<T>(table: &DataFrame, rows: Vec<T>) -> Result<BTreeMap<u32, Vec<T>>, ReportError> {
    let mut by_run: BTreeMap<u32, Vec<T>> = BTreeMap::new();
    for (run, row) in u32s(table, "run")?.into_iter().zip(rows) {
        by_run.entry(run).or_default().push(row);
    }
    Ok(by_run)
}

/// The samples by problem and partition.
pub(crate) fn scenes(grains: &DataFrame, contacts: &DataFrame) -> Result<Scenes, ReportError> {
    let mut scenes = Scenes::new();
    for (name, grain) in names(grains)?.into_iter().zip(grain_rows(grains)?) {
        scenes.entry(name).or_default().grains.push(grain);
    }
    for (name, contact) in names(contacts)?.into_iter().zip(contact_rows(contacts)?) {
        scenes.entry(name).or_default().contacts.push(contact);
    }
    Ok(scenes)
}

fn names(table: &DataFrame) -> Result<Vec<(String, String)>, ReportError> {
    Ok(texts(table, "problem")?.into_iter().zip(texts(table, "partition")?).collect())
}

fn grain_rows(table: &DataFrame) -> Result<Vec<Grain>, ReportError> {
    let (x, y, radius) = (f64s(table, "x_m")?, f64s(table, "y_m")?, f64s(table, "radius_m")?);
    let (subdomain, multiplicity) = (table.column("subdomain")?.u32()?, u32s(table, "multiplicity")?);
    let row = |i: usize| Grain {
        centre: (x[i], y[i]),
        radius: radius[i],
        subdomain: subdomain.get(i),
        multiplicity: multiplicity[i],
    };
    Ok((0..table.height()).map(row).collect())
}

fn contact_rows(table: &DataFrame) -> Result<Vec<Contact>, ReportError> {
    let (x0, y0) = (f64s(table, "x0_m")?, f64s(table, "y0_m")?);
    let (x1, y1) = (f64s(table, "x1_m")?, f64s(table, "y1_m")?);
    let (wall, impulse) = (bools(table, "wall")?, measures(table, "impulse_n_s")?);
    let subdomain = u32s(table, "subdomain")?;
    let row = |i: usize| Contact {
        from: (x0[i], y0[i]),
        to: (x1[i], y1[i]),
        wall: wall[i],
        subdomain: subdomain[i],
        impulse: impulse[i],
    };
    Ok((0..table.height()).map(row).collect())
}

/// A study of simulations, in its order.
pub(crate) fn simulations(tables: &SimulationTables) -> Result<Vec<Simulation>, ReportError> {
    let mut series = series(&tables.series)?;
    let table = &tables.simulations;
    let number = u32s(table, "simulation")?;
    let (scene, role, method) = (texts(table, "scene")?, texts(table, "role")?, texts(table, "method")?);
    let (variant, status) = (texts(table, "variant")?, texts(table, "status")?);
    let (reason, warm_start) = (texts(table, "reason")?, bools(table, "warm_start")?);
    let (tolerance, h) = (f64s(table, "tolerance")?, f64s(table, "time_step_s")?);
    let (max_iterations, time_steps) = (u64s(table, "max_iterations")?, u64s(table, "time_steps")?);
    let (missed, iterations) = (u64s(table, "missed_time_steps")?, u64s(table, "iterations")?);
    let (updates, products) = (u64s(table, "contact_updates")?, u64s(table, "delassus_products")?);
    let (mass, diameter) = (f64s(table, "mass_kg")?, f64s(table, "mean_diameter_m")?);
    let (gravity, origin) = (f64s(table, "gravity_m_per_s2")?, origins(table)?);
    let (setup_s, iterating_s) = (measures(table, "setup_s")?, measures(table, "iterating_s")?);
    let row = |i: usize| Simulation {
        scene: scene[i].clone(),
        role: role[i].clone(),
        method: method[i].clone(),
        variant: variant[i].clone(),
        warm_start: warm_start[i],
        tolerance: tolerance[i],
        max_iterations: max_iterations[i],
        status: status[i].clone(),
        reason: reason[i].clone(),
        mass_kg: mass[i],
        mean_diameter_m: diameter[i],
        gravity_m_per_s2: gravity[i],
        time_step_s: h[i],
        time_steps: time_steps[i],
        missed_time_steps: missed[i],
        iterations: iterations[i],
        contact_updates: updates[i],
        delassus_products: products[i],
        setup_s: setup_s[i],
        iterating_s: iterating_s[i],
        origin: origin[i].clone(),
        series: series.remove(&number[i]).unwrap_or_default(),
    };
    Ok((0..table.height()).map(row).collect())
}

fn series(table: &DataFrame) -> Result<BTreeMap<u32, Vec<Instant>>, ReportError> {
    let (number, kinetic) = (u32s(table, "simulation")?, f64s(table, "kinetic_energy_j")?);
    let (height, overlap) = (f64s(table, "mean_height_m")?, f64s(table, "greatest_overlap_m")?);
    let impulse = |wall: &str| f64s(table, &format!("{wall}_impulse_n_s"));
    let (floor, left, right) = (impulse("floor")?, impulse("left")?, impulse("right")?);
    let mut series: BTreeMap<u32, Vec<Instant>> = BTreeMap::new();
    for i in 0..table.height() {
        series.entry(number[i]).or_default().push(Instant {
            kinetic_energy_j: kinetic[i],
            mean_height_m: height[i],
            greatest_overlap_m: overlap[i],
            wall_impulses_n_s: [floor[i], left[i], right[i]],
        });
    }
    Ok(series)
}

/// The runs by the names of all their columns, as a template asks for them.
pub(crate) fn by_column(tables: &Tables) -> Result<Vec<BTreeMap<String, Cell>>, ReportError> {
    let table = &tables.runs;
    let mut rows = vec![BTreeMap::new(); table.height()];
    for column in table.columns() {
        for (i, row) in rows.iter_mut().enumerate() {
            let cell = match column.get(i)? {
                AnyValue::Null => Cell::from(()),
                AnyValue::String(text) => Cell::from(text),
                AnyValue::Boolean(is) => Cell::from(is),
                AnyValue::Float64(x) => Cell::from(x),
                AnyValue::UInt32(n) => Cell::from(n),
                AnyValue::UInt64(n) => Cell::from(n),
                other => Cell::from(other.to_string()),
            };
            row.insert(column.name().to_string(), cell);
        }
    }
    Ok(rows)
}
