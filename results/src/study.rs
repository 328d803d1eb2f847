//! Results of a study, as typed rows and as the tables that other programs read.

use polars::prelude::{DataFrame, PolarsResult};

use crate::columns::{keyed, table};
use crate::journal::Record;
use crate::schema::{ContactRow, GrainRow};
use crate::simulation::Simulated;

/// Results of a study.
#[derive(Clone, Debug)]
pub enum Study {
    /// Runs on problems.
    Runs(Runs),
    /// Simulations, each with its series.
    Simulations(Vec<Simulated>),
}

/// Results of a study of problems. A run has the number of its place in the list.
#[derive(Clone, Debug, Default)]
pub struct Runs {
    /// The runs with their curves.
    pub records: Vec<Record>,
    /// The grains of its problems under each partition.
    pub grains: Vec<GrainRow>,
    /// Their contacts.
    pub contacts: Vec<ContactRow>,
}

/// A table of a study, and the name of its file without the ending.
pub(crate) struct Named {
    pub(crate) name: &'static str,
    pub(crate) table: DataFrame,
    /// True where the table is also written as CSV, for spreadsheets and `diff`.
    pub(crate) csv: bool,
}

pub(crate) const RUNS: &str = "runs";
pub(crate) const CURVES: &str = "curves";
pub(crate) const GRAINS: &str = "grains";
pub(crate) const CONTACTS: &str = "contacts";
pub(crate) const SNAPSHOTS: &str = "snapshots";
pub(crate) const SIMULATIONS: &str = "simulations";
pub(crate) const SERIES: &str = "series";

/// Names of all tables that a study may have.
pub const TABLES: [&str; 7] = [RUNS, CURVES, GRAINS, CONTACTS, SNAPSHOTS, SIMULATIONS, SERIES];
/// The columns that number runs and simulations.
pub(crate) const RUN: &str = "run";
pub(crate) const SIMULATION: &str = "simulation";

impl Study {
    /// Its tables.
    pub(crate) fn tables(&self) -> PolarsResult<Vec<Named>> {
        let named = |name, table, csv| Named { name, table, csv };
        Ok(match self {
            Self::Runs(Runs { records, grains, contacts }) => {
                let each = || (0..).zip(records);
                let runs = each().map(|(n, record)| (n, &record.run));
                let curves = each().flat_map(|(n, record)| record.curve.iter().map(move |row| (n, row)));
                let snapshots =
                    each().flat_map(|(n, record)| record.snapshots.iter().map(move |row| (n, row)));
                vec![
                    named(RUNS, keyed(RUN, runs)?, true),
                    named(CURVES, keyed(RUN, curves)?, true),
                    named(GRAINS, table(grains)?, false),
                    named(CONTACTS, table(contacts)?, false),
                    named(SNAPSHOTS, keyed(RUN, snapshots)?, false),
                ]
            }
            Self::Simulations(all) => {
                let each = || (0..).zip(all);
                let simulations = each().map(|(n, one)| (n, &one.simulation));
                let series = each().flat_map(|(n, one)| one.series.iter().map(move |row| (n, row)));
                vec![
                    named(SIMULATIONS, keyed(SIMULATION, simulations)?, true),
                    named(SERIES, keyed(SIMULATION, series)?, true),
                ]
            }
        })
    }
}
