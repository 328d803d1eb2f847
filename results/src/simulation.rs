//! Simulations: a row for each, and the series of what it showed of itself.

use polars::df;
use polars::prelude::{DataFrame, PolarsResult};
use serde::{Deserialize, Serialize};

use crate::journal::{Entry, EntryError};
use crate::number;
use crate::provenance::ProvenanceError;
use crate::schema::{Provenance, Timing};
use crate::tables::{column, defined, provenance, timing};

/// One simulation: a scene through time, each time step solved by one method until one stop rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simulation {
    /// Joins a simulation to its series; unique within a table, and given when the table is made.
    #[serde(skip)]
    pub simulation: u32,
    /// Hash of all that decides the series: scene, time step, duration, method with its settings, stop rule, start, and
    /// their code. The same id means the same series.
    pub id: String,
    /// Name of the plan that asked for it.
    pub plan: String,
    /// Name of the scene, without its time step: what compares.
    pub scene: String,
    /// What was set to make the scene, as JSON: `case`, and what replaced values of the case by their keys.
    pub scene_settings: String,
    /// Hash of the scene's content.
    pub scene_hash: String,
    /// `run`; `reference`, which the others are compared with; `twin`, the same with ten times its tolerance; `floor`, the
    /// reference's method and tolerance with a time step of the plan.
    pub role: String,
    /// Number of grains.
    pub grains: u32,
    /// Mass of all grains (kg).
    #[serde(with = "number")]
    pub mass_kg: f64,
    /// Mean diameter of the grains (m).
    #[serde(with = "number")]
    pub mean_diameter_m: f64,
    /// g (m/s²).
    #[serde(with = "number")]
    pub gravity_m_per_s2: f64,
    /// h (s).
    #[serde(with = "number")]
    pub time_step_s: f64,
    /// The time that was to be simulated (s).
    #[serde(with = "number")]
    pub duration_s: f64,
    /// Name of the method.
    pub method: String,
    /// All its parameters as JSON, defaults spelled out.
    pub settings: String,
    /// The settings in which the runs of this method in this plan differ; empty if they are alone.
    pub variant: String,
    /// Whether each time step began from the impulses of the one before.
    pub warm_start: bool,
    /// The measure that was asked to stop each time step.
    pub stop_on: String,
    /// Value of that measure at which a time step was to stop.
    #[serde(with = "number")]
    pub tolerance: f64,
    /// Greatest number of iterations allowed in a time step.
    pub max_iterations: u64,
    /// `completed`; `exploded`, or what made it explode: `solver-diverged`, or `no-solution` of a time step's problem;
    /// `skipped` if the method refused a time step.
    pub status: String,
    /// How it is known that it exploded, or why the method refused; empty for one that was completed.
    pub reason: String,
    /// The problem of the last good state, a file in the folder of the study; empty unless it exploded.
    pub last_state: String,
    /// Time steps made.
    pub time_steps: u64,
    /// Those of them that did not come to the tolerance.
    pub missed_time_steps: u64,
    /// Those of these whose solver diverged; 0 in journals of before they were counted, as below.
    #[serde(default)]
    pub diverged_time_steps: u64,
    /// Those of these whose problem has no solution.
    #[serde(default)]
    pub infeasible_time_steps: u64,
    /// Time steps that began from no impulses because the one before had diverged or had no solution.
    #[serde(default)]
    pub restarted_time_steps: u64,
    /// Iterations of all time steps.
    pub iterations: u64,
    /// Time in `start` of all time steps (s).
    #[serde(with = "number")]
    pub setup_s: f64,
    /// Time in `advance` of all time steps (s).
    #[serde(with = "number")]
    pub iterating_s: f64,
    /// Contacts updated in all time steps.
    pub contact_updates: u64,
    /// Products W p in all time steps.
    pub delassus_products: u64,
    /// Entries of triangular factors gone through in all time steps.
    pub triangular_solve_entries: u64,
    /// Matrices factorised in all time steps.
    pub factorisations: u64,
    /// How the seconds were taken.
    pub timing: Timing,
    /// Where the simulation comes from.
    pub provenance: Provenance,
}

/// Every [`Simulation::status`] that a journal can hold.
const STATUSES: [&str; 5] = ["completed", "exploded", "solver-diverged", "no-solution", "skipped"];

/// A row of a series: what a simulation shows of itself at an instant, and the extremes since the row before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observed {
    /// Time steps made.
    pub time_step: u64,
    /// Time (s).
    pub time_s: f64,
    /// Contacts of the problem just solved.
    pub contacts: u32,
    /// Iterations of all time steps so far.
    pub iterations: u64,
    /// ½ Σ m V² (J).
    #[serde(with = "number")]
    pub kinetic_energy_j: f64,
    /// Mean height of the centres of mass (m).
    #[serde(with = "number")]
    pub mean_height_m: f64,
    /// Greatest overlap since the row before (m).
    #[serde(with = "number")]
    pub greatest_overlap_m: f64,
    /// All overlaps of the problem just solved together, per grain (m).
    #[serde(with = "number")]
    pub mean_overlap_m: f64,
    /// Greatest speed of a grain since the row before (m/s).
    #[serde(with = "number")]
    pub greatest_speed_m_per_s: f64,
    /// All impulses of the contacts with the floor since the row before (N·s).
    #[serde(with = "number")]
    pub floor_impulse_n_s: f64,
    /// Those with the left wall (N·s).
    #[serde(with = "number")]
    pub left_impulse_n_s: f64,
    /// Those with the right wall (N·s).
    #[serde(with = "number")]
    pub right_impulse_n_s: f64,
}

/// A simulation with its series: one line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simulated {
    /// The row.
    pub simulation: Simulation,
    /// Its series; none for one that was skipped at once.
    pub series: Vec<Observed>,
}

impl Entry for Simulated {
    fn id(&self) -> &str {
        &self.simulation.id
    }

    fn method(&self) -> &str {
        &self.simulation.method
    }

    fn name(&self) -> String {
        let Simulation { method, variant, scene, .. } = &self.simulation;
        format!("{} on {scene}", format!("{method} {variant}").trim_end())
    }

    fn counts(&self) -> Vec<(String, String)> {
        let s = &self.simulation;
        let counts = [
            ("time_steps", s.time_steps),
            ("missed_time_steps", s.missed_time_steps),
            ("iterations", s.iterations),
            ("contact_updates", s.contact_updates),
            ("delassus_products", s.delassus_products),
            ("triangular_solve_entries", s.triangular_solve_entries),
            ("factorisations", s.factorisations),
        ];
        let counts = counts.map(|(name, count)| (name.to_owned(), count.to_string()));
        // NaN is what it is, here.
        let rows = self.series.iter().map(|row| (format!("series at {} s", row.time_s), format!("{row:?}")));
        std::iter::once(("status".to_owned(), s.status.clone())).chain(counts).chain(rows).collect()
    }

    fn check(&self) -> Result<(), EntryError> {
        EntryError::unless_known("status", &self.simulation.status, &STATUSES)?;
        if self.simulation.scene_hash.is_empty() {
            return Err(ProvenanceError::Unknown("scene_hash").into());
        }
        Ok(self.simulation.provenance.check()?)
    }
}

/// The tables of a study through time.
#[derive(Clone, Debug)]
pub struct SimulationTables {
    /// One row per simulation.
    pub simulations: DataFrame,
    /// One row per kept instant of a simulation.
    pub series: DataFrame,
}

impl SimulationTables {
    /// The simulations in this order, each with its series below its number.
    ///
    /// # Errors
    ///
    /// Those of polars.
    pub fn new(simulated: &[Simulated]) -> PolarsResult<Self> {
        let rows: Vec<Simulation> = (0..)
            .zip(simulated)
            .map(|(simulation, s)| Simulation { simulation, ..s.simulation.clone() })
            .collect();
        let series: Vec<(u32, Observed)> =
            (0..).zip(simulated).flat_map(|(n, s)| s.series.iter().map(move |row| (n, *row))).collect();
        Ok(Self { simulations: simulations_table(&rows)?, series: series_table(&series)? })
    }
}

fn simulations_table(rows: &[Simulation]) -> PolarsResult<DataFrame> {
    let timings: Vec<&Timing> = rows.iter().map(|s| &s.timing).collect();
    let origins: Vec<&Provenance> = rows.iter().map(|s| &s.provenance).collect();
    let parts = [asked(rows)?, reached(rows)?, timing(&timings)?, provenance(&origins)?];
    DataFrame::new(rows.len(), parts.into_iter().flat_map(DataFrame::into_columns).collect())
}

/// What was asked: scene, method, stop rule.
fn asked(rows: &[Simulation]) -> PolarsResult<DataFrame> {
    df!(
        "simulation" => column(rows, |s| s.simulation),
        "id" => column(rows, |s| s.id.as_str()),
        "plan" => column(rows, |s| s.plan.as_str()),
        "scene" => column(rows, |s| s.scene.as_str()),
        "scene_settings" => column(rows, |s| s.scene_settings.as_str()),
        "scene_hash" => column(rows, |s| s.scene_hash.as_str()),
        "role" => column(rows, |s| s.role.as_str()),
        "grains" => column(rows, |s| s.grains),
        "mass_kg" => column(rows, |s| s.mass_kg),
        "mean_diameter_m" => column(rows, |s| s.mean_diameter_m),
        "gravity_m_per_s2" => column(rows, |s| s.gravity_m_per_s2),
        "time_step_s" => column(rows, |s| s.time_step_s),
        "duration_s" => column(rows, |s| s.duration_s),
        "method" => column(rows, |s| s.method.as_str()),
        "settings" => column(rows, |s| s.settings.as_str()),
        "variant" => column(rows, |s| s.variant.as_str()),
        "warm_start" => column(rows, |s| s.warm_start),
        "stop_on" => column(rows, |s| s.stop_on.as_str()),
        "tolerance" => column(rows, |s| s.tolerance),
        "max_iterations" => column(rows, |s| s.max_iterations),
    )
}

/// How it ended and what it took.
fn reached(rows: &[Simulation]) -> PolarsResult<DataFrame> {
    df!(
        "status" => column(rows, |s| s.status.as_str()),
        "reason" => column(rows, |s| s.reason.as_str()),
        "last_state" => column(rows, |s| s.last_state.as_str()),
        "time_steps" => column(rows, |s| s.time_steps),
        "missed_time_steps" => column(rows, |s| s.missed_time_steps),
        "diverged_time_steps" => column(rows, |s| s.diverged_time_steps),
        "infeasible_time_steps" => column(rows, |s| s.infeasible_time_steps),
        "restarted_time_steps" => column(rows, |s| s.restarted_time_steps),
        "iterations" => column(rows, |s| s.iterations),
        "setup_s" => column(rows, |s| defined(s.setup_s)),
        "iterating_s" => column(rows, |s| defined(s.iterating_s)),
        "contact_updates" => column(rows, |s| s.contact_updates),
        "delassus_products" => column(rows, |s| s.delassus_products),
        "triangular_solve_entries" => column(rows, |s| s.triangular_solve_entries),
        "factorisations" => column(rows, |s| s.factorisations),
    )
}

fn series_table(rows: &[(u32, Observed)]) -> PolarsResult<DataFrame> {
    df!(
        "simulation" => column(rows, |(n, _)| *n),
        "time_step" => column(rows, |(_, o)| o.time_step),
        "time_s" => column(rows, |(_, o)| o.time_s),
        "contacts" => column(rows, |(_, o)| o.contacts),
        "iterations" => column(rows, |(_, o)| o.iterations),
        "kinetic_energy_j" => column(rows, |(_, o)| defined(o.kinetic_energy_j)),
        "mean_height_m" => column(rows, |(_, o)| defined(o.mean_height_m)),
        "greatest_overlap_m" => column(rows, |(_, o)| defined(o.greatest_overlap_m)),
        "mean_overlap_m" => column(rows, |(_, o)| defined(o.mean_overlap_m)),
        "greatest_speed_m_per_s" => column(rows, |(_, o)| defined(o.greatest_speed_m_per_s)),
        "floor_impulse_n_s" => column(rows, |(_, o)| defined(o.floor_impulse_n_s)),
        "left_impulse_n_s" => column(rows, |(_, o)| defined(o.left_impulse_n_s)),
        "right_impulse_n_s" => column(rows, |(_, o)| defined(o.right_impulse_n_s)),
    )
}

#[cfg(test)]
mod tests;
