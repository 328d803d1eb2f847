//! From the rows of a study as they are stored to those that everything else reads: what is undefined is `None`.

use std::collections::BTreeMap;

use results::journal::Record;
use results::schema::{ContactRow, GrainRow, Provenance, Run, Sample, Timing};
use results::simulation::{Observed, Simulated};
use results::study::Runs;
use serde_json::{Map, Value};

use super::groups::differing;
use super::run::{Origin, Point, RunRow, words};
use super::scene::{Contact, Grain};
use super::simulation::{Instant, Simulation};
use super::{Ending, Problems, Scenes};

/// Impulses that another code gave are no run.
const GIVEN: &str = "given";

/// A study of runs on problems.
pub(crate) fn problems(study: &Runs) -> Problems {
    let rows = (0..).zip(&study.records).map(|(number, record)| run(number, record));
    let (given, mut runs): (Vec<RunRow>, Vec<RunRow>) = rows.partition(|row| row.status == GIVEN);
    let differing = differing(runs.iter().map(|run| (&run.method, &run.settings)), &[]);
    for run in &mut runs {
        run.words = words(&run.variant, (&run.method, &run.settings), &differing);
    }
    Problems { runs, given, scenes: scenes(&study.grains, &study.contacts) }
}

fn run(number: u32, Record { run, curve, snapshots }: &Record) -> RunRow {
    let (measures, work) = (run.end.measures, run.end.work);
    let end = Sample { iteration: run.iterations, iterating_s: run.iterating_s, measures, work };
    RunRow {
        run: number,
        id: run.id.clone(),
        problem: run.problem.clone(),
        problem_settings: run.problem_settings.clone(),
        grains: run.grains,
        contacts: run.contacts,
        method: run.method.clone(),
        settings: run.settings.clone(),
        derived: run.derived.clone(),
        spectrum: run.spectrum.clone(),
        variant: run.variant.clone(),
        words: String::new(),
        subdomains: run.subdomains,
        stop_on: run.stop_on.clone(),
        tolerance: defined(run.tolerance),
        max_iterations: run.max_iterations,
        status: run.status.clone(),
        ending: Ending::of(&run.status),
        reason: run.reason.clone(),
        iterations: run.iterations,
        iterations_to: [
            run.iterations_to_zeta_1e_3,
            run.iterations_to_zeta_1e_4,
            run.iterations_to_natural_map_1e_2,
            run.iterations_to_natural_map_1e_4,
        ],
        setup_s: defined(run.setup_s),
        iterating_s: defined(run.iterating_s),
        repeats: run.timing.repeats,
        end: point(&end),
        curve: curve.iter().map(point).collect(),
        snapshots: snapshots.clone(),
        origin: origin(&run.provenance, &run.timing),
    }
}

fn defined(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

fn point(Sample { iteration, iterating_s, measures, work }: &Sample) -> Point {
    Point {
        iteration: *iteration,
        iterating_s: defined(*iterating_s),
        zeta: defined(measures.zeta),
        natural_map: defined(measures.natural_map),
        penetration_rate: defined(measures.penetration_rate),
        quad_dv: defined(measures.quad_dv),
        max_dv: defined(measures.max_dv),
        velocity_error: defined(measures.velocity_error),
        contact_updates: work.contact_updates,
        delassus_products: work.delassus_products,
        triangular_solve_entries: work.triangular_solve_entries,
        factorisations: work.factorisations,
    }
}

fn origin(provenance: &Provenance, timing: &Timing) -> Origin {
    Origin {
        commit: provenance.commit.clone(),
        processor: provenance.processor.clone(),
        threads: provenance.threads,
        rustc: provenance.rustc.clone(),
        profile: provenance.profile.clone(),
        started_utc: provenance.started_utc.clone(),
        timed_alone: timing.timed_alone,
    }
}

/// The samples by problem and partition.
pub(crate) fn scenes(grains: &[GrainRow], contacts: &[ContactRow]) -> Scenes {
    let mut scenes = Scenes::new();
    for grain in grains {
        let name = (grain.problem.clone(), grain.partition.clone());
        scenes.entry(name).or_default().grains.push(Grain {
            centre: (grain.x_m, grain.y_m),
            radius: grain.radius_m,
            subdomain: grain.subdomain,
            multiplicity: grain.multiplicity,
        });
    }
    for contact in contacts {
        let name = (contact.problem.clone(), contact.partition.clone());
        scenes.entry(name).or_default().contacts.push(Contact {
            from: (contact.x0_m, contact.y0_m),
            to: (contact.x1_m, contact.y1_m),
            wall: contact.wall,
            subdomain: contact.subdomain,
            impulse: defined(contact.impulse_n_s),
        });
    }
    scenes
}

/// A simulation with its series.
pub(crate) fn simulation(Simulated { simulation, series }: &Simulated) -> Simulation {
    Simulation {
        scene: simulation.scene.clone(),
        role: simulation.role.clone(),
        method: simulation.method.clone(),
        variant: simulation.variant.clone(),
        warm_start: simulation.warm_start,
        tolerance: simulation.tolerance,
        max_iterations: simulation.max_iterations,
        status: simulation.status.clone(),
        reason: simulation.reason.clone(),
        mass_kg: simulation.mass_kg,
        mean_diameter_m: simulation.mean_diameter_m,
        gravity_m_per_s2: simulation.gravity_m_per_s2,
        time_step_s: simulation.time_step_s,
        time_steps: simulation.totals.time_steps,
        missed_time_steps: simulation.totals.missed_time_steps,
        iterations: simulation.totals.iterations,
        contact_updates: simulation.totals.work.contact_updates,
        delassus_products: simulation.totals.work.delassus_products,
        setup_s: defined(simulation.totals.setup_s),
        iterating_s: defined(simulation.totals.iterating_s),
        origin: origin(&simulation.provenance, &simulation.timing),
        series: series.iter().map(instant).collect(),
    }
}

fn instant(row: &Observed) -> Instant {
    Instant {
        kinetic_energy_j: row.kinetic_energy_j,
        mean_height_m: row.mean_height_m,
        greatest_overlap_m: row.greatest_overlap_m,
        wall_impulses_n_s: [row.floor_impulse_n_s, row.left_impulse_n_s, row.right_impulse_n_s],
    }
}

/// A run by the names of its columns, as a template asks for them.
pub(crate) fn by_column(run: &Run) -> Result<BTreeMap<String, Value>, serde_json::Error> {
    let fields: Map<String, Value> = serde_json::from_value(serde_json::to_value(run)?)?;
    let mut row = BTreeMap::new();
    for (name, field) in fields {
        match field {
            Value::Object(part) => row.extend(part),
            value => drop(row.insert(name, value)),
        }
    }
    Ok(row)
}
