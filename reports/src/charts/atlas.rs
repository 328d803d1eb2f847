//! The atlas of stability: where each method converges, is slow, stalls, diverges or lies, and why where a reason is known.

mod cause;
mod class;
mod grid;
mod hazard;
mod table;
#[cfg(test)]
mod tests;
mod words;

use crate::read::{Problems, RunRow, Verdicts, file_name, unique};
use crate::text::Part;
use class::{Class, zeta_lies};
use grid::{Column, Grid};
use hazard::{Hazard, hazards};

/// A run with its class.
pub(crate) struct Judged<'r> {
    pub(crate) run: &'r RunRow,
    pub(crate) class: Class,
    /// True where ζ met the tolerance far from the solution on the way.
    pub(crate) zeta_lies: bool,
}

/// A method with its settings, in the order of the study.
pub(crate) struct Kind<'r> {
    pub(crate) method: &'r str,
    pub(crate) variants: Vec<&'r str>,
}

impl Kind<'_> {
    /// A variant by what tells it from the first of its method; the first in full.
    pub(crate) fn label(&self, variant: &str) -> String {
        let first: Vec<&str> = self.variants.first().iter().flat_map(|first| first.split(' ')).collect();
        let own: Vec<&str> = variant.split(' ').filter(|word| !first.contains(word)).collect();
        if own.is_empty() { setting(variant) } else { own.join(" ") }
    }
}

/// `atlas`, every method on every hazard; `atlas-<method>`, every setting of a method; `atlas-found` in words; the tables
/// `atlas-counts`, and `atlas` with every run.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = &study.runs;
    let verdicts = Verdicts::of(runs);
    let judged: Vec<Judged> = runs
        .iter()
        .map(|run| {
            let class = match Class::of(run) {
                // Another run, or the reference, has a solution.
                Class::Infeasible if !verdicts.is_proof(run) => Class::Failed,
                class => class,
            };
            Judged { run, class, zeta_lies: zeta_lies(run) }
        })
        .collect();
    let (hazards, kinds) = (hazards(runs), kinds(runs));
    let mut parts = Vec::new();
    if !judged.is_empty() {
        parts.push(Part::figure("atlas", matrix(&judged, &hazards, &kinds)));
    }
    for kind in kinds.iter().filter(|kind| kind.variants.len() > 1) {
        parts.push(Part::figure(format!("atlas-{}", file_name(kind.method)), map(&judged, &hazards, kind)));
    }
    parts.push(Part::text("atlas-found", words::text(&judged, &hazards, &kinds)));
    parts.push(Part::table("atlas-counts", table::counts(&judged, &kinds), words::RULE));
    parts.push(Part::table("atlas", table::runs(&judged, &hazards), ""));
    parts
}

fn kinds(runs: &[RunRow]) -> Vec<Kind<'_>> {
    let of = |method| {
        let runs = runs.iter().filter(|run| run.method == method);
        Kind { method, variants: unique(runs.map(|run| run.words.as_str())) }
    };
    unique(runs.iter().map(|run| run.method.as_str())).into_iter().map(of).collect()
}

/// The run of a method with a setting on a problem.
pub(crate) fn find<'j, 'r>(
    judged: &'j [Judged<'r>],
    method: &str,
    variant: &str,
    problem: &str,
) -> Option<&'j Judged<'r>> {
    judged.iter().find(|j| j.run.problem == problem && j.run.method == method && j.run.words == variant)
}

/// Each method by the first of its settings in the plan, with a ring where another one mends it.
fn matrix(judged: &[Judged], hazards: &[Hazard], kinds: &[Kind]) -> String {
    let first = |kind: &Kind| kind.variants.first().copied().unwrap_or_default().to_owned();
    let columns = kinds.iter().map(|kind| Column { head: kind.method.to_owned(), entry: None }).collect();
    let key = kinds.iter().filter(|kind| kind.variants.len() > 1);
    let shown: Vec<String> = key.map(|kind| format!("{}: {}", kind.method, setting(&first(kind)))).collect();
    Grid {
        title: "Every method, by the first of its settings in the plan".to_owned(),
        notes: shown,
        columns,
        hazards,
        cell: &|column, problem| {
            let kind = &kinds[column];
            let found = find(judged, kind.method, kind.variants.first().copied()?, problem)?;
            let others = || kind.variants.iter().filter_map(|v| find(judged, kind.method, v, problem));
            let cured = !found.class.is_good() && others().any(|other| other.class.is_good());
            Some((found, cured))
        },
    }
    .draw()
}

/// Every setting of one method.
fn map(judged: &[Judged], hazards: &[Hazard], kind: &Kind) -> String {
    let column =
        |(i, variant): (usize, &&str)| Column { head: (i + 1).to_string(), entry: Some(setting(variant)) };
    Grid {
        title: format!("{}, every setting in the plan", kind.method),
        notes: Vec::new(),
        columns: kind.variants.iter().enumerate().map(column).collect(),
        hazards,
        cell: &|column, problem| Some((find(judged, kind.method, kind.variants[column], problem)?, false)),
    }
    .draw()
}

/// A variant as it is read: one without words has the method's defaults.
pub(crate) fn setting(variant: &str) -> String {
    if variant.is_empty() { "default".to_owned() } else { variant.to_owned() }
}
