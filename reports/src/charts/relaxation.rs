//! Iterations against the relaxation ω, problem by problem, and the fixed ω that is best over all of them.

use std::collections::BTreeMap;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    At, BEST, Curve, Guide, Look, MARKS, MOST_LINES, Mark, Panel, Plot, SPARE, Scale, Side, TOLERANCE,
    Through, series,
};
use crate::read::{Ending, Problems, RunRow, counted, problems, unique};
use crate::text::{Part, frame, nothing, too_many};

const KEY: &str = "relaxation";

/// The runs of a method with all settings but ω the same, by problem, each by rising ω.
struct Swept<'r> {
    label: String,
    problems: Vec<Vec<&'r RunRow>>,
    /// Cost of each ω over all problems, by rising ω.
    overall: Vec<Overall>,
}

/// An ω on all problems.
struct Overall {
    relaxation: f64,
    failed: usize,
    /// Geometric mean of the iterations over the problems; a run that failed counts with all that it was allowed.
    mean: f64,
}

/// The figure and the table `relaxation`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let swept_over = |run: &&RunRow| run.status != Ending::Skipped && omega(run).is_some();
    let runs: Vec<&RunRow> = study.runs.iter().filter(swept_over).collect();
    let all = swept(&runs);
    let rule = "\nThe best fixed ω fails on the fewest problems, and among such has the least geometric mean of iterations; a \
                run that failed counts with all iterations that it was allowed.\n";
    vec![
        figure(&runs, &all),
        Part::table("relaxation-found", table_of_fixed(&all), rule),
        Part::table(KEY, table(&all), ""),
    ]
}

fn omega(run: &RunRow) -> Option<f64> {
    run.settings.get(KEY)?.as_f64()
}

/// Returns the series that were run with several ω.
fn swept<'r>(runs: &[&'r RunRow]) -> Vec<Swept<'r>> {
    let mut all = Vec::new();
    for series in series(runs.iter().copied(), &[KEY]) {
        let of = |problem| {
            let mut runs: Vec<&RunRow> =
                series.runs.iter().copied().filter(|run| run.problem == problem).collect();
            runs.sort_by(|a, b| omega(a).partial_cmp(&omega(b)).unwrap_or(std::cmp::Ordering::Equal));
            runs
        };
        let mut problems: Vec<Vec<&RunRow>> = problems(runs.iter().copied()).into_iter().map(of).collect();
        problems.retain(|runs| runs.len() > 1);
        if !problems.is_empty() {
            let overall = overall(&problems);
            all.push(Swept { label: series.label(), problems, overall });
        }
    }
    all
}

/// The ω that all problems were run with.
fn overall(problems: &[Vec<&RunRow>]) -> Vec<Overall> {
    let at = |relaxation| {
        let runs = problems.iter().map(|runs| runs.iter().find(|run| omega(run) == Some(relaxation)));
        let runs: Vec<&RunRow> = runs.map(Option::<&&RunRow>::copied).collect::<Option<_>>()?;
        let cost = |run: &&RunRow| if run.has_converged() { run.iterations } else { run.max_iterations };
        let logs: f64 = runs.iter().map(|run| (cost(run).max(1) as f64).ln()).sum();
        let failed = runs.iter().filter(|run| !run.has_converged()).count();
        Some(Overall { relaxation, failed, mean: (logs / runs.len() as f64).exp() })
    };
    problems[0].iter().filter_map(|run| at(omega(run)?)).collect()
}

impl Swept<'_> {
    /// The best fixed ω.
    fn fixed(&self) -> Option<&Overall> {
        self.overall.iter().min_by(|a, b| a.failed.cmp(&b.failed).then(a.mean.total_cmp(&b.mean)))
    }

    fn at(&self, relaxation: f64) -> Option<&Overall> {
        self.overall.iter().find(|overall| overall.relaxation == relaxation)
    }
}

/// The run with the fewest iterations of those that converged.
fn best<'r>(runs: &[&'r RunRow]) -> Option<&'r RunRow> {
    runs.iter().copied().filter(|run| run.has_converged()).min_by_key(|run| run.iterations)
}

/// The problem of a run without its seed: packings that differ in it look the same.
fn kind(run: &RunRow) -> String {
    match run.problem_settings.get("sample.seed") {
        Some(seed) => run.problem.replace(&format!(" seed={seed}"), ""),
        None => run.problem.clone(),
    }
}

/// Looks of the kinds of problem, in the order of the study: none of a method.
fn looks(runs: &[&RunRow]) -> BTreeMap<String, Look> {
    let look = |(n, kind): (usize, String)| {
        (kind, Look { mark: MARKS[n % MARKS.len()], ..SPARE[n % SPARE.len()].dashed(n) })
    };
    unique(runs.iter().map(|run| kind(run))).into_iter().enumerate().map(look).collect()
}

fn figure(runs: &[&RunRow], all: &[Swept]) -> Part {
    let lines: usize = all.iter().map(|swept| swept.problems.len()).sum();
    if lines == 0 {
        let why = "no method was run with several values of `relaxation`";
        return nothing(KEY, "Iterations against ω", why);
    }
    if lines > MOST_LINES {
        return too_many(KEY, "Iterations against ω", lines);
    }
    let shown = || all.iter().flat_map(|swept| &swept.problems).flatten();
    let stop = shown().next().and_then(|run| Some(format!(", iterations to {}", run.rule()?)));
    let title = vec![format!("{}{}", counted(shown().count(), "run"), stop.unwrap_or_default())];
    let looks = looks(runs);
    let panels = all.iter().map(|swept| panel(swept, &looks)).collect();
    Part::figure(KEY, Plot { title, panels, ..Plot::default() }.svg())
}

/// A line for each problem; a run that failed is at the upper edge, however many iterations it made. An ω of 2 or more has no place.
fn panel(swept: &Swept, looks: &BTreeMap<String, Look>) -> Panel {
    let place = |omega: f64| Some(Scale::of_relaxation(omega)).filter(|place| place.is_finite());
    let point = |run: &&RunRow| {
        let y = if run.has_converged() { (run.iterations as f64).log10() } else { f64::INFINITY };
        Some((run.status, (place(omega(run)?)?, y)))
    };
    let curve = |runs: &Vec<&RunRow>| {
        let kind = kind(runs[0]);
        let points = runs.iter().filter_map(point).collect();
        Curve::new(kind.clone(), looks[&kind], points, Through::Points)
    };
    let mut curves: Vec<Curve> = swept.problems.iter().map(curve).collect();
    let best = swept.problems.iter().filter_map(|runs| point(&best(runs)?)).collect();
    let ring = Look { pen: BEST, mark: Mark::Ring };
    curves.push(Curve::new("best ω of the problem", ring, best, Through::Nothing));
    let fixed = swept.fixed().and_then(|fixed| place(fixed.relaxation));
    let guide = fixed.map(|x| Guide::new(At::X(x), TOLERANCE, "best fixed ω over all problems"));
    let (x, y) = ("relaxation ω (–)", format!("iterations of {}", swept.label));
    Panel::new(Side::new(Scale::Relaxation, x), Side::new(Scale::Ten, y), curves).guided(guide)
}

/// One row per method and problem.
fn table(all: &[Swept]) -> DataFrame {
    let rows: Vec<(&Swept, &Vec<&RunRow>)> =
        all.iter().flat_map(|swept| swept.problems.iter().map(move |runs| (swept, runs))).collect();
    let at = |runs: &[&RunRow], relaxation: f64| {
        let run = runs.iter().find(|run| omega(run) == Some(relaxation))?;
        run.has_converged().then_some(run.iterations)
    };
    let fixed = |swept: &Swept| swept.fixed().map(|fixed| fixed.relaxation);
    frame(df!(
        "method" => rows.iter().map(|(swept, _)| swept.label.as_str()).collect::<Vec<_>>(),
        "problem" => rows.iter().map(|(_, runs)| runs[0].problem.as_str()).collect::<Vec<_>>(),
        "failed" => rows.iter().map(|(_, runs)| runs.iter().filter(|run| !run.has_converged()).count() as u64).collect::<Vec<_>>(),
        "best" => rows.iter().map(|(_, runs)| best(runs).and_then(omega)).collect::<Vec<_>>(),
        "iterations" => rows.iter().map(|(_, runs)| best(runs).map(|run| run.iterations)).collect::<Vec<_>>(),
        "best_fixed" => rows.iter().map(|(swept, _)| fixed(swept)).collect::<Vec<_>>(),
        "iterations_at_best_fixed" => rows.iter().map(|(swept, runs)| at(runs, fixed(swept)?)).collect::<Vec<_>>(),
        "iterations_at_1" => rows.iter().map(|(_, runs)| at(runs, 1.0)).collect::<Vec<_>>(),
    ))
}

/// One row per method: the best fixed ω beside ω = 1, over all problems.
fn table_of_fixed(all: &[Swept]) -> DataFrame {
    let of = |at: fn(&Swept) -> Option<f64>| all.iter().map(at).collect::<Vec<_>>();
    frame(df!(
        "method" => all.iter().map(|swept| swept.label.as_str()).collect::<Vec<_>>(),
        "problems" => all.iter().map(|swept| swept.problems.len() as u64).collect::<Vec<_>>(),
        "best_fixed" => of(|swept| Some(swept.fixed()?.relaxation)),
        "mean_iterations" => of(|swept| Some(swept.fixed()?.mean)),
        "failed" => of(|swept| Some(swept.fixed()?.failed as f64)),
        "mean_iterations_at_1" => of(|swept| Some(swept.at(1.0)?.mean)),
        "failed_at_1" => of(|swept| Some(swept.at(1.0)?.failed as f64)),
    ))
}
