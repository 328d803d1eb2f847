//! Data of a study for figures, tables and sentences: its rows, read once, and what follows from them.

mod cost;
mod ending;
mod fastest;
mod groups;
mod growth;
mod kinds;
mod methods;
mod norms;
mod number;
mod run;
mod scene;
mod simulation;
mod statistics;
pub(crate) mod stored;

use std::collections::BTreeMap;

pub(crate) use results::schema::{Ending, Sample};

pub(crate) use cost::{ACCURACIES, COSTS, Cost, WORK, accuracy_text};
pub(crate) use ending::{Verdicts, ending_text};
pub(crate) use fastest::{Ranked, Standing, Tally, natural_maps, ranked, tallies};
pub(crate) use groups::{differing, settings_text};
pub(crate) use growth::{Growth, LEAST, first, growth, without_subdomains};
pub(crate) use kinds::{Kind, kinds};
pub(crate) use norms::{Norm, norms};
pub(crate) use number::{SUPERSCRIPTS, count, counted, mantissa_and_power, number, power_of_ten, round_down};
pub(crate) use run::{RunRow, problems, repeats, stopped_at_1e_2, threads};
pub(crate) use scene::{Scene, ends, impulse, scenes, walls};
pub(crate) use simulation::{Simulation, in_role, milliseconds};
pub(crate) use statistics::{
    Mean, OF_90, OF_95, find_or_push, median, padded, rising, slope, slope_within, span, unique,
};

/// Samples by problem and partition.
pub(crate) type Scenes = BTreeMap<(String, String), Scene>;

/// The rows of a study.
pub(crate) enum Study {
    Problems(Problems),
    Simulations(Vec<Simulation>),
}

/// The rows of a study of runs on problems.
pub(crate) struct Problems {
    /// In the order of the study.
    pub(crate) runs: Vec<RunRow>,
    /// Impulses that other codes gave, after all runs.
    pub(crate) given: Vec<RunRow>,
    pub(crate) scenes: Scenes,
}

/// A file's name from a problem's or partition's: letters, digits, dot, dash, underscore.
pub(crate) fn file_name(text: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' };
    text.chars().map(safe).collect()
}
