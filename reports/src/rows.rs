//! What the figures read of the stored tables, row by row.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use polars::prelude::{BooleanChunked, DataFrame};
use serde_json::{Map, Value};

use crate::ReportError;
use crate::columns::{counts, measures, newer, texts, u32s, u64s};
use crate::ending::Ending;
use crate::groups::differing;

/// A run, without its curve.
pub(crate) struct RunRow {
    pub(crate) run: u32,
    pub(crate) problem: String,
    /// What was set to make the problem.
    pub(crate) problem_settings: Map<String, Value>,
    pub(crate) grains: u32,
    pub(crate) contacts: u32,
    pub(crate) method: String,
    pub(crate) settings: Map<String, Value>,
    pub(crate) derived: Map<String, Value>,
    /// Empty in older studies.
    pub(crate) spectrum: Map<String, Value>,
    pub(crate) variant: String,
    /// The variant as it is read: a number or a truth value with the name of its setting.
    pub(crate) words: String,
    pub(crate) subdomains: u32,
    pub(crate) stop_on: String,
    pub(crate) tolerance: Option<f64>,
    pub(crate) max_iterations: u64,
    pub(crate) ending: Ending,
    /// Why it was skipped, if it was.
    pub(crate) reason: String,
    pub(crate) iterations: u64,
    pub(crate) to_natural_map_1e_2: Option<u64>,
    pub(crate) setup_s: Option<f64>,
    pub(crate) iterating_s: Option<f64>,
    /// At its end, where a certified solution is known.
    pub(crate) velocity_error: Option<f64>,
}

/// What is known of the problems beside a run's own word.
pub(crate) struct Verdicts<'r> {
    /// Problems that have a solution: a run converged, or the reference is certified.
    solved: BTreeSet<&'r str>,
}

impl<'r> Verdicts<'r> {
    pub(crate) fn of(runs: &'r [RunRow]) -> Self {
        let solved = |run: &&RunRow| run.ending == Ending::Converged || run.velocity_error.is_some();
        Self { solved: runs.iter().filter(solved).map(|run| run.problem.as_str()).collect() }
    }

    /// Whether a run proved that there is no solution, and nothing speaks against it.
    pub(crate) fn is_proof(&self, run: &RunRow) -> bool {
        run.ending == Ending::Infeasible && !self.solved.contains(run.problem.as_str())
    }

    /// Whether a run found what there is to find: the solution, or that there is none.
    pub(crate) fn is_right(&self, run: &RunRow) -> bool {
        run.ending == Ending::Converged || self.is_proof(run)
    }
}

impl RunRow {
    pub(crate) fn label(&self) -> String {
        // Such as a preconditioner that is none.
        let words = self.words.strip_prefix("none").unwrap_or(&self.words);
        label(&self.method, words.strip_prefix(", ").unwrap_or(words))
    }
}

/// Method and variant, as a key says them.
pub(crate) fn label(method: &str, variant: &str) -> String {
    match variant {
        "" => method.to_owned(),
        grid if grid.starts_with(|c: char| c.is_ascii_digit()) => format!("{method} {grid}"),
        words => format!("{method}, {words}"),
    }
}

/// A sample of a curve; `None` where the measure is undefined.
pub(crate) struct Point {
    pub(crate) iteration: u64,
    pub(crate) iterating_s: Option<f64>,
    pub(crate) zeta: Option<f64>,
    pub(crate) natural_map: Option<f64>,
    pub(crate) quad_dv: Option<f64>,
    pub(crate) velocity_error: Option<f64>,
    contact_updates: u64,
    delassus_products: u64,
    triangular_solve_entries: u64,
    factorisations: u64,
}

impl Point {
    /// Counted work in sweeps over `contacts`: a contact updated counts as much as a contact passed in a product W p, that
    /// is eight multiply-adds (two components of two grains, read and written back); an entry of a triangular factor is one.
    /// Factorisations are not in it: a run that makes more than a few, as many as directions that adapt take, has no counted
    /// work; nor has one that tells none after an iteration.
    pub(crate) fn work(&self, run: &RunRow) -> Option<f64> {
        let few = self.factorisations <= 6 * (u64::from(run.subdomains) + 1);
        let contacts = f64::from(run.contacts.max(1));
        let visits = self.contact_updates as f64 + contacts * self.delassus_products as f64;
        let work = visits + self.triangular_solve_entries as f64 / 8.0;
        (few && (work > 0.0 || self.iteration == 0)).then_some(work / contacts)
    }
}

/// Impulses that another code gave are no run.
const GIVEN: &str = "given";

/// The velocity errors of the impulses that other codes gave: problem, code, error.
pub(crate) fn given(table: &DataFrame) -> Result<Vec<(String, String, Option<f64>)>, ReportError> {
    let (problem, from) = (texts(table, "problem")?, texts(table, "variant")?);
    let (status, error) = (texts(table, "status")?, newer(table, "velocity_error")?);
    let rows = problem.into_iter().zip(from).zip(error).zip(status);
    let given = rows.filter(|(_, status)| status == GIVEN);
    Ok(given.map(|(((problem, from), error), _)| (problem, from, error)).collect())
}

/// How often the runs were made for their seconds, as a note says it.
pub(crate) fn repeats(table: &DataFrame) -> Result<String, ReportError> {
    let repeats = u32s(&made(table)?, "repeats")?;
    let (least, most) = (repeats.iter().min().unwrap_or(&1), repeats.iter().max().unwrap_or(&1));
    Ok(match (least, most) {
        (_, 1) => "One run each.".to_owned(),
        (least, most) if least == most => format!("Seconds: medians of {most} runs each."),
        (least, most) => format!("Seconds: medians of {least} to {most} runs each."),
    })
}

/// The rows of runs.
pub(crate) fn made(table: &DataFrame) -> Result<DataFrame, ReportError> {
    let is_run: BooleanChunked = texts(table, "status")?.iter().map(|status| status != GIVEN).collect();
    Ok(table.filter(&is_run)?)
}

pub(crate) fn runs(table: &DataFrame) -> Result<Vec<RunRow>, ReportError> {
    let table = &made(table)?;
    let (run, grains) = (u32s(table, "run")?, u32s(table, "grains")?);
    let (contacts, subdomains) = (u32s(table, "contacts")?, u32s(table, "subdomains")?);
    let (problem, method) = (texts(table, "problem")?, texts(table, "method")?);
    let (settings, derived) = (json(table, "settings")?, json(table, "derived")?);
    let problem_settings = json(table, "problem_settings")?;
    let older = table.column("spectrum").is_err();
    let spectrum = if older { vec![Map::new(); table.height()] } else { json(table, "spectrum")? };
    let (reason, max_iterations) = (texts(table, "reason")?, u64s(table, "max_iterations")?);
    let (variant, status) = (texts(table, "variant")?, texts(table, "status")?);
    let (stop_on, tolerance) = (texts(table, "stop_on")?, measures(table, "tolerance")?);
    let iterations = u64s(table, "iterations")?;
    let (setup_s, iterating_s) = (measures(table, "setup_s")?, measures(table, "iterating_s")?);
    let velocity_error = newer(table, "velocity_error")?;
    let to_natural_map_1e_2 = counts(table, "iterations_to_natural_map_1e_2")?;
    let differing = differing(method.iter().zip(&settings), &[]);
    let row = |i: usize| RunRow {
        run: run[i],
        problem: problem[i].clone(),
        problem_settings: problem_settings[i].clone(),
        grains: grains[i],
        contacts: contacts[i],
        method: method[i].clone(),
        settings: settings[i].clone(),
        derived: derived[i].clone(),
        spectrum: spectrum[i].clone(),
        variant: variant[i].clone(),
        words: words(&variant[i], (&method[i], &settings[i]), &differing),
        subdomains: subdomains[i],
        stop_on: stop_on[i].clone(),
        tolerance: tolerance[i],
        max_iterations: max_iterations[i],
        reason: reason[i].clone(),
        ending: Ending::of(&status[i]),
        iterations: iterations[i],
        to_natural_map_1e_2: to_natural_map_1e_2[i],
        setup_s: setup_s[i],
        iterating_s: iterating_s[i],
        velocity_error: velocity_error[i],
    };
    Ok((0..table.height()).map(row).collect())
}

/// A variant that is the value of one setting, such as `0.5` or `false`, says of which: `relaxation=0.5`, `no polish`.
fn words(
    variant: &str,
    (method, settings): (&str, &Map<String, Value>),
    differing: &BTreeSet<(String, String)>,
) -> String {
    let (value, start) = variant.find(',').map_or((variant, ""), |comma| variant.split_at(comma));
    let number = value.parse::<f64>().ok();
    let is = |of: &&Value| match of {
        Value::Bool(truth) => truth.to_string() == value,
        Value::Number(of) => number.is_some() && of.as_f64() == number,
        _ => false,
    };
    let keys = differing.iter().filter(|(of, _)| of == method).map(|(_, key)| key);
    let mut keys = keys.filter(|key| settings.get(*key).as_ref().is_some_and(is));
    match (keys.next(), keys.next()) {
        (Some(key), None) if value == "true" => format!("{key}{start}"),
        (Some(key), None) if value == "false" => format!("no {key}{start}"),
        (Some(key), None) => format!("{key}={value}{start}"),
        _ => variant.to_owned(),
    }
}

fn json(table: &DataFrame, column: &str) -> Result<Vec<Map<String, Value>>, ReportError> {
    let not_json = |row, source| ReportError::Json { column: column.to_owned(), row, source };
    let read = |(row, text): (usize, &String)| serde_json::from_str(text).map_err(|e| not_json(row, e));
    texts(table, column)?.iter().enumerate().map(read).collect()
}

/// Whether the tolerance of all runs is a natural map of 10⁻², which figures show beside tighter ones.
pub(crate) fn stopped_at_1e_2(runs: &[RunRow]) -> bool {
    runs.iter().all(|run| run.stop_on == "natural_map" && run.tolerance == Some(1e-2))
}

/// The problems in the order of the study.
pub(crate) fn problems(runs: &[RunRow]) -> Vec<&str> {
    let mut seen = HashSet::new();
    runs.iter().map(|run| run.problem.as_str()).filter(|problem| seen.insert(*problem)).collect()
}

/// The curves by run, each in the order of its iterations.
pub(crate) fn curves(table: &DataFrame) -> Result<BTreeMap<u32, Vec<Point>>, ReportError> {
    let (run, iteration) = (u32s(table, "run")?, u64s(table, "iteration")?);
    let (zeta, natural_map) = (measures(table, "zeta")?, measures(table, "natural_map")?);
    let (quad_dv, iterating_s) = (measures(table, "quad_dv")?, measures(table, "iterating_s")?);
    let velocity_error = newer(table, "velocity_error")?;
    let (updates, products) = (u64s(table, "contact_updates")?, u64s(table, "delassus_products")?);
    let (entries, factorisations) =
        (u64s(table, "triangular_solve_entries")?, u64s(table, "factorisations")?);
    let mut curves: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
    for i in 0..table.height() {
        curves.entry(run[i]).or_default().push(Point {
            iteration: iteration[i],
            iterating_s: iterating_s[i],
            zeta: zeta[i],
            natural_map: natural_map[i],
            quad_dv: quad_dv[i],
            velocity_error: velocity_error[i],
            contact_updates: updates[i],
            delassus_products: products[i],
            triangular_solve_entries: entries[i],
            factorisations: factorisations[i],
        });
    }
    for curve in curves.values_mut() {
        curve.sort_by_key(|point| point.iteration);
    }
    Ok(curves)
}

#[cfg(test)]
mod tests {
    use results::schema::Run;
    use serde_json::json;

    use super::*;
    use crate::fixture::{run, tables};

    /// Labels of runs of one method with these variants and settings.
    fn labels(all: &[(&str, Value)]) -> Vec<String> {
        let row = |(variant, settings): &(&str, Value)| Run {
            settings: settings.to_string(),
            ..run(0, "m", variant, "converged")
        };
        let tables = tables(&all.iter().map(row).collect::<Vec<_>>(), &[]);
        runs(&tables.runs).unwrap().iter().map(RunRow::label).collect()
    }

    #[test]
    fn number_or_truth_value_is_told_with_the_setting_that_it_is_of() {
        let polish = |on: bool| json!({ "polish": on, "symmetric": false });
        assert_eq!(
            labels(&[("true", polish(true)), ("false", polish(false))]),
            ["m, polish", "m, no polish"]
        );
        let omega = |omega: f64| json!({ "relaxation": omega, "sweeps": 1 });
        let told = labels(&[("1", omega(1.0)), ("0.5", omega(0.5)), ("0.5, warm start", omega(0.5))]);
        assert_eq!(told, ["m, relaxation=1", "m, relaxation=0.5", "m, relaxation=0.5, warm start"]);
        let names = |name: &str| json!({ "preconditioner": name });
        let variants = ["none", "none, warm start", "diagonal"];
        let named: Vec<_> =
            variants.iter().zip(["none", "none", "diagonal"]).map(|(v, n)| (*v, names(n))).collect();
        assert_eq!(labels(&named), ["m", "m, warm start", "m, diagonal"]);
        // Two settings have the value: of which it is, is not known.
        let both = |x: f64| json!({ "kappa_l": x, "kappa_d": x });
        assert_eq!(labels(&[("1", both(1.0)), ("2", both(2.0))]), ["m 1", "m 2"]);
    }
}
