//! The kinds of figures by name. To add one: its line in [`CHARTS`].

use std::fmt;
use std::str::FromStr;

use results::simulation::SimulationTables;
use results::store::Tables;
use thiserror::Error;

use crate::{
    File, ReportError, atlas_in_time, convergence, directions, profiles, sample, size, subdomains,
    trajectory, truth, work_precision,
};

/// A kind of figure, with the tables that belong to it.
#[derive(Clone, Copy)]
pub struct Chart {
    name: &'static str,
    files: Files,
}

/// What a chart is drawn from.
#[derive(Clone, Copy)]
enum Files {
    /// Runs on problems.
    Problems(fn(&Tables) -> Result<Vec<File>, ReportError>),
    /// Simulations.
    Simulations(fn(&SimulationTables) -> Result<Vec<File>, ReportError>),
}

/// All kinds, in the order in which help names them.
const CHARTS: &[Chart] = &[
    Chart { name: "convergence", files: Files::Problems(convergence::files) },
    Chart { name: "sample", files: Files::Problems(sample::files) },
    Chart { name: "directions", files: Files::Problems(directions::files) },
    Chart { name: "work-precision", files: Files::Problems(work_precision::files) },
    Chart { name: "truth", files: Files::Problems(truth::files) },
    Chart { name: "profiles", files: Files::Problems(profiles::files) },
    Chart { name: "subdomains", files: Files::Problems(subdomains::files) },
    Chart { name: "size", files: Files::Problems(size::files) },
    Chart { name: "trajectory", files: Files::Simulations(trajectory::files) },
    Chart { name: "atlas-in-time", files: Files::Simulations(atlas_in_time::files) },
];

impl Chart {
    /// Every kind.
    pub fn all() -> &'static [Self] {
        CHARTS
    }

    /// What a study gets that asks for nothing else: `convergence` and `sample`, or `trajectory` if it is through time.
    pub fn default_set(through_time: bool) -> Vec<Self> {
        let first = if through_time { 1 } else { 2 };
        CHARTS.iter().filter(|chart| chart.through_time() == through_time).take(first).copied().collect()
    }

    /// Whether it is drawn from simulations.
    pub fn through_time(self) -> bool {
        matches!(self.files, Files::Simulations(_))
    }

    /// Its name in plans and on the command line.
    pub fn name(self) -> &'static str {
        self.name
    }

    pub(crate) fn files(self, tables: &Tables) -> Result<Vec<File>, ReportError> {
        match self.files {
            Files::Problems(files) => files(tables),
            Files::Simulations(_) => Ok(Vec::new()),
        }
    }

    pub(crate) fn simulation_files(self, tables: &SimulationTables) -> Result<Vec<File>, ReportError> {
        match self.files {
            Files::Problems(_) => Ok(Vec::new()),
            Files::Simulations(files) => files(tables),
        }
    }
}

impl fmt::Debug for Chart {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl FromStr for Chart {
    type Err = UnknownChart;

    fn from_str(name: &str) -> Result<Self, UnknownChart> {
        CHARTS.iter().find(|chart| chart.name == name).copied().ok_or_else(|| UnknownChart(name.to_owned()))
    }
}

/// A name that no chart has.
#[derive(Debug, Error)]
#[error("no chart `{0}`: there are {names}", names = names())]
pub struct UnknownChart(String);

fn names() -> String {
    CHARTS.iter().map(|chart| chart.name).collect::<Vec<_>>().join(", ")
}
