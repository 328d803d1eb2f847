//! The seam between stored tables and the rows that everything else reads: nothing but this file, and `cells.rs` for it, knows
//! a stored data frame.

use std::collections::BTreeMap;

use minijinja::Value as Text;
use polars::prelude::{AnyValue, DataFrame};
use results::schema::Snapshot;
use results::simulation::SimulationTables;
use results::store::Tables;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::cells::rows;
use super::groups::differing;
use super::run::{Origin, Point, RunRow, words};
use super::scene::{Contact, Grain};
use super::simulation::{Instant, Simulation};
use super::{Ending, Problems, Scenes};
use crate::error::ReportError;

/// Impulses that another code gave are no run.
const GIVEN: &str = "given";

/// The run or simulation that a row belongs to.
#[derive(Deserialize)]
struct Owner {
    #[serde(alias = "simulation")]
    run: u32,
}

/// The impulses of a run after some of its iterations.
#[derive(Deserialize)]
struct Kept {
    iteration: u64,
    natural_map: Option<f64>,
    impulses_n_s: Vec<f64>,
}

#[derive(Deserialize)]
struct GrainCells {
    problem: String,
    partition: String,
    x_m: f64,
    y_m: f64,
    radius_m: f64,
    subdomain: Option<u32>,
    multiplicity: u32,
}

#[derive(Deserialize)]
struct ContactCells {
    problem: String,
    partition: String,
    x0_m: f64,
    y0_m: f64,
    x1_m: f64,
    y1_m: f64,
    wall: bool,
    subdomain: u32,
    impulse_n_s: Option<f64>,
}

/// A study of runs on problems.
pub(crate) fn problems(tables: &Tables) -> Result<Problems, ReportError> {
    let (mut curves, mut kept) = (owned::<Point>(&tables.curves)?, owned::<Kept>(&tables.snapshots)?);
    let (ends, origins) = (rows::<Point>(&tables.runs)?, rows::<Origin>(&tables.runs)?);
    let mut all: Vec<RunRow> = rows(&tables.runs)?;
    for ((run, end), origin) in all.iter_mut().zip(ends).zip(origins) {
        run.ending = Ending::of(&run.status);
        run.curve = curves.remove(&run.run).unwrap_or_default();
        run.curve.sort_by_key(|point| point.iteration);
        run.snapshots = kept.remove(&run.run).unwrap_or_default().into_iter().map(Kept::snapshot).collect();
        (run.end, run.origin) = (end, origin);
    }
    let (given, mut runs): (Vec<RunRow>, Vec<RunRow>) = all.into_iter().partition(|run| run.status == GIVEN);
    let differing = differing(runs.iter().map(|run| (&run.method, &run.settings)), &[]);
    for run in &mut runs {
        run.words = words(&run.variant, (&run.method, &run.settings), &differing);
    }
    Ok(Problems { runs, given, scenes: scenes(&tables.grains, &tables.contacts)? })
}

impl Kept {
    fn snapshot(self) -> Snapshot {
        let natural_map = self.natural_map.unwrap_or(f64::NAN);
        Snapshot { iteration: self.iteration, natural_map, impulses_n_s: self.impulses_n_s }
    }
}

/// The rows by the run or simulation that they belong to.
fn owned<T: DeserializeOwned>(table: &DataFrame) -> Result<BTreeMap<u32, Vec<T>>, ReportError> {
    let mut owned: BTreeMap<u32, Vec<T>> = BTreeMap::new();
    for (owner, row) in rows::<Owner>(table)?.into_iter().zip(rows(table)?) {
        owned.entry(owner.run).or_default().push(row);
    }
    Ok(owned)
}

/// The samples by problem and partition.
pub(crate) fn scenes(grains: &DataFrame, contacts: &DataFrame) -> Result<Scenes, ReportError> {
    let mut scenes = Scenes::new();
    for row in rows::<GrainCells>(grains)? {
        let GrainCells { x_m, y_m, radius_m: radius, subdomain, multiplicity, .. } = row;
        let grain = Grain { centre: (x_m, y_m), radius, subdomain, multiplicity };
        scenes.entry((row.problem, row.partition)).or_default().grains.push(grain);
    }
    for row in rows::<ContactCells>(contacts)? {
        let ContactCells { wall, subdomain, impulse_n_s: impulse, .. } = row;
        let (from, to) = ((row.x0_m, row.y0_m), (row.x1_m, row.y1_m));
        let contact = Contact { from, to, wall, subdomain, impulse };
        scenes.entry((row.problem, row.partition)).or_default().contacts.push(contact);
    }
    Ok(scenes)
}

/// A study of simulations, in its order.
pub(crate) fn simulations(tables: &SimulationTables) -> Result<Vec<Simulation>, ReportError> {
    let mut series = owned::<Instant>(&tables.series)?;
    let mut all: Vec<Simulation> = rows(&tables.simulations)?;
    for (simulation, origin) in all.iter_mut().zip(rows(&tables.simulations)?) {
        simulation.series = series.remove(&simulation.number).unwrap_or_default();
        simulation.origin = origin;
    }
    Ok(all)
}

/// The runs by the names of all their columns, as a template asks for them.
pub(crate) fn by_column(tables: &Tables) -> Result<Vec<BTreeMap<String, Text>>, ReportError> {
    let table = &tables.runs;
    let mut rows = vec![BTreeMap::new(); table.height()];
    for column in table.columns() {
        for (i, row) in rows.iter_mut().enumerate() {
            let cell = match column.get(i)? {
                AnyValue::Null => Text::from(()),
                AnyValue::String(text) => Text::from(text),
                AnyValue::Boolean(is) => Text::from(is),
                AnyValue::Float64(x) => Text::from(x),
                AnyValue::UInt32(n) => Text::from(n),
                AnyValue::UInt64(n) => Text::from(n),
                other => Text::from(other.to_string()),
            };
            row.insert(column.name().to_string(), cell);
        }
    }
    Ok(rows)
}
