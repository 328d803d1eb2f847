//! Iterations against the relaxation ω, problem by problem, and the fixed ω that is best over all of them.

use std::collections::BTreeMap;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    BEST, Canvas, DASHES, INSIDE, Legend, Look, MARKS, MOST_LINES, Mark, Pen, Room, SPARE, Scale, Sign,
    TOLERANCE, draw_empty, draw_signs, endings, grid, series,
};
use crate::read::{Ending, Problems, RunRow, counted, number, padded, problems, unique};
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
    let swept_over = |run: &&RunRow| run.ending != Ending::Skipped && omega(run).is_some();
    let runs: Vec<&RunRow> = study.runs.iter().filter(swept_over).collect();
    let all = swept(&runs);
    let note: String = all.iter().filter_map(sentence).collect();
    let rule = "\nThe best fixed ω fails on the fewest problems, and among such has the least geometric mean of iterations; a \
                run that failed counts with all iterations that it was allowed.\n";
    let table = Part::table(KEY, table(&all), rule);
    let found = (!note.is_empty()).then(|| Part::text("relaxation-found", note));
    [Some(figure(&runs, &all)), found, Some(table)].into_iter().flatten().collect()
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

/// Returns the sentence on the best fixed ω of a method, beside ω = 1.
fn sentence(swept: &Swept) -> Option<String> {
    let cost = |of: &Overall| {
        format!("{} iterations in the geometric mean, {} failed", number(of.mean, 3), of.failed)
    };
    let fixed = swept.fixed()?;
    let one = swept.at(1.0).map_or(String::new(), |one| format!("; at ω = 1 {}", cost(one)));
    let edge = swept.overall.last().is_some_and(|last| last.relaxation == fixed.relaxation);
    let edge = if edge { ", the greatest of the grid" } else { "" };
    Some(format!(
        "{} on {}: the best fixed ω is {}{edge}, with {}{one}.\n",
        swept.label,
        counted(swept.problems.len(), "problem"),
        fixed.relaxation,
        cost(fixed)
    ))
}

/// A problem without its seed: packings that differ in it look the same.
fn kind(problem: &str) -> String {
    problem.split(' ').filter(|word| !word.starts_with("seed=")).collect::<Vec<_>>().join(" ")
}

/// Looks of the kinds of problem, in the order of the study: none of a method.
fn looks(runs: &[&RunRow]) -> (Vec<(String, Look)>, BTreeMap<String, Look>) {
    let look = |(n, kind): (usize, String)| {
        let color = SPARE[n % SPARE.len()].shades[0];
        let pen = Pen { color, width: 0.3, dash: DASHES[n % DASHES.len()] };
        (kind, Look { pen, mark: MARKS[n % MARKS.len()] })
    };
    let kinds = unique(problems(runs.iter().copied()).into_iter().map(kind));
    let entries: Vec<(String, Look)> = kinds.into_iter().enumerate().map(look).collect();
    let by_kind = entries.iter().cloned().collect();
    (entries, by_kind)
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
    let shown: Vec<&RunRow> = all.iter().flat_map(|swept| &swept.problems).flatten().copied().collect();
    let (entries, looks) = looks(runs);
    let mut signs = endings(shown.iter().map(|run| run.ending).filter(|ending| *ending != Ending::Converged));
    signs.push((Sign::Mark(Mark::Ring, BEST), "best ω of the problem".to_owned()));
    signs.push((Sign::Line(TOLERANCE), "best fixed ω over all problems".to_owned()));
    let legend = Legend::new(entries, signs, INSIDE);
    let (first, last) = (shown.first(), all.len());
    let stop = first.and_then(|run| Some(format!(", iterations to {}", run.rule()?)));
    let title = format!("{}{}", counted(shown.len(), "run"), stop.unwrap_or_default());
    let columns = last.min(2);
    let svg = grid(&[title], (columns, last.div_ceil(columns)), &legend, |canvas, i, room| {
        if let Some(swept) = all.get(i) {
            panel(canvas, swept, &looks, room);
        }
    });
    Part::figure(KEY, svg)
}

/// Returns the place of ω on its axis; values of 2 and above have none.
fn place(run: &RunRow) -> Option<f64> {
    Some(Scale::of_relaxation(omega(run)?)).filter(|place| place.is_finite())
}

fn panel(canvas: &Canvas, swept: &Swept, looks: &BTreeMap<String, Look>, room: Room) {
    let runs = || swept.problems.iter().flatten();
    let iterations = runs().filter(|run| run.has_converged()).map(|run| (run.iterations as f64).log10());
    let x = padded(runs().filter_map(|run| place(run)), 0.05);
    let (y, name) = (padded(iterations, 0.1), format!("iterations of {}", swept.label));
    let frame = room.frame(canvas, (Scale::Relaxation, x, "relaxation ω (–)"), (Scale::Ten, y, &name));
    if let Some(fixed) = swept.fixed().map(|fixed| Scale::of_relaxation(fixed.relaxation)) {
        canvas.line(&[(frame.x.place(fixed), room.bottom), (frame.x.place(fixed), room.top)], TOLERANCE);
    }
    for runs in &swept.problems {
        let look = looks[&kind(&runs[0].problem)];
        // A run that failed is at the upper edge, however many iterations it made.
        let point = |run: &&RunRow| {
            let y = if run.has_converged() { (run.iterations as f64).log10() } else { frame.y.high };
            Some((run.ending, (place(run)?, y)))
        };
        let points: Vec<_> = runs.iter().filter_map(point).collect();
        let converged = points.iter().filter(|(ending, _)| *ending == Ending::Converged);
        canvas.line(&converged.map(|(_, point)| frame.place(*point)).collect::<Vec<_>>(), look.pen);
        draw_signs(canvas, &frame, &[(look, points.as_slice())]);
        if let Some((_, point)) = best(runs).and_then(|run| point(&run)) {
            canvas.mark(Mark::Ring, frame.place(point), BEST);
        }
    }
    if runs().any(|run| run.has_converged()) {
    } else {
        draw_empty(canvas, &frame);
    }
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
