//! Two studies side by side, run by run: what has changed from one to the other.

use std::collections::BTreeMap;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{At, Curve, Guide, Looks, Panel, Plot, Scale, Side, TOLERANCE, Through};
use crate::read::{Problems, RunRow, counted, ending_text, unique};
use crate::text::{Part, frame};

/// Quantity that a panel compares: its name and its value for a run.
type Measure = (&'static str, fn(&RunRow) -> Option<f64>);

const MEASURES: [Measure; 2] =
    [("iterations", |run| Some(run.iterations as f64)), ("set-up and iterations (s)", RunRow::seconds)];

/// A run before and after.
type Pair<'r> = (&'r RunRow, &'r RunRow);

/// The figure and the table `against`.
pub(crate) fn parts(before: &Problems, after: &Problems) -> Vec<Part> {
    let (old, new) = (&before.runs, &after.runs);
    let key = |run: &RunRow| (run.problem.clone(), run.method.clone(), run.variant.clone());
    let known: BTreeMap<_, &RunRow> = old.iter().map(|run| (key(run), run)).collect();
    let pairs: Vec<Pair> = new.iter().filter_map(|run| Some((*known.get(&key(run))?, run))).collect();
    let looks = Looks::new(new);
    let note = "\nA ratio is after over before. Seconds compare if both studies come from one machine.\n";
    vec![
        Part::figure("against", figure(&pairs, &looks, (old.len(), new.len()))),
        Part::table("against", table(&pairs), note),
    ]
}

fn ratio((before, after): &Pair, of: fn(&RunRow) -> Option<f64>) -> Option<f64> {
    let both = before.has_converged() && after.has_converged();
    let (before, after) = (of(before)?, of(after)?);
    (both && before > 0.0).then_some(after / before)
}

fn figure(pairs: &[Pair], looks: &Looks, (before, after): (usize, usize)) -> String {
    let methods = unique(pairs.iter().map(|(_, after)| after.method.as_str()));
    let panel = |measure: &Measure| {
        let point = |pair: &&Pair| {
            ratio(pair, measure.1)?;
            Some((measure.1(pair.0)?.log10(), measure.1(pair.1)?.log10()))
        };
        let curve = |method: &&str| {
            let of_method = pairs.iter().filter(|(_, after)| after.method == *method);
            Curve::of(
                *method,
                looks.of_method(method).signed(),
                of_method.filter_map(|p| point(&p)),
                Through::Nothing,
            )
        };
        let (x, y) =
            (Side::new(Scale::Ten, "before"), Side::new(Scale::Ten, format!("after: {}", measure.0)));
        let same = Guide::new(At::Diagonal, TOLERANCE, "the same; below it less than before");
        Panel::new(x, y, methods.iter().map(curve).collect()).guided([same])
    };
    let [before, after] = [before, after].map(|count| counted(count, "run"));
    let title = format!(
        "{before} before, {after} after, {} in both; drawn are those that converged in both",
        pairs.len()
    );
    let panels = MEASURES.iter().map(panel).collect();
    Plot { title: vec![title], panels, ..Plot::default() }.svg()
}

fn table(pairs: &[Pair]) -> DataFrame {
    let of_both = |i: usize| pairs.iter().map(|pair| ratio(pair, MEASURES[i].1)).collect::<Vec<_>>();
    frame(df!(
        "problem" => pairs.iter().map(|(_, run)| run.problem.as_str()).collect::<Vec<_>>(),
        "method" => pairs.iter().map(|(_, run)| run.method.as_str()).collect::<Vec<_>>(),
        "variant" => pairs.iter().map(|(_, run)| run.variant.as_str()).collect::<Vec<_>>(),
        "ended_before" => pairs.iter().map(|(run, _)| ending_text(run.status)).collect::<Vec<_>>(),
        "ended_after" => pairs.iter().map(|(_, run)| ending_text(run.status)).collect::<Vec<_>>(),
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
