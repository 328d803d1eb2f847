//! Cost against the number of grains, with the exponents of fitted powers.

use polars::df;
use polars::prelude::DataFrame;
use results::store::Tables;
use std::collections::BTreeSet;

use crate::ReportError;
use crate::axis::{Axis, Frame};
use crate::canvas::Canvas;
use crate::cost::WORK;
use crate::ending::Ending;
use crate::legend::Legend;
use crate::number::counted;
use crate::panels::{INSIDE, MOST_LINES, Room, grid, nothing, too_many};
use crate::part::Part;
use crate::rows::{RunRow, problems, runs};
use crate::series::{Points, Series, draw_empty, draw_points, reach, reached, series};
use crate::signs::endings;
use crate::statistics::{slope, span};
use crate::study::Study;

/// A cost of a run, and what it is called.
struct Cost {
    title: &'static str,
    of: fn(&Study, &RunRow) -> Option<f64>,
    /// Whether it was reached however the run ended.
    on_the_way: bool,
}

const COSTS: [Cost; 4] = [
    Cost {
        title: "iterations to a natural map of 10⁻²",
        of: |_, run| run.to_natural_map_1e_2.map(|iterations| iterations as f64),
        on_the_way: true,
    },
    Cost {
        title: "iterations to the tolerance",
        of: |_, run| Some(run.iterations as f64),
        on_the_way: false,
    },
    Cost {
        title: "set-up and iterations (s)",
        of: |_, run| Some(run.setup_s? + run.iterating_s?),
        on_the_way: false,
    },
    Cost {
        title: "counted work (sweeps)",
        of: |study, run| study.curve(run).last()?.work(run),
        on_the_way: false,
    },
];

/// The figure `size`, and the table with the exponents.
pub(crate) fn parts(tables: &Tables) -> Result<Vec<Part>, ReportError> {
    let runs = runs(&tables.runs)?;
    let study = Study::of(&runs, tables)?;
    let mut all = series(&runs, &[]);
    for series in &mut all {
        series.runs.retain(|run| run.ending != Ending::Skipped);
    }
    let table = table(&study, &all)?;
    let note = format!(
        "\nCost = a · grains^exponent, least squares in logarithms over the runs that converged, or reached 10⁻² on their \
         way; none on one size. {WORK}\n"
    );
    Ok(vec![Part::figure("size", figure(&study, &all)?), Part::table("size", table, note)])
}

fn points(study: &Study, series: &Series, cost: &Cost) -> Points {
    let points = series.points(|run| f64::from(run.grains), |run| (cost.of)(study, run));
    if cost.on_the_way { reached(points) } else { points }
}

fn converged(points: &Points) -> Vec<(f64, f64)> {
    points.iter().filter(|(ending, _)| *ending == Ending::Converged).map(|(_, point)| *point).collect()
}

fn exponent(study: &Study, series: &Series, cost: &Cost) -> Option<f64> {
    slope(&converged(&points(study, series, cost)))
}

fn figure(study: &Study, all: &[Series]) -> Result<String, ReportError> {
    if all.len() > MOST_LINES {
        return too_many("size", all.len());
    }
    let sizes: BTreeSet<u32> = all.iter().flat_map(|series| &series.runs).map(|run| run.grains).collect();
    if let (Some(grains), 1) = (sizes.first(), sizes.len()) {
        let same = counted(*grains as usize, "grain");
        return nothing("size", &format!("every problem has {same}, and cost has nothing to grow with"));
    }
    let label = |series: &Series| {
        let exponents = COSTS.each_ref().map(|cost| {
            exponent(study, series, cost).map_or("–".to_owned(), |e| format!("{e:.2}").replace('-', "−"))
        });
        format!("{} ({})", series.label(), exponents.join(", "))
    };
    let shown = all.iter().flat_map(|series| &series.runs);
    let failures = shown.clone().map(|run| run.ending).filter(|ending| *ending != Ending::Converged);
    let entries = all.iter().map(|series| (label(series), series.look)).collect();
    let legend = Legend::new(entries, endings(failures), INSIDE)?;
    let title = format!(
        "{}, {}. In brackets the exponents of the fitted powers, in the order of the panels.",
        counted(problems(study.runs).len(), "problem"),
        counted(shown.count(), "run"),
    );
    grid(&[title], (2, 2), &legend, |canvas, i, room| panel(canvas, study, all, &COSTS[i], room))
}

fn panel(canvas: &Canvas, study: &Study, all: &[Series], cost: &Cost, room: Room) -> Result<(), ReportError> {
    let clouds: Vec<Points> = all.iter().map(|series| points(study, series, cost)).collect();
    let range = |of| reach(clouds.iter().flatten(), of);
    let frame = Frame {
        x: Axis::log(range(|point| point.0), room.left, room.right),
        y: Axis::log(range(|point| point.1), room.bottom, room.top),
    };
    frame.draw(canvas)?;
    frame.name(canvas, "grains", cost.title)?;
    for (series, cloud) in all.iter().zip(&clouds) {
        let fit = fit(&converged(cloud)).map(|line| line.map(|point| frame.place(point)));
        canvas.line(fit.as_ref().map_or(&[], |line| line.as_slice()), series.look.pen)?;
        draw_points(canvas, &frame, series.look, cloud)?;
    }
    if clouds.iter().all(Vec::is_empty) { draw_empty(canvas, &frame) } else { Ok(()) }
}

/// Ends of the fitted line over the sizes that there are.
fn fit(points: &[(f64, f64)]) -> Option<[(f64, f64); 2]> {
    let slope = slope(points)?;
    let (low, high) = span(points.iter().map(|point| point.0))?;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    Some([low, high].map(|at| (at, y + slope * (at - x))))
}

fn table(study: &Study, all: &[Series]) -> Result<DataFrame, ReportError> {
    let exponents = |i: usize| all.iter().map(|s| exponent(study, s, &COSTS[i])).collect::<Vec<_>>();
    let failed =
        |series: &Series| series.runs.iter().filter(|run| run.ending != Ending::Converged).count() as u64;
    Ok(df!(
        "method" => all.iter().map(Series::label).collect::<Vec<_>>(),
        "runs" => all.iter().map(|series| series.runs.len() as u64).collect::<Vec<_>>(),
        "failed" => all.iter().map(failed).collect::<Vec<_>>(),
        "to_natural_map_1e_2_exponent" => exponents(0),
        "iterations_exponent" => exponents(1),
        "seconds_exponent" => exponents(2),
        "work_exponent" => exponents(3),
    )?)
}
