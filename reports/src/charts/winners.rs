//! The fastest method of each kind of problem, size and accuracy, with ties.

use std::collections::BTreeMap;

use polars::df;
use polars::prelude::DataFrame;

use super::grid::{Grid, Head, Tile};
use crate::draw::{Cell, ColorScale, INK, Looks, RGBColor, WHITE};
use crate::read::{
    Problems, Ranked, RunRow, Standing, Tally, accuracy_text, counted, file_name, kinds, natural_maps,
    number, ranked, repeats, span, tallies, unique,
};
use crate::text::{Part, frame, too_many};

/// Height of a row (mm).
const ROW: f64 = 7.0;
/// Greatest width of a column (mm): four accuracies, three methods that tie in each, with their letters.
const WIDEST: f64 = 34.0;

/// Signs of methods, in the order of the study.
const LETTERS: [&str; 16] = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "m", "n", "o", "p", "q"];
/// Number of methods that tie at most and are told apart.
const TOLD_APART: usize = 4;
const MORE: Cell = Cell { fill: RGBColor(225, 225, 225), letter: "≈", ink: INK };
const NONE: Cell = Cell { fill: WHITE, letter: "–", ink: INK };

/// The figures `winners-<case>`, one for each case, and the tables `winners-counts` and `winners`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let kinds = kinds(&study.runs);
    let accuracies = natural_maps(&study.runs);
    let ranked = ranked(&kinds, &accuracies);
    let labels = unique(study.runs.iter().map(RunRow::own_label));
    let note = format!(
        "\nThe natural map is at most the accuracy and stays below ten times that. First: the method that reaches it on most problems of \
         the kind, and of those the one whose median ratio to the fastest of each problem is least. Ties: those that reach it on as many, \
         and of which no difference shows: an interval of at least 90 % of the median over the problems of how much slower they are, \
         less the intervals of both times, does not lie above 1; each with its median ratio to the fastest. Of up to seven problems a method \
         must be slower on each by more than both intervals allow. Seconds: median over the problems, and its interval. {}\n",
        repeats(&study.runs)
    );
    let mut parts = Vec::new();
    match signs(&study.runs, &labels) {
        None => parts.push(too_many("winners-maps", "fastest methods", labels.len())),
        Some(signs) => {
            for case in unique(kinds.iter().map(|kind| kind.case.as_str())) {
                let of_case: Vec<&Ranked> = ranked.iter().filter(|ranked| ranked.kind.case == case).collect();
                let name = format!("winners-{}", file_name(case));
                parts.push(Part::figure(name, figure(&of_case, &accuracies, &signs)));
            }
        }
    }
    let tally = "\nFirst: number of kinds of problem, sizes apart, in which the method is first or ties, alone: in which none ties; of those that \
                 some method solves. Reached: number of problems. Worst: seconds over those of the fastest method of a problem, at most.\n";
    let tallies = tallies(&ranked, &labels, &accuracies);
    parts.push(Part::table("winners-counts", counts(&tallies), tally));
    parts.push(Part::table("winners", table(&ranked), note));
    parts
}

/// Signs of methods with their settings.
type Signs = [(String, Cell)];

/// Letters of the methods `labels` in the order of the study, the settings of a method in shades of its colour; `None` of more methods
/// than there are letters.
fn signs(runs: &[RunRow], labels: &[String]) -> Option<Vec<(String, Cell)>> {
    let looks = Looks::new(runs);
    let mut of_method: BTreeMap<&str, usize> = BTreeMap::new();
    let sign = |(label, letter): (&String, &'static str)| {
        let run = runs.iter().find(|run| run.own_label() == *label)?;
        let place = of_method.entry(&run.method).or_default();
        let fill = looks.variant(&run.method, *place).pen.color;
        *place += 1;
        Some((label.clone(), Cell { fill, letter, ink: ColorScale::ink_on(fill) }))
    };
    (labels.len() <= LETTERS.len()).then(|| labels.iter().zip(LETTERS).filter_map(sign).collect())
}

/// A row for each kind, a column for each size, in it the accuracies from left to right.
fn figure(ranked: &[&Ranked], accuracies: &[f64], signs: &Signs) -> String {
    let sign = |standing: &&Standing| {
        signs.iter().find(|(label, _)| *label == standing.label).map(|(_, cell)| *cell)
    };
    let names = unique(ranked.iter().map(|ranked| ranked.kind.name.as_str()));
    let sizes = unique(ranked.iter().map(|ranked| ranked.kind.grains));
    let samples = |name: &str| {
        let of = ranked.iter().filter(|ranked| ranked.kind.name == name).map(|ranked| ranked.kind.problems());
        match span(of.map(|problems| problems as f64)) {
            Some((least, most)) if least == most => counted(least as usize, "packing"),
            Some((least, most)) => format!("{least} to {most} packings"),
            None => String::new(),
        }
    };
    let samples: Vec<String> = names.iter().map(|name| samples(name)).collect();
    let tile = |ranked: &Ranked| {
        let ties: Vec<&Standing> = ranked.standings.iter().filter(|standing| standing.ties).collect();
        let is_on_some = ties.first().is_some_and(|first| first.reached < ranked.kind.problems());
        let cells = match ties.len() {
            0 => vec![NONE],
            number if number <= TOLD_APART => ties.iter().filter_map(sign).collect(),
            _ => vec![MORE],
        };
        Tile { cells, marks: [is_on_some, false] }
    };
    let tiles: &dyn Fn(usize, usize) -> Vec<Option<Tile>> = &|row, column| {
        let here = |ranked: &&&Ranked| ranked.kind.name == names[row] && ranked.kind.grains == sizes[column];
        ranked.iter().filter(here).map(|ranked| Some(tile(ranked))).collect()
    };
    let all: Vec<String> = accuracies.iter().map(|accuracy| accuracy_text(*accuracy)).collect();
    let key =
        [(MORE, format!("more than {TOLD_APART} methods tie")), (NONE, "no method reaches it".to_owned())];
    Grid {
        title: format!(
            "{}: fastest to a natural map of {}, from left to right; ties share a field",
            ranked[0].kind.case,
            all.join(", ")
        ),
        notes: Vec::new(),
        rows: names.iter().zip(&samples).map(|(name, samples)| (*name, samples.as_str())).collect(),
        height: ROW,
        widest: WIDEST,
        columns: sizes
            .iter()
            .map(|grains| Head { short: counted(*grains as usize, "grain"), long: None })
            .collect(),
        cells: signs.iter().map(|(label, cell)| (*cell, label.clone())).chain(key).collect(),
        marks: ["on some of the packings alone", ""],
        tiles,
    }
    .svg()
}

fn counts(tallies: &[Tally]) -> DataFrame {
    let number = |of: fn(&Tally) -> usize| tallies.iter().map(|tally| of(tally) as u64).collect::<Vec<_>>();
    frame(df!(
        "natural_map" => tallies.iter().map(|tally| tally.accuracy).collect::<Vec<_>>(),
        "method" => tallies.iter().map(|tally| tally.label.as_str()).collect::<Vec<_>>(),
        "kinds" => number(|tally| tally.kinds),
        "first" => number(|tally| tally.first),
        "alone" => number(|tally| tally.alone),
        "problems" => number(|tally| tally.problems),
        "reached" => number(|tally| tally.reached),
        "worst" => tallies.iter().map(|tally| Some(tally.worst).filter(|_| tally.reached > 0)).collect::<Vec<_>>(),
    ))
}

fn table(ranked: &[Ranked]) -> DataFrame {
    let column = |of: fn(&Ranked) -> Option<f64>| ranked.iter().map(of).collect::<Vec<_>>();
    let ties = |ranked: &Ranked| {
        let ties = ranked.standings.iter().skip(1).filter(|standing| standing.ties);
        let named = |standing: &Standing| format!("{} ×{}", standing.label, number(standing.ratio, 2));
        ties.map(named).collect::<Vec<_>>().join("; ")
    };
    frame(df!(
        "case" => ranked.iter().map(|ranked| ranked.kind.case.as_str()).collect::<Vec<_>>(),
        "kind" => ranked.iter().map(|ranked| ranked.kind.name.as_str()).collect::<Vec<_>>(),
        "grains" => ranked.iter().map(|ranked| ranked.kind.grains).collect::<Vec<_>>(),
        "problems" => ranked.iter().map(|ranked| ranked.kind.problems() as u64).collect::<Vec<_>>(),
        "natural_map" => ranked.iter().map(|ranked| ranked.accuracy).collect::<Vec<_>>(),
        "first" => ranked.iter().map(|ranked| ranked.standings.first().map(|first| first.label.as_str())).collect::<Vec<_>>(),
        "ties" => ranked.iter().map(ties).collect::<Vec<_>>(),
        "reached" => ranked.iter().map(|ranked| ranked.standings.first().map_or(0, |first| first.reached as u64)).collect::<Vec<_>>(),
        "seconds" => column(|ranked| Some(ranked.standings.first()?.seconds.median)),
        "seconds_low" => column(|ranked| Some(ranked.standings.first()?.seconds.low)),
        "seconds_high" => column(|ranked| Some(ranked.standings.first()?.seconds.high)),
    ))
}

#[cfg(test)]
mod tests;
