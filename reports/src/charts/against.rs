//! Two studies side by side, run by run: what has changed from one to the other.

use std::collections::BTreeMap;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{Canvas, INSIDE, Legend, Looks, Room, Scale, Sign, TOLERANCE, draw_empty, row};
use crate::read::{Problems, RunRow, counted, median, number, padded, unique};
use crate::text::{Part, frame};

/// Quantity that a panel compares: its name and its value for a run.
type Measure = (&'static str, fn(&RunRow) -> Option<f64>);

const MEASURES: [Measure; 2] =
    [("iterations", |run| Some(run.iterations as f64)), ("set-up and iterations (s)", RunRow::seconds)];

/// A run before and after.
type Pair<'r> = (&'r RunRow, &'r RunRow);

/// The figure and the table `against`, and the sentences `against-found`.
pub(crate) fn parts(before: &Problems, after: &Problems) -> Vec<Part> {
    let (old, new) = (&before.runs, &after.runs);
    let key = |run: &RunRow| (run.problem.clone(), run.method.clone(), run.variant.clone());
    let known: BTreeMap<_, &RunRow> = old.iter().map(|run| (key(run), run)).collect();
    let pairs: Vec<Pair> = new.iter().filter_map(|run| Some((*known.get(&key(run))?, run))).collect();
    let looks = Looks::new(new);
    let text = sentences(&pairs, old.len(), new.len());
    let note = "\nA ratio is after over before. Seconds compare if both studies come from one machine.\n";
    vec![
        Part::text("against-found", text),
        Part::figure("against", figure(&pairs, &looks)),
        Part::table("against", table(&pairs), note),
    ]
}

fn ratio((before, after): &Pair, of: fn(&RunRow) -> Option<f64>) -> Option<f64> {
    let both = before.has_converged() && after.has_converged();
    let (before, after) = (of(before)?, of(after)?);
    (both && before > 0.0).then_some(after / before)
}

fn sentences(pairs: &[Pair], before: usize, after: usize) -> String {
    let ratios = |(_, of): Measure| pairs.iter().filter_map(|pair| ratio(pair, of)).collect::<Vec<f64>>();
    let [iterations, seconds] = MEASURES.map(ratios);
    let count = |of: fn(f64) -> bool| iterations.iter().filter(|ratio| of(**ratio)).count();
    let mut text = format!(
        "{} before, {} after, {} in both. Of those that converged in both, {} made as many iterations, {} fewer, {} more.\n",
        counted(before, "run"),
        counted(after, "run"),
        pairs.len(),
        count(|ratio| ratio == 1.0),
        count(|ratio| ratio < 1.0),
        count(|ratio| ratio > 1.0),
    );
    if let Some(median) = median(seconds) {
        text.extend(["The median of their seconds, after over before, is ", &number(median, 3), ".\n"]);
    }
    for (before, after) in pairs.iter().filter(|(before, after)| before.ending != after.ending) {
        let run = format!("{}: {} {}", after.problem, after.method, after.variant);
        let (was, is) = (before.ending.text(), after.ending.text());
        text.extend([run.trim_end(), " ended with ", was, " before, with ", is, " after.\n"]);
    }
    text
}

fn figure(pairs: &[Pair], looks: &Looks) -> String {
    let methods = unique(pairs.iter().map(|(_, after)| after.method.as_str()));
    let sign = |method: &&str| {
        let look = looks.of_method(method).signed();
        (Sign::Mark(look.mark, look.pen), (*method).to_owned())
    };
    let mut signs: Vec<(Sign, String)> = methods.iter().map(sign).collect();
    signs.push((Sign::Line(TOLERANCE), "the same; below it less than before".to_owned()));
    let legend = Legend::new(Vec::new(), signs, INSIDE);
    let title =
        format!("{} in both studies; those that converged in both are drawn", counted(pairs.len(), "run"));
    row(&[title], MEASURES.len(), &legend, |canvas, i, room| panel(canvas, pairs, looks, &MEASURES[i], room))
}

/// The run after, and its logarithms before and after.
fn point<'r>(pair: &Pair<'r>, measure: &Measure) -> Option<(&'r RunRow, (f64, f64))> {
    ratio(pair, measure.1)?;
    let (x, y) = ((measure.1)(pair.0)?.log10(), (measure.1)(pair.1)?.log10());
    (x.is_finite() && y.is_finite()).then_some((pair.1, (x, y)))
}

fn panel(canvas: &Canvas, pairs: &[Pair], looks: &Looks, measure: &Measure, room: Room) {
    let points: Vec<(&RunRow, (f64, f64))> = pairs.iter().filter_map(|pair| point(pair, measure)).collect();
    let range = padded(points.iter().flat_map(|(_, (x, y))| [*x, *y]), 0.08);
    let name = format!("after: {}", measure.0);
    let frame = room.frame(canvas, (Scale::Ten, range, "before"), (Scale::Ten, range, &name));
    frame.draw_diagonal(canvas);
    for (run, place) in &points {
        let look = looks.of_method(&run.method).signed();
        canvas.mark(look.mark, frame.place(*place), look.pen);
    }
    if points.is_empty() {
        draw_empty(canvas, &frame);
    }
}

fn table(pairs: &[Pair]) -> DataFrame {
    let of_both = |i: usize| pairs.iter().map(|pair| ratio(pair, MEASURES[i].1)).collect::<Vec<_>>();
    frame(df!(
        "problem" => pairs.iter().map(|(_, run)| run.problem.as_str()).collect::<Vec<_>>(),
        "method" => pairs.iter().map(|(_, run)| run.method.as_str()).collect::<Vec<_>>(),
        "variant" => pairs.iter().map(|(_, run)| run.variant.as_str()).collect::<Vec<_>>(),
        "ended_before" => pairs.iter().map(|(run, _)| run.ending.text()).collect::<Vec<_>>(),
        "ended_after" => pairs.iter().map(|(_, run)| run.ending.text()).collect::<Vec<_>>(),
        "iterations_before" => pairs.iter().map(|(run, _)| run.iterations).collect::<Vec<_>>(),
        "iterations_after" => pairs.iter().map(|(_, run)| run.iterations).collect::<Vec<_>>(),
        "iterations_ratio" => of_both(0),
        "seconds_before" => pairs.iter().map(|(run, _)| run.seconds()).collect::<Vec<_>>(),
        "seconds_after" => pairs.iter().map(|(_, run)| run.seconds()).collect::<Vec<_>>(),
        "seconds_ratio" => of_both(1),
    ))
}

#[cfg(test)]
mod tests;
