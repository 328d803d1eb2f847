//! Iterations, and seconds of an iteration, against the number of subdomains.

use super::scaling::table_of;
use crate::draw::{
    Canvas, INSIDE, Legend, MOST_LINES, Pen, Points, Room, Scale, Series, Sign, TOLERANCE, draw_empty,
    draw_signs, endings, has_line, key, on_the_way, reach, row, series, title,
};
use crate::read::{Ending, Problems, RunRow, file_name, problems};
use crate::text::{Part, too_many};

/// What a panel shows of a run of a series.
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) of: fn(&Series, &RunRow) -> Option<f64>,
    /// Whether it was reached however the run ended.
    pub(crate) on_the_way: bool,
    /// Whether as many times as there are subdomains is the ideal. Panels with an ideal have the same axes.
    pub(crate) ideal: bool,
}

impl Panel {
    pub(crate) fn new(title: impl Into<String>, of: fn(&Series, &RunRow) -> Option<f64>) -> Self {
        Self { title: title.into(), of, on_the_way: false, ideal: false }
    }

    /// Iterations of runs that converged; of others those that they made.
    pub(crate) fn iterations() -> Self {
        Self::new("iterations to the tolerance", |_, run| Some(run.iterations as f64))
    }

    pub(crate) fn iterations_to_1e_2() -> Self {
        let of =
            |_: &Series, run: &RunRow| run.iterations_to_natural_map_1e_2.map(|iterations| iterations as f64);
        Self { on_the_way: true, ..Self::new("iterations to a natural map of 10⁻²", of) }
    }

    /// The points of a series; its runs by what they are on the x axis.
    pub(crate) fn points(&self, series: &Series, x: fn(&RunRow) -> f64) -> Points {
        let points = series.points(x, |run| (self.of)(series, run));
        if self.on_the_way { on_the_way(points) } else { points }
    }
}

/// `subdomains-<problem>` for each problem, and the table `subdomains` with the growth.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs: Vec<&RunRow> = study.runs.iter().collect();
    let seconds = Panel::new("seconds per iteration (s)", |_, run| run.seconds_per_iteration());
    let panels = [Panel::iterations(), seconds];
    let mut parts = Vec::new();
    for problem in problems(&study.runs) {
        let name = format!("subdomains-{}", file_name(problem));
        parts.push(on_problem(name, &runs, problem, &panels, Vec::new()));
    }
    let names = "problem method subdomains status iterations growth seconds_per_iteration setup_s seconds";
    let note =
        "\nGrowth: iterations over those of the same method and settings with the fewest subdomains.\n";
    parts.push(Part::table("subdomains", table_of(&study.runs, names), note));
    parts
}

/// The series on one problem; a run that was skipped has no point.
fn series_on<'r>(runs: &[&'r RunRow], problem: &str) -> Vec<Series<'r>> {
    let mut all = series(runs.iter().copied(), &["subdomains"]);
    for series in &mut all {
        series.runs.retain(|run| run.problem == problem && run.ending != Ending::Skipped);
    }
    all.retain(|series| !series.runs.is_empty());
    all
}

/// The runs on a problem against their subdomains, and `notes` in the key.
pub(crate) fn on_problem(
    name: String,
    runs: &[&RunRow],
    problem: &str,
    panels: &[Panel],
    notes: Vec<String>,
) -> Part {
    let all = series_on(runs, problem);
    let shown: Vec<&RunRow> = all.iter().flat_map(|series| series.runs.iter().copied()).collect();
    figure(name, title(problem, &shown), &all, panels, notes)
}

/// The runs of all series against their subdomains, up to three panels side by side, or four in two rows.
pub(crate) fn figure(
    name: String,
    title: String,
    all: &[Series],
    panels: &[Panel],
    notes: Vec<String>,
) -> Part {
    if all.len() > MOST_LINES {
        return too_many(name, &title, all.len());
    }
    // By panel, then by series.
    let lines: Vec<Vec<Points>> = panels
        .iter()
        .map(|panel| all.iter().map(|series| panel.points(series, |run| f64::from(run.subdomains))).collect())
        .collect();
    let keyed = all.iter().enumerate().map(|(i, series)| {
        let of_series: Vec<&Points> = lines.iter().map(|lines| &lines[i]).collect();
        let level = lines.iter().any(|lines| level(series, &lines[i], lines).is_some());
        let line = level || of_series.iter().any(|points| has_line(&on_the_way(joined(points))));
        (series.label(), series.look, of_series, line)
    });
    let (entries, mut signs) = key(keyed);
    let shown = lines.iter().flatten().flatten();
    signs.extend(endings(shown.map(|(ending, _)| *ending).filter(|ending| *ending != Ending::Converged)));
    if panels.iter().zip(&lines).any(|(panel, lines)| has_ideal(panel, lines)) {
        signs.push((Sign::Line(TOLERANCE), "ideal: as many times faster as there are subdomains".to_owned()));
    }
    let has_level = |lines: &Vec<Points>| all.iter().zip(lines).any(|(s, p)| level(s, p, lines).is_some());
    if lines.iter().any(has_level) {
        signs.push((Sign::Word, "Level lines: methods without subdomains.".to_owned()));
    }
    signs.extend(notes.into_iter().map(|note| (Sign::Word, note)));
    let legend = Legend::new(entries, signs, INSIDE);
    let shared: Vec<&Points> =
        panels.iter().zip(&lines).filter(|(panel, _)| panel.ideal).flat_map(|(_, lines)| lines).collect();
    let svg = row(&[title], panels.len(), &legend, |canvas, i, room| {
        let of_panel: Vec<&Points> = if panels[i].ideal { shared.clone() } else { lines[i].iter().collect() };
        panel(canvas, all, &panels[i], (&lines[i], &of_panel), room);
    });
    Part::figure(name, svg)
}

/// What a line goes through, thin where a run made all its iterations and more would be needed.
fn joined(points: &Points) -> Points {
    let joins = |ending| matches!(ending, Ending::Converged | Ending::IterationLimit);
    points.iter().filter(|(ending, _)| joins(*ending)).copied().collect()
}

/// Whether the panel has an ideal, and a run on one subdomain that it is to be measured by.
fn has_ideal(panel: &Panel, lines: &[Points]) -> bool {
    panel.ideal && lines.iter().flatten().any(|(_, (log, _))| *log == 0.0)
}

/// The value of a method that knows of no subdomains, where others of the panel have several numbers of them.
fn level(series: &Series, points: &Points, lines: &[Points]) -> Option<f64> {
    let whole = series.runs.iter().all(|run| !run.settings.contains_key("subdomains"));
    let several = lines.iter().flatten().any(|(_, (log, _))| *log > 0.0);
    match points.as_slice() {
        [(Ending::Converged, (_, value))] if whole && several => Some(*value),
        _ => None,
    }
}

/// A panel whose axes hold the points of `range`, and the ideal beside them.
fn panel(
    canvas: &Canvas,
    all: &[Series],
    panel: &Panel,
    (lines, range): (&[Points], &[&Points]),
    room: Room,
) {
    let x = reach(range.iter().copied().flatten(), |point| point.0);
    let ideal: Points = if has_ideal(panel, lines) {
        range.iter().copied().flatten().map(|&(ending, (log, _))| (ending, (log, log))).collect()
    } else {
        Vec::new()
    };
    let y = reach(range.iter().copied().flatten().chain(&ideal), |point| point.1);
    let frame = room.frame(canvas, (Scale::Two, x, "subdomains"), (Scale::Ten, y, &panel.title));
    if !ideal.is_empty() {
        frame.draw_diagonal(canvas);
    }
    for (series, points) in all.iter().zip(lines) {
        let pen = series.look.pen;
        if let Some(value) = level(series, points, lines) {
            frame.across(canvas, value, pen);
        }
        let line = joined(points);
        let places = |limit: bool| {
            let points = line.iter().filter(|(ending, _)| limit || *ending == Ending::Converged);
            points.map(|(_, point)| frame.place(*point)).collect::<Vec<_>>()
        };
        canvas.line(&places(true), Pen { width: 0.4 * pen.width, ..pen });
        canvas.line(&places(false), pen);
    }
    let signs: Vec<_> =
        all.iter().zip(lines).map(|(series, points)| (series.look, points.as_slice())).collect();
    draw_signs(canvas, &frame, &signs);
    if lines.iter().all(Vec::is_empty) {
        draw_empty(canvas, &frame);
    }
}
