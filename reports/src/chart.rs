//! The kinds of figures by name. To add one: its line in [`CHARTS`].

use std::fmt;
use std::str::FromStr;

use results::store::Tables;
use thiserror::Error;

use crate::{
    File, ReportError, atlas, convergence, directions, profiles, sample, size, subdomains, truth,
    work_precision,
};

/// A kind of figure, with the tables that belong to it.
#[derive(Clone, Copy)]
pub struct Chart {
    name: &'static str,
    files: fn(&Tables) -> Result<Vec<File>, ReportError>,
}

/// All kinds, in the order in which help names them.
const CHARTS: &[Chart] = &[
    Chart { name: "convergence", files: convergence::files },
    Chart { name: "sample", files: sample::files },
    Chart { name: "directions", files: directions::files },
    Chart { name: "work-precision", files: work_precision::files },
    Chart { name: "truth", files: truth::files },
    Chart { name: "profiles", files: profiles::files },
    Chart { name: "subdomains", files: subdomains::files },
    Chart { name: "size", files: size::files },
    Chart { name: "atlas", files: atlas::files },
];

impl Chart {
    /// Every kind.
    pub fn all() -> &'static [Self] {
        CHARTS
    }

    /// What a study gets that asks for nothing else: `convergence` and `sample`.
    pub fn default_set() -> &'static [Self] {
        &CHARTS[..2]
    }

    /// Its name in plans and on the command line.
    pub fn name(self) -> &'static str {
        self.name
    }

    pub(crate) fn files(self, tables: &Tables) -> Result<Vec<File>, ReportError> {
        (self.files)(tables)
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
