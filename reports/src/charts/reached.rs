//! Problems on which each method reaches each accuracy: how far methods come, whatever the time.

use contact::Measure;
use polars::df;
use polars::prelude::DataFrame;
use results::Median;
use results::settings::KNOWN;

use super::grid::{Grid, Head, Tile};
use crate::draw::{Cell, INK, RGBColor, WHITE};
use crate::read::{
    COSTS, Ending, Kind, Problems, RunRow, accuracy_text, counted, file_name, kinds, natural_maps, unique,
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

/// A method on the problems of a kind, at an accuracy.
struct Reached<'k> {
    kind: &'k Kind<'k>,
    method: String,
    accuracy: f64,
    /// Number of its runs, those it refused apart.
    problems: usize,
    reached: usize,
    /// Counted work there (sweeps), where it is counted, over the problems.
    sweeps: Option<Median>,
}

/// The figures `reached-<case>`, one for each case, and the table `reached`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let kinds = kinds(&study.runs);
    let accuracies = natural_maps(&study.runs);
    let labels = unique(study.runs.iter().map(RunRow::own_label));
    let mut all = Vec::new();
    for kind in &kinds {
        for label in &labels {
            all.extend(accuracies.iter().filter_map(|accuracy| reached(kind, label, *accuracy)));
        }
    }
    let mut parts = Vec::new();
    for case in unique(kinds.iter().map(|kind| kind.case.as_str())) {
        let of_case: Vec<&Kind> = kinds.iter().filter(|kind| kind.case == case).collect();
        let name = format!("reached-{}", file_name(case));
        parts.push(Part::figure(name, figure(&of_case, &all, (&labels, &accuracies))));
    }
    let note = "\nReached: the natural map is at most the accuracy and stays below ten times that. Sweeps: counted work there, median over the \
                problems, where the method's work is counted. Solved: problems of which the collection has a certified solution, of those \
                whose status is known.\n";
    parts.push(Part::table("reached", table(&all), note));
    parts
}

/// Counts how often a method reaches an accuracy on problems of a kind; `None` where it has no run.
fn reached<'k>(kind: &'k Kind<'k>, label: &str, accuracy: f64) -> Option<Reached<'k>> {
    let made = |run: &&&RunRow| run.own_label() == label && run.status != Ending::Skipped;
    let runs: Vec<&RunRow> = kind.runs.iter().filter(made).copied().collect();
    let is_there = |run: &&&RunRow| {
        let values = run.curve.iter().map(|point| point.get(Measure::NaturalMap).unwrap_or(f64::NAN));
        results::reached(values, accuracy).is_some()
    };
    let work = |run: &&RunRow| COSTS[1].to(run, Measure::NaturalMap, accuracy);
    (!runs.is_empty()).then(|| Reached {
        kind,
        method: label.to_owned(),
        accuracy,
        problems: runs.len(),
        reached: runs.iter().filter(is_there).count(),
        sweeps: Median::of(runs.iter().filter_map(work).collect()),
    })
}

/// A row for each kind and size, a column for each method, in it the accuracies from left to right.
fn figure(kinds: &[&Kind], all: &[Reached], (labels, accuracies): (&[String], &[f64])) -> String {
    let names: Vec<String> = kinds
        .iter()
        .map(|kind| format!("{}, {}", kind.name, counted(kind.grains as usize, "grain")))
        .collect();
    let packings: Vec<String> = kinds.iter().map(|kind| counted(kind.problems(), "packing")).collect();
    let cell = |of: &Reached| match of.reached {
        0 => NONE,
        reached if reached == of.problems => ALL,
        _ => SOME,
    };
    let tiles: &dyn Fn(usize, usize) -> Vec<Option<Tile>> = &|row, column| {
        let here = |of: &&Reached| std::ptr::eq(of.kind, kinds[row]) && of.method == labels[column];
        let cells: Vec<Cell> = all.iter().filter(here).map(cell).collect();
        vec![(!cells.is_empty()).then_some(Tile { cells, marks: [false, false] })]
    };
    let accuracies: Vec<String> = accuracies.iter().map(|accuracy| accuracy_text(*accuracy)).collect();
    let meant = [(ALL, "on all packings"), (SOME, "on some"), (NONE, "on none")];
    Grid {
        title: format!(
            "{}: which methods come to a natural map of {}, from left to right",
            kinds[0].case,
            accuracies.join(", ")
        ),
        notes: Vec::new(),
        rows: names
            .iter()
            .zip(&packings)
            .map(|(name, packings)| (name.as_str(), packings.as_str()))
            .collect(),
        height: SIZE[0],
        widest: SIZE[1],
        columns: (1..)
            .zip(labels)
            .map(|(k, label): (u32, _)| Head { short: k.to_string(), long: Some(label.clone()) })
            .collect(),
        cells: meant.into_iter().map(|(cell, meaning)| (cell, meaning.to_owned())).collect(),
        marks: ["", ""],
        tiles,
    }
    .svg()
}

fn table(all: &[Reached]) -> DataFrame {
    let number = |of: &dyn Fn(&Reached) -> usize| all.iter().map(|one| of(one) as u64).collect::<Vec<_>>();
    let sweeps =
        |of: fn(&Median) -> f64| all.iter().map(|one| one.sweeps.as_ref().map(of)).collect::<Vec<_>>();
    frame(df!(
        "case" => all.iter().map(|one| one.kind.case.as_str()).collect::<Vec<_>>(),
        "kind" => all.iter().map(|one| one.kind.name.as_str()).collect::<Vec<_>>(),
        "grains" => all.iter().map(|one| one.kind.grains).collect::<Vec<_>>(),
        "method" => all.iter().map(|one| one.method.as_str()).collect::<Vec<_>>(),
        "natural_map" => all.iter().map(|one| one.accuracy).collect::<Vec<_>>(),
        "problems" => number(&|one| one.problems),
        "reached" => number(&|one| one.reached),
        "solved" => number(&|one| known(one.kind, &["certified", "several", "solved"])),
        "open" => number(&|one| known(one.kind, &["open"])),
        "sweeps" => sweeps(|of| of.median),
        "sweeps_low" => sweeps(|of| of.low),
        "sweeps_high" => sweeps(|of| of.high),
    ))
}

/// Number of problems of a kind whose status in the collection is one of `statuses`.
fn known(kind: &Kind, statuses: &[&str]) -> usize {
    let has = |run: &&&RunRow| {
        run.problem_settings
            .get(KNOWN)
            .and_then(|known| known.as_str())
            .is_some_and(|known| statuses.contains(&known))
    };
    unique(kind.runs.iter().filter(has).map(|run| run.problem.as_str())).len()
}

#[cfg(test)]
mod tests;
