//! Cost against the number of grains, with the exponents of fitted powers.

use std::collections::BTreeSet;

use polars::df;
use polars::prelude::DataFrame;

use super::subdomains::Panel;
use crate::draw::{
    Canvas, Frame, HPos, INSIDE, Legend, MOST_LINES, Points, Room, Scale, Series, TICK_TEXT, TOLERANCE, VPos,
    draw_empty, draw_signs, endings, key, reach, row, series,
};
use crate::read::{
    Ending, Problems, RunRow, Verdicts, WORK, counted, distinct, problems, slope, span, stopped_at_1e_2,
};
use crate::text::{Part, frame, nothing, too_many};

fn costs() -> [Panel; 4] {
    [
        Panel::iterations_to_1e_2(),
        Panel::iterations(),
        Panel::new("set-up and iterations (s)", |_, run| run.seconds()),
        Panel::new("counted work (sweeps)", |_, run| run.curve.last()?.work(run)),
    ]
}

/// Fewer sizes than this have no exponent: through two points every power fits.
const SIZES: usize = 3;

/// Slopes to compare with, as powers of the number of grains n.
const SLOPES: [(f64, &str); 2] = [(0.5, "∝ √n"), (1.0, "∝ n")];
/// The part of a panel's height that is left to them.
const BELOW: f64 = 0.2;

/// The figure `size`, and the table with the exponents.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = &study.runs;
    let mut all = series(runs, &[]);
    for series in &mut all {
        series.runs.retain(|run| run.ending != Ending::Skipped);
    }
    let table = table(runs, &all);
    let note = format!(
        "\nCost = a · grains^exponent, least squares in logarithms over the runs that converged, or reached 10⁻² on their \
         way; none on fewer than {SIZES} sizes. {WORK}\n"
    );
    vec![figure(runs, &all), Part::table("size", table, note)]
}

fn points(series: &Series, cost: &Panel) -> Points {
    cost.points(series, |run| f64::from(run.grains))
}

fn converged(points: &Points) -> Vec<(f64, f64)> {
    points.iter().filter(|(ending, _)| *ending == Ending::Converged).map(|(_, point)| *point).collect()
}

/// The exponent over sizes that are enough.
fn exponent(series: &Series, cost: &Panel) -> Option<f64> {
    let points = converged(&points(series, cost));
    let sizes = distinct(points.iter().map(|point| point.0));
    slope(&points).filter(|_| sizes >= SIZES)
}

fn figure(runs: &[RunRow], all: &[Series]) -> Part {
    if all.len() > MOST_LINES {
        return too_many("size-found", "size", all.len());
    }
    let sizes: BTreeSet<u32> = all.iter().flat_map(|series| &series.runs).map(|run| run.grains).collect();
    if sizes.len() < 2 {
        let same = sizes
            .first()
            .map_or("no run".to_owned(), |n| format!("every problem has {}", counted(*n as usize, "grain")));
        return nothing("size-found", "size", &format!("{same}, and cost has nothing to grow with"));
    }
    let all_costs = costs();
    let has_points = |cost: &Panel| all.iter().any(|series| !points(series, cost).is_empty());
    let mut costs: Vec<&Panel> =
        all_costs.iter().filter(|cost| !(cost.on_the_way && stopped_at_1e_2(runs))).collect();
    // What no run has takes no room, unless none has anything.
    if costs.iter().any(|cost| has_points(cost)) {
        costs.retain(|cost| has_points(cost));
    }
    // By panel, then by series.
    let clouds: Vec<Vec<Points>> =
        costs.iter().map(|cost| all.iter().map(|series| points(series, cost)).collect()).collect();
    let fitted = all.iter().any(|series| costs.iter().any(|cost| exponent(series, cost).is_some()));
    let label = |series: &Series| {
        let text = |cost: &&Panel| {
            let rounded = exponent(series, cost).map_or("–".to_owned(), |e| format!("{e:.2}"));
            rounded.replace("-0.00", "0.00").replace('-', "−")
        };
        let exponents: Vec<String> = costs.iter().map(text).collect();
        series.label() + &if fitted { format!(" ({})", exponents.join(", ")) } else { String::new() }
    };
    let keyed = all.iter().enumerate().map(|(i, series)| {
        let of_series = clouds.iter().map(|clouds| &clouds[i]).collect();
        (label(series), series.look, of_series, false)
    });
    let (entries, mut signs) = key(keyed);
    let shown = || all.iter().flat_map(|series| &series.runs);
    signs.extend(endings(shown().map(|run| run.ending).filter(|ending| *ending != Ending::Converged)));
    let legend = Legend::new(entries, signs, INSIDE);
    let counts = format!(
        "{}, {}, {} of grains, n",
        counted(problems(runs).len(), "problem"),
        counted(shown().count(), "run"),
        counted(sizes.len(), "number"),
    );
    let lines = if fitted {
        format!(
            "In brackets the exponents of the powers fitted to {SIZES} sizes or more, in the order of the panels."
        )
    } else {
        format!("Lines join the means of the sizes; an exponent needs {SIZES}.")
    };
    let svg = row(&[counts, lines], costs.len(), &legend, |canvas, i, room| {
        panel(canvas, all, costs[i], &clouds[i], room);
    });
    Part::figure("size", svg)
}

fn panel(canvas: &Canvas, all: &[Series], cost: &Panel, clouds: &[Points], room: Room) {
    let (low, high) = reach(clouds.iter().flatten(), |point| point.1);
    let x = reach(clouds.iter().flatten(), |point| point.0);
    let y = (low - BELOW / (1.0 - BELOW) * (high - low), high);
    let frame = room.frame(canvas, (Scale::Ten, x, "grains"), (Scale::Ten, y, &cost.title));
    if clouds.iter().all(Vec::is_empty) {
        return draw_empty(canvas, &frame);
    }
    draw_slopes(canvas, &frame);
    for (series, cloud) in all.iter().zip(clouds) {
        let fit = fit(&converged(cloud)).map(|line| line.map(|point| frame.place(point)));
        canvas.line(fit.as_ref().map_or(&[], |line| line.as_slice()), series.look.pen);
    }
    let signs: Vec<_> =
        all.iter().zip(clouds).map(|(series, cloud)| (series.look, cloud.as_slice())).collect();
    draw_signs(canvas, &frame, &signs);
}

/// The slopes to compare with, from one place below the costs.
fn draw_slopes(canvas: &Canvas, frame: &Frame) {
    let (wide, high) = (frame.x.high - frame.x.low, frame.y.high - frame.y.low);
    let from = (frame.x.low + 0.4 * wide, frame.y.low + 0.03 * high);
    for ((slope, text), lower) in SLOPES.into_iter().zip([1.2, -1.2]) {
        let run = (0.3 * wide).min(0.8 * BELOW * high / slope);
        let to = frame.place((from.0 + run, from.1 + slope * run));
        canvas.line(&[frame.place(from), to], TOLERANCE);
        canvas.text(text, (to.0 + 0.6, to.1 + lower), TICK_TEXT, (HPos::Left, VPos::Center));
    }
}

/// Ends of the fitted line over the sizes that there are; of two sizes it joins the means.
fn fit(points: &[(f64, f64)]) -> Option<[(f64, f64); 2]> {
    let slope = slope(points)?;
    let (low, high) = span(points.iter().map(|point| point.0))?;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    Some([low, high].map(|at| (at, y + slope * (at - x))))
}

fn table(runs: &[RunRow], all: &[Series]) -> DataFrame {
    let exponents = |i: usize| all.iter().map(|s| exponent(s, &costs()[i])).collect::<Vec<_>>();
    let verdicts = Verdicts::of(runs);
    let failed = |series: &Series| series.runs.iter().filter(|run| !verdicts.is_right(run)).count() as u64;
    frame(df!(
        "method" => all.iter().map(Series::label).collect::<Vec<_>>(),
        "runs" => all.iter().map(|series| series.runs.len() as u64).collect::<Vec<_>>(),
        "failed" => all.iter().map(failed).collect::<Vec<_>>(),
        "to_natural_map_1e_2_exponent" => exponents(0),
        "iterations_exponent" => exponents(1),
        "seconds_exponent" => exponents(2),
        "work_exponent" => exponents(3),
    ))
}
