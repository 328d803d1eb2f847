//! The tables of the charts against the truth: the first run to each accuracy, and the errors behind a small measure.

use contact::Measure;
use polars::df;
use polars::prelude::{Column, DataFrame};

use super::declared::{TRUTH, WORK_PRECISION};
use crate::draw::Lines;
use crate::read::{
    ACCURACIES, COSTS, Cost, Problems, RunRow, Sample, WORK, accuracy_text, number, problems, repeats, span,
};
use crate::text::{Part, frame};

/// The measures that every method can be stopped by.
const MEASURES: [(&str, Measure); 3] =
    [("ζ", Measure::Zeta), ("natural map", Measure::NaturalMap), ("quadratic norm", Measure::QuadDv)];
/// The value of a measure at which the table says what it is worth.
const WORTH: f64 = 1e-4;

/// The figures of a problem each, and the first to each accuracy.
pub(crate) fn work_precision(study: &Problems) -> Vec<Part> {
    let mut note = "\n".to_owned();
    for given in &study.given {
        if let Some(error) = given.end.velocity_error() {
            let (problem, code, error) = (&given.problem, &given.variant, number(error, 2));
            note.extend([
                problem,
                ": the impulses that ",
                code,
                " gave have a velocity error of ",
                &error,
                ".\n",
            ]);
        }
    }
    let first = " First in seconds: all whose intervals overlap that of the least; none where runs are repeated less than five times. ";
    note.extend(["\n", &*repeats(&study.runs), first, WORK, "\n"]);
    with_table(WORK_PRECISION.parts(study), "work-precision", study, (firsts, note))
}

/// The figures of a problem each, and the errors behind small measures.
pub(crate) fn truth(study: &Problems) -> Vec<Part> {
    let note =
        format!("\nVelocity errors where the measure is {} for the first time.\n", accuracy_text(WORTH));
    with_table(TRUTH.parts(study), "truth", study, (errors, note))
}

/// Rows of the problems whose truth is known.
type Table = fn(&Lines, &[&str]) -> DataFrame;

/// The parts with a table, which says where the truth is not known.
fn with_table(
    mut parts: Vec<Part>,
    name: &str,
    study: &Problems,
    (table, note): (Table, String),
) -> Vec<Part> {
    let lines = Lines::of(&study.runs);
    let (known, unknown): (Vec<&str>, Vec<&str>) =
        problems(&study.runs).into_iter().partition(|problem| lines.knows_truth(problem));
    let untold = unknown.iter().map(|problem| format!("\n{problem}: no velocity error in its rows.\n"));
    let note = note + &untold.collect::<String>();
    parts.push(Part::table(name, table(&lines, &known), note));
    parts
}

/// The first runs to each accuracy, in each cost, and the least cost.
fn firsts(study: &Lines, problems: &[&str]) -> DataFrame {
    let rows = || problems.iter().flat_map(|problem| ACCURACIES.map(|accuracy| (*problem, accuracy)));
    let first = |cost: &Cost, (problem, accuracy): (&str, f64)| {
        let runs = study.runs_of(problem);
        let least = runs
            .iter()
            .filter_map(|run| cost.to(run, Measure::VelocityError, accuracy))
            .min_by(f64::total_cmp);
        let first: Vec<String> =
            cost.least(&runs, Measure::VelocityError, accuracy).into_iter().map(RunRow::label).collect();
        ((!first.is_empty()).then(|| first.join("; ")), least)
    };
    let mut table = frame(df!(
        "problem" => rows().map(|(problem, _)| problem).collect::<Vec<_>>(),
        "velocity_error" => rows().map(|(_, accuracy)| accuracy).collect::<Vec<_>>(),
    ));
    for cost in &COSTS {
        let (who, prices): (Vec<_>, Vec<_>) = rows().map(|row| first(cost, row)).unzip();
        for column in [
            Column::new(format!("first_in_{}", cost.name).into(), who),
            Column::new(cost.name.into(), prices),
        ] {
            table = frame(table.hstack(&[column]));
        }
    }
    table
}

/// Between which velocity errors the runs are when a measure first comes down to [`WORTH`].
fn errors(study: &Lines, problems: &[&str]) -> DataFrame {
    let rows = || problems.iter().flat_map(|problem| MEASURES.map(|measure| (*problem, measure)));
    let of_row = |(problem, (_, measure)): (&str, (&str, Measure))| {
        let small =
            |point: &&Sample| point.iteration > 0 && point.get(measure).is_some_and(|value| value <= WORTH);
        let error = |run: &RunRow| run.curve.iter().find(small)?.velocity_error();
        study.runs_of(problem).into_iter().filter_map(error).collect::<Vec<_>>()
    };
    let end = |of: fn((f64, f64)) -> f64| {
        rows().map(|row| span(of_row(row).into_iter()).map(of)).collect::<Vec<_>>()
    };
    frame(df!(
        "problem" => rows().map(|(problem, _)| problem).collect::<Vec<_>>(),
        "measure" => rows().map(|(_, (short, _))| short).collect::<Vec<_>>(),
        "runs" => rows().map(|(problem, _)| study.runs_of(problem).len() as u64).collect::<Vec<_>>(),
        "runs_there" => rows().map(|row| of_row(row).len() as u64).collect::<Vec<_>>(),
        "least_velocity_error" => end(|span| span.0),
        "greatest_velocity_error" => end(|span| span.1),
    ))
}
