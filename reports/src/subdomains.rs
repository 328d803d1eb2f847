//! Iterations, and seconds of an iteration, against the number of subdomains.

use polars::df;
use results::store::Tables;

use crate::axis::{Axis, Frame, Scale};
use crate::canvas::Canvas;
use crate::ending::Ending;
use crate::legend::Legend;
use crate::panels::{INSIDE, MOST_LINES, Room, grid, title, too_many};
use crate::part::Part;
use crate::rows::{RunRow, problems, runs};
use crate::series::{Points, Series, draw_empty, draw_points, reach, reached, series};
use crate::signs::{Sign, endings};
use crate::style::TOLERANCE;
use crate::{ReportError, file_name};

/// What a panel shows of a run of a series.
pub(crate) struct Panel {
    pub(crate) title: &'static str,
    pub(crate) of: fn(&Series, &RunRow) -> Option<f64>,
    /// Whether it was reached however the run ended.
    pub(crate) on_the_way: bool,
    /// Whether as many times as there are subdomains is the ideal.
    pub(crate) ideal: bool,
}

/// Iterations of runs that converged; of others those that they made.
pub(crate) const ITERATIONS: Panel = Panel {
    title: "iterations to the tolerance",
    of: |_, run| Some(run.iterations as f64),
    on_the_way: false,
    ideal: false,
};

const PANELS: [Panel; 2] = [
    ITERATIONS,
    Panel {
        title: "seconds per iteration (s)",
        of: |_, run| seconds_per_iteration(run),
        on_the_way: false,
        ideal: false,
    },
];

pub(crate) fn seconds_per_iteration(run: &RunRow) -> Option<f64> {
    run.iterating_s.filter(|_| run.iterations > 0).map(|seconds| seconds / run.iterations as f64)
}

/// `subdomains-<problem>` for each problem, and the table `subdomains` with the growth.
pub(crate) fn parts(tables: &Tables) -> Result<Vec<Part>, ReportError> {
    let runs = runs(&tables.runs)?;
    let mut parts = Vec::new();
    for problem in problems(&runs) {
        parts.push(Part::figure(
            format!("subdomains-{}", file_name(problem)),
            on_problem(&runs, problem, &PANELS)?,
        ));
    }
    let table = table(&series(&runs, &["subdomains"]))?;
    let note =
        "\nGrowth: iterations over those of the same method and settings with the fewest subdomains.\n";
    parts.push(Part::table("subdomains", table, note));
    Ok(parts)
}

/// The series on one problem; a run that was skipped has no point.
fn series_on<'r>(runs: &'r [RunRow], problem: &str) -> Vec<Series<'r>> {
    let mut all = series(runs, &["subdomains"]);
    for series in &mut all {
        series.runs.retain(|run| run.problem == problem && run.ending != Ending::Skipped);
    }
    all.retain(|series| !series.runs.is_empty());
    all
}

/// The runs on a problem against their subdomains.
pub(crate) fn on_problem(runs: &[RunRow], problem: &str, panels: &[Panel]) -> Result<String, ReportError> {
    let all = series_on(runs, problem);
    let shown: Vec<&RunRow> = all.iter().flat_map(|series| series.runs.iter().copied()).collect();
    figure(title(problem, &shown), &all, panels)
}

/// The runs of all series against their subdomains, one panel or an even number of them.
pub(crate) fn figure(title: String, all: &[Series], panels: &[Panel]) -> Result<String, ReportError> {
    if all.len() > MOST_LINES {
        return too_many(&title, all.len());
    }
    // By panel, then by series.
    let lines: Vec<Vec<Points>> =
        panels.iter().map(|panel| all.iter().map(|series| points(series, panel)).collect()).collect();
    let shown = lines.iter().flatten().flatten();
    let failures = shown.map(|(ending, _)| *ending).filter(|ending| *ending != Ending::Converged);
    let label = |(i, series): (usize, &Series)| {
        let valued = lines.iter().any(|lines| !lines[i].is_empty());
        (series.label() + if valued { "" } else { ": no value" }, series.look)
    };
    let entries = all.iter().enumerate().map(label).collect();
    let mut signs = endings(failures);
    if panels.iter().zip(&lines).any(|(panel, lines)| has_ideal(panel, lines)) {
        signs.push((Sign::Line(TOLERANCE), "ideal: as many times faster as there are subdomains".to_owned()));
    }
    let legend = Legend::new(entries, signs, INSIDE)?;
    let columns = panels.len().min(2);
    let rows = panels.len().div_ceil(columns);
    grid(&[title], (columns, rows), &legend, |canvas, i, room| {
        panel(canvas, all, &panels[i], &lines[i], room)
    })
}

/// Subdomains and value of the runs of a series.
fn points(series: &Series, panel: &Panel) -> Points {
    let points = series.points(|run| f64::from(run.subdomains), |run| (panel.of)(series, run));
    if panel.on_the_way { reached(points) } else { points }
}

/// Whether the panel has an ideal, and a run on one subdomain that it is to be measured by.
fn has_ideal(panel: &Panel, lines: &[Points]) -> bool {
    panel.ideal && lines.iter().flatten().any(|(_, (log, _))| *log == 0.0)
}

fn panel(
    canvas: &Canvas,
    all: &[Series],
    panel: &Panel,
    lines: &[Points],
    room: Room,
) -> Result<(), ReportError> {
    let x = reach(lines.iter().flatten(), |point| point.0);
    let frame = Frame {
        x: Axis { scale: Scale::Two, ..Axis::log(x, room.left, room.right) },
        y: Axis::log(reach(lines.iter().flatten(), |point| point.1), room.bottom, room.top),
    };
    frame.draw(canvas)?;
    frame.name(canvas, "subdomains", panel.title)?;
    if let Some(ideal) = frame.diagonal().filter(|_| has_ideal(panel, lines)) {
        canvas.line(&ideal, TOLERANCE)?;
    }
    for (series, points) in all.iter().zip(lines) {
        let converged = points.iter().filter(|(ending, _)| *ending == Ending::Converged);
        canvas.line(&converged.map(|(_, point)| frame.place(*point)).collect::<Vec<_>>(), series.look.pen)?;
        draw_points(canvas, &frame, series.look, points)?;
    }
    if lines.iter().all(Vec::is_empty) { draw_empty(canvas, &frame) } else { Ok(()) }
}

/// Iterations of a run over those of the one with the fewest subdomains among `same`, if both converged.
pub(crate) fn growth<'r>(run: &RunRow, same: impl Iterator<Item = &'r RunRow>) -> Option<f64> {
    let fewest = same.min_by_key(|other| other.subdomains)?;
    let converged = [run, fewest].iter().all(|run| run.ending == Ending::Converged);
    (converged && fewest.iterations > 0).then(|| run.iterations as f64 / fewest.iterations as f64)
}

/// One row per run, with its iterations over those of the fewest subdomains.
fn table(all: &[Series]) -> Result<polars::prelude::DataFrame, ReportError> {
    let mut rows: Vec<(&Series, &RunRow, Option<f64>)> = Vec::new();
    for series in all {
        for run in &series.runs {
            let same = series.runs.iter().filter(|other| other.problem == run.problem);
            rows.push((series, run, growth(run, same.copied())));
        }
    }
    let seconds = |run: &RunRow| Some(run.setup_s? + run.iterating_s?);
    Ok(df!(
        "problem" => rows.iter().map(|(_, run, _)| run.problem.as_str()).collect::<Vec<_>>(),
        "method" => rows.iter().map(|(series, ..)| series.label()).collect::<Vec<_>>(),
        "subdomains" => rows.iter().map(|(_, run, _)| run.subdomains).collect::<Vec<_>>(),
        "status" => rows.iter().map(|(_, run, _)| run.ending.text()).collect::<Vec<_>>(),
        "iterations" => rows.iter().map(|(_, run, _)| run.iterations).collect::<Vec<_>>(),
        "growth" => rows.iter().map(|(.., growth)| *growth).collect::<Vec<_>>(),
        "seconds_per_iteration" =>
            rows.iter().map(|(_, run, _)| seconds_per_iteration(run)).collect::<Vec<_>>(),
        "setup_s" => rows.iter().map(|(_, run, _)| run.setup_s).collect::<Vec<_>>(),
        "seconds" => rows.iter().map(|(_, run, _)| seconds(run)).collect::<Vec<_>>(),
    )?)
}
