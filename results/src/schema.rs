//! The tables, one struct per row: every column's name ends in its unit, unless it has none.

use contact::{Measure, Measures, Work, number};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::json;
use crate::name::{self, StopOn, names};

/// One run: a method with its parameters on a problem, stopped by a rule; where it ended and what it cost.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Hash of all that decides the counts: problem, method, settings, stop rule, start, and the method's code. The
    /// same id means the same counts.
    pub id: String,
    /// Name of the plan that asked for the run.
    pub plan: String,
    /// Name of the contact problem.
    pub problem: String,
    /// Hash of the problem's content.
    pub problem_hash: String,
    /// Settings that made the problem, as JSON: `case`, `time_step`, its `moment` and the `march` before it where the plan names them,
    /// `missed_before`, the number of time steps before that missed their tolerance, and replacements of values of the case by their
    /// keys, such as `sample.seed`; `{}` for a frozen one.
    #[serde(with = "json")]
    pub problem_settings: Map<String, Value>,
    /// Number of grains.
    pub grains: u32,
    /// Number of contacts.
    pub contacts: u32,
    /// Name of the method.
    pub method: String,
    /// All its parameters as JSON, defaults spelled out.
    #[serde(with = "json")]
    pub settings: Map<String, Value>,
    /// Values used beside the settings, as JSON: a value that these leave open, by its name; for a method with subdomains,
    /// `critical_path`, the multiply-adds of an iteration on the longest of them; for another code `rungs`: for each tolerance
    /// asked of it its iterations, the seconds by its clock and by ours, and what was measured.
    #[serde(with = "json")]
    pub derived: Map<String, Value>,
    /// Quantities computed for the problem and the run's partition, as JSON: `lambda_max`, the greatest eigenvalue of W_D⁻¹W, for
    /// many contacts by power iteration; of small problems `closed_lambda_max` and `closed_lambda_min`, the greatest and the least
    /// positive one over the contacts that the solution keeps closed, `redundant`, how many are 0, and `kappa_opt`, the best search
    /// direction of LATIN that follows; `multiplicity`, the most copies of a grain; `neighbours` and `sent_bytes`, of the subdomain
    /// that has most, with how many others it shares grains, and what it sends them when copies are glued; `boundary_share`, of the
    /// grains of all subdomains, copies counted each, the share that others hold too; `dimensions` of the problem's grains and
    /// `unknowns` of a contact; `coupling`, without split masses, the greatest eigenvalue of W_D⁻¹W with all within a subdomain
    /// left out.
    #[serde(default, with = "json")]
    pub spectrum: Map<String, Value>,
    /// The settings in which the runs of this method in this plan differ, such as `4x2`; empty if they are alone.
    pub variant: String,
    /// Number of subdomains; 1 for a method that does not decompose.
    pub subdomains: u32,
    /// True where the run began from the impulses of the previous time step.
    pub warm_start: bool,
    /// The measure that was asked to stop the run.
    #[serde(with = "name")]
    pub stop_on: StopOn,
    /// Value of that measure at which the run was to stop.
    #[serde(with = "number")]
    pub tolerance: f64,
    /// Greatest number of iterations allowed.
    pub max_iterations: u64,
    /// Ending of the run.
    #[serde(with = "name")]
    pub status: Ending,
    /// Why the run was skipped: the setting, its value, what would be accepted; or why another code gave no answer; empty for
    /// a run that ended.
    pub reason: String,
    /// Iterations made.
    pub iterations: u64,
    /// Time in `start`: layout, partition, factorisation; the median of the repeats (s).
    #[serde(with = "number")]
    pub setup_s: f64,
    /// Time in `advance`, measures excluded; the median of the repeats, the lower of the middle two (s).
    #[serde(with = "number")]
    pub iterating_s: f64,
    /// First iteration with ζ ≤ 1e-3 that no later one leaves by a decade, if any.
    pub iterations_to_zeta_1e_3: Option<u64>,
    /// First iteration with ζ ≤ 1e-4 that no later one leaves by a decade, if any.
    pub iterations_to_zeta_1e_4: Option<u64>,
    /// First iteration with `natural_map` ≤ 1e-2 that no later one leaves by a decade, if any.
    pub iterations_to_natural_map_1e_2: Option<u64>,
    /// First iteration with `natural_map` ≤ 1e-4 that no later one leaves by a decade, if any.
    pub iterations_to_natural_map_1e_4: Option<u64>,
    /// First iteration with `velocity_error` ≤ 1e-2 that no later one leaves by a decade, if any.
    pub iterations_to_velocity_error_1e_2: Option<u64>,
    /// First iteration with `velocity_error` ≤ 1e-4 that no later one leaves by a decade, if any.
    pub iterations_to_velocity_error_1e_4: Option<u64>,
    /// √(dᵗ W d / dᵗ W_D d) of the last iteration's change d of r, with the diagonal W_D of W (–): below 1e-4 impulses drift along the
    /// kernel of W and move next to nothing, or creep along a mode as slow. Undefined where r does not change.
    #[serde(default = "undefined", with = "number")]
    pub last_change_moves: f64,
    /// Iterations of the cycle in which a run went round at its iteration limit, up to 32: after them its impulses are the same again.
    #[serde(default)]
    pub cycle_iterations: Option<u64>,
    /// Messages between ranks, where several shared the problem.
    #[serde(default)]
    pub exchange: Exchange,
    /// Timing of the run.
    pub timing: Timing,
    /// Last sample of its curve, without the iterations and the seconds.
    pub end: End,
    /// Known solutions of the problem, and the end of the run relative to them.
    #[serde(default)]
    pub known: KnownSolutions,
    /// Provenance of the run.
    pub provenance: Provenance,
}

/// Returns the value in rows older than a column.
pub(crate) fn undefined() -> f64 {
    f64::NAN
}

/// Known solutions of a run's problem, and the end of the run relative to them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct KnownSolutions {
    /// Certified solutions that were known before the run, each with another velocity; `None` where they were not asked for.
    pub solutions: Option<u32>,
    /// Greatest ‖V − V′‖_M of two of them, over ‖V − V_free‖_M of the first (–); undefined of none.
    #[serde(with = "number")]
    pub spread: f64,
    /// With friction: `known` or `new`, as the certified solution is to which Newton's method leads from where the run ended; empty
    /// where it leads to none.
    pub polished_to: String,
    /// Distance of the end of the run from that solution, ‖V − V′‖_M over ‖V′ − V_free‖_M (–).
    #[serde(with = "number")]
    pub polished_by: f64,
}

/// Nothing is known.
impl Default for KnownSolutions {
    fn default() -> Self {
        Self { solutions: None, spread: f64::NAN, polished_to: String::new(), polished_by: f64::NAN }
    }
}

/// Messages between the ranks of a run in `advance`; none on one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Exchange {
    /// Number of ranks that shared the problem: 1 on one machine.
    pub ranks: u32,
    /// Messages of all ranks.
    pub messages: u64,
    /// Bytes in them (B).
    pub message_bytes: u64,
    /// The longest time that a rank spent in exchanges, for others that were late and for the way of the messages (s).
    #[serde(with = "number")]
    pub waiting_s: f64,
    /// The rank that worked longest, for which the others waited.
    pub slowest_rank: u32,
    /// Latency of a message, whatever its length, measured before the runs (s); undefined for one rank.
    #[serde(with = "number")]
    pub latency_s: f64,
    /// Time per byte of a message, measured likewise (s).
    #[serde(with = "number")]
    pub seconds_per_byte: f64,
}

/// One machine.
impl Default for Exchange {
    fn default() -> Self {
        Self {
            ranks: 1,
            messages: 0,
            message_bytes: 0,
            waiting_s: 0.0,
            slowest_rank: 0,
            latency_s: f64::NAN,
            seconds_per_byte: f64::NAN,
        }
    }
}

/// Timing of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Number of repeats of the run for its seconds: as many as the plan has, or more of a run that takes less than 1 ms; one more,
    /// before them, is not counted if there are several.
    pub repeats: u32,
    /// True where no other run of the study was made at the same time.
    pub timed_alone: bool,
    /// Width of the interval that holds the median of `setup_s` with a probability of 90 %: of five repeats the longest less the
    /// shortest; undefined for a single one (s).
    #[serde(with = "number")]
    pub setup_spread_s: f64,
    /// Width of that interval of `iterating_s`; undefined for a single one (s).
    #[serde(with = "number")]
    pub iterating_spread_s: f64,
    /// From the run's begin to its end: all repeats, with their measures (s).
    #[serde(with = "number")]
    pub wall_s: f64,
    /// Processes that ran or waited to, on average over the minute before the run began, as the system tells (–).
    #[serde(with = "number")]
    pub load_average: f64,
}

/// Nothing was timed.
impl Default for Timing {
    fn default() -> Self {
        Self {
            repeats: 0,
            timed_alone: false,
            setup_spread_s: f64::NAN,
            iterating_spread_s: f64::NAN,
            wall_s: f64::NAN,
            load_average: f64::NAN,
        }
    }
}

/// An iterate measured, and the work up to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// NaN where a measure is undefined.
    #[serde(flatten)]
    pub measures: Measures,
    /// Counted since the start.
    #[serde(flatten)]
    pub work: Work,
}

/// One point of a run's curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Iterations made.
    pub iteration: u64,
    /// Time in `advance` so far (s).
    #[serde(with = "number")]
    pub iterating_s: f64,
    /// NaN where a measure is undefined.
    #[serde(flatten)]
    pub measures: Measures,
    /// Counted so far.
    #[serde(flatten)]
    pub work: Work,
}

impl Sample {
    /// A measure, where it is defined.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        Some(self.measures.get(measure)).filter(|value| !value.is_nan())
    }

    /// The distance to the true velocity, where that is known.
    pub fn velocity_error(&self) -> Option<f64> {
        self.get(Measure::VelocityError)
    }
}

/// Provenance of a row. A run without it is not stored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Commit of the build; ends in `-modified` if the tree was.
    pub commit: String,
    /// The processor's own name.
    pub processor: String,
    /// Number of processors; 0 in rows older than this column.
    #[serde(default)]
    pub processors: u32,
    /// Threads that the run could use.
    pub threads: u32,
    /// Version of the compiler.
    pub rustc: String,
    /// `release`, or `debug`, whose seconds mean nothing.
    pub profile: String,
    /// When the run began (UTC, RFC 3339).
    pub started_utc: String,
    /// Version reported by another code that made the run; empty for a method of ours.
    #[serde(default)]
    pub other_code: String,
}

names! {
    /// Ending of a run; in keys of figures in this order.
    #[derive(PartialOrd, Ord)]
    Ending in "status" {
        /// The measure met the tolerance.
        Converged = "converged",
        /// All iterations made.
        IterationLimit = "iteration-limit",
        /// No further iteration changes anything.
        Stalled = "stalled",
        /// The iterate is not finite, or far above q(0).
        Diverged = "diverged",
        /// Claimed that there is no solution.
        Infeasible = "infeasible",
        /// The measure met the tolerance far from a solution, or where there is none: `solvers/runner/src/convergence.rs` has the rule.
        FalseConvergence = "false-convergence",
        /// The method could not start on the problem.
        Skipped = "skipped",
        /// Another code gave no answer.
        #[default]
        Failed = "failed",
        /// Impulses of another code, which no run here made.
        Given = "given",
    }
}

impl Provenance {
    /// Reports whether seconds of the two can be compared: the same build on the same processor with as many threads. Codes that
    /// are compared with ours have versions of their own.
    pub fn comparable(&self, other: &Self) -> bool {
        let build = |p: &Self| Self { started_utc: String::new(), other_code: String::new(), ..p.clone() };
        build(self) == build(other)
    }
}

/// One grain of a problem under one partition.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GrainRow {
    /// Name of the contact problem.
    pub problem: String,
    /// The partition, such as `4x2`.
    pub partition: String,
    /// Index of the grain.
    pub grain: u32,
    /// Centre (m).
    #[serde(with = "number")]
    pub x_m: f64,
    /// Centre (m).
    #[serde(with = "number")]
    pub y_m: f64,
    /// Centre; 0 of discs (m).
    #[serde(default, with = "number")]
    pub z_m: f64,
    /// Radius (m).
    #[serde(with = "number")]
    pub radius_m: f64,
    /// The subdomain that holds most of the grain's contacts; `None` for a grain without contact.
    pub subdomain: Option<u32>,
    /// Number of subdomains in which the grain has contacts: a boundary grain has more than 1.
    pub multiplicity: u32,
}

/// One contact of a problem under one partition, as a segment between the two sides.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactRow {
    /// Name of the contact problem.
    pub problem: String,
    /// The partition, such as `4x2`.
    pub partition: String,
    /// Index of the contact.
    pub contact: u32,
    /// Centre of the candidate (m).
    #[serde(with = "number")]
    pub x0_m: f64,
    /// Centre of the candidate (m).
    #[serde(with = "number")]
    pub y0_m: f64,
    /// Centre of the candidate; 0 of discs (m).
    #[serde(default, with = "number")]
    pub z0_m: f64,
    /// Centre of the antagonist, or the touched point of a wall, a lid, or a grain through a periodic side (m).
    #[serde(with = "number")]
    pub x1_m: f64,
    /// Centre of the antagonist, or the touched point of a wall, a lid, or a grain through a periodic side (m).
    #[serde(with = "number")]
    pub y1_m: f64,
    /// Centre of the antagonist, or the touched point of a wall, a lid, or a grain through a periodic side; 0 of discs (m).
    #[serde(default, with = "number")]
    pub z1_m: f64,
    /// True where the antagonist is a wall.
    pub wall: bool,
    /// The subdomain of the contact.
    pub subdomain: u32,
    /// Impulse of the reference solution, the same in every study; NaN if there is none (N·s).
    #[serde(with = "number")]
    pub impulse_n_s: f64,
}

/// The impulses of a run after some of its iterations, to be drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Iterations made.
    pub iteration: u64,
    /// Distance to a solution in the natural map (–).
    #[serde(with = "number")]
    pub natural_map: f64,
    /// r, in the problem's contact order, to three significant digits; NaN where it is not finite (N·s).
    #[serde(with = "number::list")]
    pub impulses_n_s: Vec<f64>,
    /// The contacts that slide, in that order; none without friction.
    #[serde(default, with = "indices")]
    pub sliding: Vec<u32>,
    /// The spin of each grain, to three significant digits; none without friction, or in space (rad/s).
    #[serde(default, with = "number::list")]
    pub spins_rad_per_s: Vec<f64>,
}

/// Indices as a list of numbers, which is what a column can hold.
mod indices {
    use serde::{Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(indices: &[u32], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(indices.iter().map(|index| f64::from(*index)))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u32>, D::Error> {
        let numbers = super::number::list::deserialize(deserializer)?;
        Ok(numbers.into_iter().filter(|number| number.is_finite()).map(|number| number as u32).collect())
    }
}
