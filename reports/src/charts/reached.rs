//! Accuracies that each method reaches: how far methods come, whatever the time.

use contact::Measure;
use polars::df;
use polars::prelude::DataFrame;
use results::Median;
use results::settings::KNOWN;

use super::grid::{Grid, Head, Tile};
use crate::draw::{Cell, INK, RGBColor, WHITE};
use crate::read::{
    COSTS, Ending, Kind, Problems, RunRow, accuracy_text, counted, file_name, first, kinds, natural_maps,
    unique,
};
use crate::text::{Part, frame};

/// Height of a row, and greatest width of a column (mm).
const SIZE: [f64; 2] = [6.0, 24.0];
const ALL: Cell = shade(60, "●");
const SOME: Cell = shade(165, "◐");
const NONE: Cell = Cell { fill: WHITE, letter: "–", ink: INK };

const fn shade(grey: u8, letter: &'static str) -> Cell {
    let fill = RGBColor(grey, grey, grey);
    Cell { fill, letter, ink: if grey > 130 { INK } else { WHITE } }
}

/// A row of a figure: problems of a case, a state, a friction and a size, whatever their starts.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    case: String,
    name: String,
    grains: u32,
}

/// A method on the problems of a row, at an accuracy.
struct Counts {
    row: Row,
    /// Method, settings and start.
    method: String,
    accuracy: f64,
    /// Number of its runs, those it refused apart.
    problems: usize,
    reached: usize,
    /// Number of the problems that the collection has a certified solution of, and of those whose status is open.
    known: [usize; 2],
    /// Counted work there (sweeps), where it is counted, over the problems.
    sweeps: Option<Median>,
}

/// The figures `reached-<case>-<grains>`, one for each case and size, and the table `reached`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let kinds = kinds(&study.runs);
    let accuracies = natural_maps(&study.runs);
    let mut all = Vec::new();
    for kind in &kinds {
        for label in unique(kind.runs.iter().map(|run| run.own_label())) {
            all.extend(accuracies.iter().filter_map(|accuracy| reached(kind, &label, *accuracy)));
        }
    }
    let columns = unique(study.runs.iter().map(|run| started(&run.own_label(), run.warm_start)));
    let mut parts = Vec::new();
    for (case, grains) in unique(all.iter().map(|one| (one.row.case.clone(), one.row.grains))) {
        let own: Vec<&Counts> =
            all.iter().filter(|one| one.row.case == case && one.row.grains == grains).collect();
        let columns: Vec<&String> =
            columns.iter().filter(|column| own.iter().any(|one| one.method == **column)).collect();
        let name = format!("reached-{}-{grains}", file_name(&case));
        parts.push(Part::figure(name, figure(&own, &columns, &accuracies)));
    }
    let note = "\nReached: the natural map is at most the accuracy and stays below ten times that. Sweeps: counted work there, median over the \
                problems, where the method's work is counted. Certified, open: problems of which the collection has a certified solution, and \
                none.\n";
    parts.push(Part::table("reached", table(&all), note));
    parts
}

/// A method with its start, where that is warm.
fn started(label: &str, is_warm: bool) -> String {
    format!("{label}{}", if is_warm { WARM } else { "" })
}

/// End of the names of kinds and methods of warm runs.
const WARM: &str = ", warm";

/// Counts how often a method reaches an accuracy on problems of a kind; `None` where it has no run.
fn reached(kind: &Kind, label: &str, accuracy: f64) -> Option<Counts> {
    let made = |run: &&&RunRow| run.own_label() == label && run.status != Ending::Skipped;
    let runs: Vec<&RunRow> = kind.runs.iter().filter(made).copied().collect();
    let is_there = |run: &&&RunRow| first(&run.curve, Measure::NaturalMap, accuracy.log10()).is_some();
    let work = |run: &&RunRow| COSTS[1].to(run, Measure::NaturalMap, accuracy);
    let status = |run: &&RunRow| Some(run.problem_settings.get(KNOWN)?.as_str()?.to_owned());
    let statuses: Vec<String> = runs.iter().filter_map(status).collect();
    let count = |of: &[&str]| statuses.iter().filter(|status| of.contains(&status.as_str())).count();
    let first = runs.first()?;
    let name = kind.name.strip_suffix(WARM).unwrap_or(&kind.name);
    Some(Counts {
        row: Row { case: kind.case.clone(), name: name.to_owned(), grains: kind.grains },
        method: started(label, first.warm_start),
        accuracy,
        problems: runs.len(),
        reached: runs.iter().filter(is_there).count(),
        known: [count(&["certified", "several", "solved"]), count(&["open"])],
        sweeps: Median::of(runs.iter().filter_map(work).collect()),
    })
}

/// A row for each kind, a column for each method, in it the accuracies from left to right.
fn figure(own: &[&Counts], columns: &[&String], accuracies: &[f64]) -> String {
    let rows = unique(own.iter().map(|one| one.row.clone()));
    let packings = |row: &Row| {
        let most = own.iter().filter(|one| one.row == *row).map(|one| one.problems).max();
        counted(most.unwrap_or(0), "packing")
    };
    let packings: Vec<String> = rows.iter().map(packings).collect();
    let cell = |of: &&Counts| match of.reached {
        0 => NONE,
        reached if reached == of.problems => ALL,
        _ => SOME,
    };
    let tiles: &dyn Fn(usize, usize) -> Vec<Option<Tile>> = &|row, column| {
        let here = |of: &&&Counts| of.row == rows[row] && of.method == *columns[column];
        let cells: Vec<Cell> = own.iter().copied().filter(|of| here(&of)).map(|of| cell(&of)).collect();
        vec![(!cells.is_empty()).then_some(Tile { cells, marks: [false, false] })]
    };
    let accuracies: Vec<String> = accuracies.iter().map(|accuracy| accuracy_text(*accuracy)).collect();
    let meant = [(ALL, "on all packings"), (SOME, "on some"), (NONE, "on none")];
    Grid {
        title: format!(
            "{}, {}: which methods come to a natural map of {}, from left to right",
            rows[0].case,
            counted(rows[0].grains as usize, "grain"),
            accuracies.join(", ")
        ),
        notes: Vec::new(),
        rows: rows
            .iter()
            .zip(&packings)
            .map(|(row, packings)| (row.name.as_str(), packings.as_str()))
            .collect(),
        height: SIZE[0],
        widest: SIZE[1],
        columns: (1..)
            .zip(columns)
            .map(|(k, label): (u32, _)| Head { short: k.to_string(), long: Some((*label).clone()) })
            .collect(),
        cells: meant.into_iter().map(|(cell, meaning)| (cell, meaning.to_owned())).collect(),
        marks: ["", ""],
        tiles,
    }
    .svg()
}

fn table(all: &[Counts]) -> DataFrame {
    let number = |of: &dyn Fn(&Counts) -> usize| all.iter().map(|one| of(one) as u64).collect::<Vec<_>>();
    let sweeps =
        |of: fn(&Median) -> f64| all.iter().map(|one| one.sweeps.as_ref().map(of)).collect::<Vec<_>>();
    frame(df!(
        "case" => all.iter().map(|one| one.row.case.as_str()).collect::<Vec<_>>(),
        "kind" => all.iter().map(|one| one.row.name.as_str()).collect::<Vec<_>>(),
        "grains" => all.iter().map(|one| one.row.grains).collect::<Vec<_>>(),
        "method" => all.iter().map(|one| one.method.as_str()).collect::<Vec<_>>(),
        "natural_map" => all.iter().map(|one| one.accuracy).collect::<Vec<_>>(),
        "problems" => number(&|one| one.problems),
        "reached" => number(&|one| one.reached),
        "certified" => number(&|one| one.known[0]),
        "open" => number(&|one| one.known[1]),
        "sweeps" => sweeps(|of| of.median),
        "sweeps_low" => sweeps(|of| of.low),
        "sweeps_high" => sweeps(|of| of.high),
    ))
}

#[cfg(test)]
mod tests;
