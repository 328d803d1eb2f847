//! Simulations: a row for each, and the series of what it showed of itself.

pub use cases::{Bulk, Energy, Shape, Stress};
use contact::{Work, number};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::error::RowError;
use crate::journal::{Entry, named};
use crate::json;
use crate::name::{self, Name, StopOn, names};
use crate::schema::{Provenance, Timing, undefined};

/// One simulation: a scene through time, each time step solved by one method until one stop rule.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Simulation {
    /// Hash of all that decides the series: scene, time step, duration, method with its settings, stop rule, start, and
    /// their code. The same id means the same series.
    pub id: String,
    /// Name of the plan that asked for it.
    pub plan: String,
    /// Name of the scene, without its time step: what compares.
    pub scene: String,
    /// Settings that made the scene, as JSON: `case`, and replacements of values of the case by their keys.
    #[serde(with = "json")]
    pub scene_settings: Map<String, Value>,
    /// Hash of the scene's content.
    pub scene_hash: String,
    /// Its part in the study.
    #[serde(with = "name")]
    pub role: Role,
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
    #[serde(with = "json")]
    pub settings: Map<String, Value>,
    /// The settings in which the runs of this method in this plan differ; empty if they are alone.
    pub variant: String,
    /// True where each time step began from impulses of the time steps before.
    pub warm_start: bool,
    /// Initial impulses of each time step: `nothing`, `previous` impulses, or those `extrapolated` from the last two; empty in
    /// journals older than this choice.
    #[serde(default)]
    pub start: String,
    /// The measure that was asked to stop each time step.
    #[serde(with = "name")]
    pub stop_on: StopOn,
    /// Value of that measure at which a time step was to stop.
    #[serde(with = "number")]
    pub tolerance: f64,
    /// Greatest number of iterations allowed in a time step.
    pub max_iterations: u64,
    /// Ending of the simulation.
    #[serde(with = "name")]
    pub status: SimulationEnding,
    /// Evidence of the explosion, or the reason why the method refused; empty for a simulation that was completed.
    pub reason: String,
    /// The problem of the last good state, a file in the folder of the study; empty unless it exploded.
    pub last_state: String,
    /// Totals over all time steps.
    #[serde(flatten)]
    pub totals: Totals,
    /// Timing of the simulation.
    pub timing: Timing,
    /// Provenance of the simulation.
    pub provenance: Provenance,
}

/// Totals over all time steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Totals {
    /// Time steps made.
    pub time_steps: u64,
    /// Time steps whose solve missed the tolerance.
    pub missed_time_steps: u64,
    /// Missed time steps whose solver diverged; 0 in journals older than this count, as below.
    #[serde(default)]
    pub diverged_time_steps: u64,
    /// Missed time steps whose problem has no solution.
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
    /// Counted in all time steps.
    #[serde(flatten)]
    pub work: Work,
    /// Energy balance of all time steps.
    #[serde(flatten)]
    pub energy: Energy,
}

contact::added!(
    Totals: time_steps,
    missed_time_steps,
    diverged_time_steps,
    infeasible_time_steps,
    restarted_time_steps,
    iterations,
    setup_s,
    iterating_s,
    work,
    energy
);

names! {
    /// Part of a simulation in a study.
    Role in "role" {
        /// A simulation that the study asks for.
        #[default]
        Run = "run",
        /// The simulation that the others are compared with.
        Reference = "reference",
        /// The reference with ten times its tolerance.
        Twin = "twin",
        /// The reference's method and tolerance with a time step of the plan.
        Floor = "floor",
    }
}

names! {
    /// Ending of a simulation.
    SimulationEnding in "status" {
        /// All time steps made.
        Completed = "completed",
        /// Not finite, or overlaps or motion beyond all bounds.
        Exploded = "exploded",
        /// Exploded because the solver diverged.
        SolverDiverged = "solver-diverged",
        /// Exploded because the problem of a time step has no solution.
        NoSolution = "no-solution",
        /// The method refused a time step.
        #[default]
        Skipped = "skipped",
    }
}

/// A row of a series: what a simulation shows of itself at an instant, and the extremes since the row before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observed {
    /// Time steps made.
    pub time_step: u64,
    /// Time (s).
    #[serde(with = "number")]
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
    /// Greatest distance of a grain from where it was when time began (m); NaN in journals older than this column.
    #[serde(default = "undefined", with = "number")]
    pub greatest_displacement_m: f64,
    /// All impulses of the contacts with the floor and its bumps, the drum and the segments since the row before (N·s).
    #[serde(with = "number")]
    pub floor_impulse_n_s: f64,
    /// All impulses of the contacts with the left wall since the row before (N·s).
    #[serde(with = "number")]
    pub left_impulse_n_s: f64,
    /// All impulses of the contacts with the right wall since the row before (N·s).
    #[serde(with = "number")]
    pub right_impulse_n_s: f64,
    /// Energy balance since the row before.
    #[serde(flatten)]
    pub energy: Energy,
    /// Stress and coordination, the means of all time steps since the row before; 0 in journals older than these, as below.
    #[serde(flatten)]
    pub stress: Stress,
    /// Properties away from walls and surface, likewise; NaN where one is not defined in one of the time steps.
    #[serde(flatten)]
    pub bulk: Bulk,
    /// Shape of the packing, and what has left it.
    #[serde(flatten)]
    pub shape: Shape,
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

    fn timing(&self) -> &Timing {
        &self.simulation.timing
    }

    fn provenance(&self) -> &Provenance {
        &self.simulation.provenance
    }

    fn counts(&self) -> Vec<(String, String)> {
        let Simulation { status, totals, .. } = &self.simulation;
        let steps = [
            ("time_steps", totals.time_steps),
            ("missed_time_steps", totals.missed_time_steps),
            ("iterations", totals.iterations),
        ];
        let counts = steps.into_iter().chain(totals.work.named());
        // NaN is what it is, here.
        let rows = self.series.iter().map(|row| (format!("series at {} s", row.time_s), format!("{row:?}")));
        named(status.name(), counts).into_iter().chain(rows).collect()
    }

    fn check(&self) -> Result<(), RowError> {
        if self.simulation.scene_hash.is_empty() {
            return Err(RowError::Untraced("scene_hash"));
        }
        self.simulation.provenance.check()
    }
}

#[cfg(test)]
mod tests;
