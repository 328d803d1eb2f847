//! The charts by name. To add one: its `mod`, and its line in [`CHARTS`].

mod against;
mod against_truth;
mod atlas;
mod atlas_in_time;
mod convergence;
mod critical_path;
mod directions;
mod peers;
mod profiles;
mod relaxation;
mod sample;
mod scaling;
mod size;
mod subdomains;
#[cfg(test)]
mod sweep_tests;
mod trajectory;
mod truth;
mod weak;
mod work_precision;

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::read::{Problems, Simulation, Study};
use crate::text::Part;
pub(crate) use against::parts as against;

/// A kind of figure, with the tables that belong to it.
#[derive(Clone, Copy)]
pub struct Chart {
    name: &'static str,
    parts: Parts,
}

/// What a chart is drawn from.
#[derive(Clone, Copy)]
enum Parts {
    /// Runs on problems.
    Problems(fn(&Problems) -> Vec<Part>),
    /// Simulations.
    Simulations(fn(&[Simulation]) -> Vec<Part>),
}

/// All kinds, in the order in which help names them.
const CHARTS: &[Chart] = &[
    Chart { name: "convergence", parts: Parts::Problems(convergence::parts) },
    Chart { name: "sample", parts: Parts::Problems(sample::parts) },
    Chart { name: "directions", parts: Parts::Problems(directions::parts) },
    Chart { name: "work-precision", parts: Parts::Problems(work_precision::parts) },
    Chart { name: "truth", parts: Parts::Problems(truth::parts) },
    Chart { name: "peers", parts: Parts::Problems(peers::parts) },
    Chart { name: "profiles", parts: Parts::Problems(profiles::parts) },
    Chart { name: "subdomains", parts: Parts::Problems(subdomains::parts) },
    Chart { name: "weak", parts: Parts::Problems(weak::parts) },
    Chart { name: "size", parts: Parts::Problems(size::parts) },
    Chart { name: "relaxation", parts: Parts::Problems(relaxation::parts) },
    Chart { name: "critical-path", parts: Parts::Problems(critical_path::parts) },
    Chart { name: "atlas", parts: Parts::Problems(atlas::parts) },
    Chart { name: "trajectory", parts: Parts::Simulations(trajectory::parts) },
    Chart { name: "atlas-in-time", parts: Parts::Simulations(atlas_in_time::parts) },
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
        matches!(self.parts, Parts::Simulations(_))
    }

    /// Its name in plans and on the command line.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Nothing of a study of the other kind.
    pub(crate) fn parts(self, study: &Study) -> Vec<Part> {
        match (self.parts, study) {
            (Parts::Problems(parts), Study::Problems(study)) => parts(study),
            (Parts::Simulations(parts), Study::Simulations(all)) => parts(all),
            _ => Vec::new(),
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
