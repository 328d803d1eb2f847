//! What the figures read of the tables of simulations; and those tables as text.

use std::collections::BTreeMap;

use polars::prelude::{DataFrame, NamedFrom, PolarsResult, Series};
use results::simulation::SimulationTables;

use crate::ReportError;
use crate::columns::{bools, f64s, measures, texts, u32s, u64s};
use crate::legend::{Look, family};
use crate::number::{count, counted};
use crate::part::{Kind, Part, Table};
use crate::rows::label;
use crate::style::{DASHES, Mark, Pen, SPARE};
use crate::table::markdown;

/// A simulation with its series.
pub(crate) struct Simulation {
    pub(crate) scene: String,
    pub(crate) role: String,
    pub(crate) method: String,
    pub(crate) variant: String,
    pub(crate) warm_start: bool,
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: u64,
    pub(crate) status: String,
    pub(crate) mass_kg: f64,
    pub(crate) mean_diameter_m: f64,
    pub(crate) gravity_m_per_s2: f64,
    pub(crate) time_step_s: f64,
    pub(crate) time_steps: u64,
    pub(crate) missed_time_steps: u64,
    /// Seconds in the method for each second simulated, as far as it came.
    pub(crate) seconds_per_second: Option<f64>,
    pub(crate) series: Vec<Instant>,
}

/// A row of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Instant {
    pub(crate) kinetic_energy_j: f64,
    pub(crate) mean_height_m: f64,
    pub(crate) greatest_overlap_m: f64,
    /// Impulses of the floor, the left and the right wall since the row before (N·s).
    pub(crate) wall_impulses_n_s: [f64; 3],
}

/// Every simulation of a study, in its order.
pub(crate) fn simulations(tables: &SimulationTables) -> Result<Vec<Simulation>, ReportError> {
    let mut series = series(&tables.series)?;
    let table = &tables.simulations;
    let number = u32s(table, "simulation")?;
    let (scene, role, method) = (texts(table, "scene")?, texts(table, "role")?, texts(table, "method")?);
    let (variant, status) = (texts(table, "variant")?, texts(table, "status")?);
    let (warm, tolerance) = (bools(table, "warm_start")?, f64s(table, "tolerance")?);
    let (max_iterations, time_steps) = (u64s(table, "max_iterations")?, u64s(table, "time_steps")?);
    let (missed, h) = (u64s(table, "missed_time_steps")?, f64s(table, "time_step_s")?);
    let (mass, diameter) = (f64s(table, "mass_kg")?, f64s(table, "mean_diameter_m")?);
    let gravity = f64s(table, "gravity_m_per_s2")?;
    let seconds = seconds_per_second(table)?;
    let row = |i: usize| Simulation {
        scene: scene[i].clone(),
        role: role[i].clone(),
        method: method[i].clone(),
        variant: variant[i].clone(),
        warm_start: warm[i],
        tolerance: tolerance[i],
        max_iterations: max_iterations[i],
        status: status[i].clone(),
        mass_kg: mass[i],
        mean_diameter_m: diameter[i],
        gravity_m_per_s2: gravity[i],
        time_step_s: h[i],
        time_steps: time_steps[i],
        missed_time_steps: missed[i],
        seconds_per_second: seconds[i],
        series: series.remove(&number[i]).unwrap_or_default(),
    };
    Ok((0..table.height()).map(row).collect())
}

fn seconds_per_second(table: &DataFrame) -> Result<Vec<Option<f64>>, ReportError> {
    let (setup, iterating) = (measures(table, "setup_s")?, measures(table, "iterating_s")?);
    let (time_steps, h) = (u64s(table, "time_steps")?, f64s(table, "time_step_s")?);
    let of = |i: usize| {
        let simulated = time_steps[i] as f64 * h[i];
        (simulated > 0.0).then_some((setup[i]? + iterating[i]?) / simulated)
    };
    Ok((0..table.height()).map(of).collect())
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

/// The values of `of`, each once, in their order.
pub(crate) fn distinct<'s, T: PartialEq>(
    simulations: &'s [Simulation],
    of: impl Fn(&'s Simulation) -> T,
) -> Vec<T> {
    let mut values = Vec::new();
    for value in simulations.iter().map(of) {
        if !values.contains(&value) {
            values.push(value);
        }
    }
    values
}

/// The simulation of a scene in this role, if it was made.
pub(crate) fn in_role<'s>(all: &'s [Simulation], scene: &str, role: &str) -> Option<&'s Simulation> {
    all.iter().find(|other| other.scene == scene && other.role == role)
}

impl Simulation {
    pub(crate) fn is_run(&self) -> bool {
        self.role == "run"
    }

    pub(crate) fn label(&self) -> String {
        label(&self.method, &self.variant)
    }
}

/// Each method of the runs as a key says it, in the colour that it has in every study; its dashes tell it in grey, since
/// signs tell time steps.
pub(crate) fn looks(all: &[Simulation]) -> Vec<(String, Look)> {
    let mut looks: Vec<(String, Look)> = Vec::new();
    let mut methods: Vec<&str> = Vec::new();
    for run in all.iter().filter(|s| s.is_run()) {
        if looks.iter().any(|(label, _)| *label == run.label()) {
            continue;
        }
        let known = methods.iter().position(|method| *method == run.method);
        let place = known.unwrap_or_else(|| {
            methods.push(&run.method);
            methods.len() - 1
        });
        let own = family(&run.method).unwrap_or(&SPARE[place % SPARE.len()]);
        let pen = Pen { color: own.shades[0], width: own.width, dash: DASHES[looks.len() % DASHES.len()] };
        looks.push((run.label(), Look { pen, mark: Mark::None }));
    }
    looks
}

/// A time step as it is read, without zeros behind it (ms).
pub(crate) fn milliseconds(time_step_s: f64) -> f64 {
    (1e6 * time_step_s).round() / 1e3
}

/// What is told of each simulation.
const COLUMNS: [&str; 17] = [
    "scene",
    "role",
    "time_step_s",
    "method",
    "variant",
    "warm_start",
    "tolerance",
    "max_iterations",
    "status",
    "time_steps",
    "missed_time_steps",
    "iterations",
    "contact_updates",
    "delassus_products",
    "setup_s",
    "iterating_s",
    "reason",
];

/// How the simulations ended, in words.
pub(crate) fn found(tables: &SimulationTables) -> Result<Vec<String>, ReportError> {
    let mut ended: BTreeMap<String, usize> = BTreeMap::new();
    for status in texts(&tables.simulations, "status")? {
        *ended.entry(status).or_default() += 1;
    }
    if ended.is_empty() {
        return Ok(vec!["No simulation of this study is stored.".to_owned()]);
    }
    let all = counted(tables.simulations.height(), "simulation");
    let ended: Vec<String> = ended.iter().map(|(status, n)| format!("{} {status}", count(*n))).collect();
    Ok(vec![format!("{all}: {}.", ended.join(", "))])
}

/// One row per simulation that did not come to its end.
pub(crate) fn failures(tables: &SimulationTables) -> Result<DataFrame, ReportError> {
    let table = &tables.simulations;
    let reasons = texts(table, "reason")?;
    let failed: Vec<usize> = (0..table.height()).filter(|i| !reasons[*i].is_empty()).collect();
    let mut columns = Vec::new();
    for name in ["scene", "method", "variant", "status", "reason"] {
        let all = texts(table, name)?;
        let of_failed: Vec<&str> = failed.iter().map(|i| all[*i].as_str()).collect();
        columns.push(Series::new(name.into(), of_failed).into());
    }
    Ok(DataFrame::new(failed.len(), columns)?)
}

/// One row per simulation in the order of the study.
pub(crate) fn part(tables: &SimulationTables) -> Result<Part, ReportError> {
    Ok(Part { name: "simulations".to_owned(), kind: Kind::Table(table(tables)?) })
}

/// The same table as text, less what a page has no room for; below it, why some ended early.
///
/// # Errors
///
/// If the table of simulations lacks a column.
pub fn simulations_text(tables: &SimulationTables) -> Result<String, ReportError> {
    let Table { shown, note, .. } = table(tables)?;
    Ok(markdown(&shown)? + &note)
}

fn table(tables: &SimulationTables) -> Result<Table, ReportError> {
    const HEADINGS: [(&str, &str); 11] = [
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
    let table = &tables.simulations;
    let mut columns = HEADINGS
        .iter()
        .map(|(name, heading)| Ok(table.column(name)?.clone().with_name((*heading).into())))
        .collect::<PolarsResult<Vec<_>>>()?;
    columns.push(Series::new("s per s".into(), seconds_per_second(table)?).into());
    let (status, reason) = (texts(table, "status")?, texts(table, "reason")?);
    let rows: Vec<Vec<String>> = ["scene", "method", "variant"]
        .into_iter()
        .map(|name| texts(table, name))
        .collect::<Result<_, _>>()?;
    let mut note = String::new();
    for i in (0..table.height()).filter(|i| !reason[*i].is_empty()) {
        let method = format!("{} {}", rows[1][i], rows[2][i]);
        note.extend([format!("\n{}: {} on {}: {}\n", status[i], method.trim_end(), rows[0][i], reason[i])]);
    }
    let shown = DataFrame::new(table.height(), columns)?;
    Ok(Table { all: table.select(COLUMNS)?, shown, note })
}
