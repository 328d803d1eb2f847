//! The runs of one method over its search directions, on one problem, all else being equal.

use serde_json::Value;

use crate::read::{Ending, RunRow, differing, find_or_push, settings_text, span};

/// Settings in which runs may differ inside a field, or that are written beside the group.
const APART: [&str; 4] = ["kappa_l", "kappa_d", "relaxation", "adaptive"];
const SINGLE_SIDED: [&str; 4] = ["kappa_l_minus", "kappa_l_plus", "kappa_d_minus", "kappa_d_plus"];

/// A run with its directions; κ_d is κ_l unless it is set.
pub(crate) struct Cell<'r> {
    pub(crate) kappa_l: f64,
    pub(crate) kappa_d: f64,
    pub(crate) run: &'r RunRow,
}

/// The runs that agree in problem, method, relaxation and all else but their directions.
pub(crate) struct Field<'r> {
    pub(crate) problem: &'r str,
    pub(crate) method: &'r str,
    pub(crate) grains: u32,
    pub(crate) subdomains: u32,
    /// μ (–).
    pub(crate) relaxation: f64,
    /// The other settings in which the study's runs differ.
    pub(crate) group: String,
    pub(crate) cells: Vec<Cell<'r>>,
    /// The run that derives its directions, and keeps them.
    pub(crate) derived: Option<&'r RunRow>,
    /// The run that derives its directions, and adapts them.
    pub(crate) adaptive: Option<&'r RunRow>,
    /// The derived κ_l and κ_d of the problem, of whichever run says them (–).
    pub(crate) kappa: Option<(f64, f64)>,
}

impl<'r> Field<'r> {
    /// Reports whether κ_d varies on its own.
    pub(crate) fn is_plane(&self) -> bool {
        self.cells.iter().any(|cell| cell.kappa_d != cell.kappa_l)
    }

    /// The converged run with the fewest iterations; among equals that with the least κ.
    pub(crate) fn best(&self) -> Option<&Cell<'r>> {
        let converged = self.cells.iter().filter(|cell| cell.run.has_converged());
        converged.min_by(|a, b| {
            let kappas = a.kappa_l.total_cmp(&b.kappa_l).then(a.kappa_d.total_cmp(&b.kappa_d));
            a.run.iterations.cmp(&b.run.iterations).then(kappas)
        })
    }

    /// Which directions of the best run are the least or the greatest of several: the grid does not hold it then.
    pub(crate) fn edge(&self) -> Option<&'static str> {
        let best = self.best()?;
        let at_edge = |of: fn(&Cell) -> f64| {
            let ends = span(self.cells.iter().map(of));
            ends.is_some_and(|(low, high)| low < high && (of(best) == low || of(best) == high))
        };
        // One subdomain has no interface for κ_d.
        let has_d = self.is_plane() && self.subdomains > 1;
        match (at_edge(|cell| cell.kappa_l), has_d && at_edge(|cell| cell.kappa_d)) {
            (true, true) => Some("κ_l, κ_d"),
            (true, false) => Some("κ_l"),
            (false, true) => Some("κ_d"),
            (false, false) => None,
        }
    }

    /// Returns the ratio of the iterations of a run of the field to those of its best run, if it converged.
    pub(crate) fn ratio(&self, run: Option<&RunRow>) -> Option<f64> {
        let best = self.best().map(|cell| cell.run.iterations).filter(|iterations| *iterations > 0)?;
        Some(iterations(run)? as f64 / best as f64)
    }

    /// Runs with given directions that ended so.
    pub(crate) fn count(&self, ending: Ending) -> usize {
        self.cells.iter().filter(|cell| cell.run.status == ending).count()
    }
}

/// All fields, in the order of the study.
pub(crate) fn fields(runs: &[RunRow]) -> Vec<Field<'_>> {
    let directed = |run: &&RunRow| {
        run.settings.contains_key("kappa_l")
            && SINGLE_SIDED.iter().all(|key| run.settings.get(*key).is_none_or(Value::is_null))
    };
    let keys = differing(runs.iter().map(|run| (&run.method, &run.settings)), &APART);
    let mut fields: Vec<Field> = Vec::new();
    for run in runs.iter().filter(directed) {
        let relaxation = number(run, "relaxation").unwrap_or(1.0);
        let group = settings_text((&run.method, &run.settings), &keys);
        let same = |f: &Field| {
            f.problem == run.problem
                && f.method == run.method
                && f.relaxation == relaxation
                && f.group == group
        };
        let new = || Field {
            problem: &run.problem,
            method: &run.method,
            grains: run.grains,
            subdomains: run.subdomains,
            relaxation,
            group: group.clone(),
            cells: Vec::new(),
            derived: None,
            adaptive: None,
            kappa: None,
        };
        let field = find_or_push(&mut fields, same, new);
        match (number(run, "kappa_l"), number(run, "kappa_d")) {
            (Some(kappa_l), kappa_d) if kappa_l > 0.0 => {
                field.cells.push(Cell { kappa_l, kappa_d: kappa_d.unwrap_or(kappa_l), run });
            }
            // A method that knows of no adapting keeps what it derives.
            (None, None) if !matches!(run.settings.get("adaptive"), None | Some(Value::Bool(false))) => {
                field.adaptive = Some(run);
            }
            (None, None) => {
                field.derived = Some(run);
                field.kappa = kappa(run, "kappa_l_minus").zip(kappa(run, "kappa_d_minus"));
            }
            _ => {}
        }
    }
    for i in 0..fields.len() {
        let of_problem = |f: &&Field| f.problem == fields[i].problem;
        fields[i].kappa = fields[i].kappa.or(fields.iter().filter(of_problem).find_map(|f| f.kappa));
    }
    fields.retain(|field| !field.cells.is_empty());
    fields
}

/// Iterations of a run that converged.
pub(crate) fn iterations(run: Option<&RunRow>) -> Option<u64> {
    run.filter(|run| run.has_converged()).map(|run| run.iterations)
}

/// A direction that a run worked with at its end (–).
pub(crate) fn kappa(run: &RunRow, key: &str) -> Option<f64> {
    run.derived.get(key).and_then(Value::as_f64).filter(|kappa| *kappa > 0.0)
}

fn number(run: &RunRow, key: &str) -> Option<f64> {
    run.settings.get(key).and_then(Value::as_f64)
}
