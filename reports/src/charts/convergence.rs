//! Measures against iterations: ζ, the paper's indicator, on the left, and the natural map of the same runs.

mod ratios;

use contact::Measure;

use crate::draw::{
    Axis, Canvas, Frame, HPos, LEADING, Legend, Lines, MARGIN, MOST_LINES, PAGE, PAGE_HEIGHT, Sign, TEXT,
    TICK_TEXT, TOLERANCE, VPos, draw_lines, log_point, range, svg, title,
};
use crate::read::{Problems, RunRow, file_name, number, problems, round_up};
use crate::text::{Part, nothing, too_many};

/// Left of a panel for the labels of its ticks, and right of it for the tolerance (mm).
const LEFT: f64 = 11.0;
const RIGHT: f64 = 9.0;
/// Above a panel for its titles, and below it for the labels and the name of its iterations (mm).
const ABOVE: f64 = 2.0 * LEADING + 0.8;
const BELOW: f64 = 9.0;
/// Height of a panel alone, and bounds of it in a stack (mm).
const ALONE: f64 = 66.0;
const LEAST: f64 = 32.0;
const GREATEST: f64 = 54.0;

/// Measures of the panels beside each other, and the names of their axes.
const MEASURES: [(Measure, &str); 2] = [
    (Measure::Zeta, "ζ, relative change in the last iteration (–)"),
    (Measure::NaturalMap, "natural map, distance to a solution (–)"),
];

/// `convergence-<problem>` and `ratios-<problem>` for each problem, and `convergence` with all of them if a page holds that many.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let (study, problems) = (Lines::of(&study.runs), problems(&study.runs));
    if problems.is_empty() {
        return vec![nothing("convergence", "convergence", "no run in this study")];
    }
    let mut parts = Vec::new();
    let lines = |problem: &&str| study.runs_of(problem).len();
    for &problem in &problems {
        let name = format!("convergence-{}", file_name(problem));
        parts.push(match lines(&problem) {
            many if many > MOST_LINES => too_many(name, problem, many),
            _ => Part::figure(name, study.figure(&[problem], ALONE)),
        });
        parts.extend(ratios::figure(&study, problem));
    }
    if problems.iter().any(|problem| lines(problem) > MOST_LINES) {
        return parts;
    }
    let legend = study.key(&problems).height() + 2.0 * MARGIN;
    let panel = (PAGE_HEIGHT - legend) / problems.len() as f64 - ABOVE - BELOW;
    if panel >= LEAST {
        let together = Part::figure("convergence", study.figure(&problems, panel.min(GREATEST)));
        parts.push(together.beside_the_page());
    }
    parts
}

impl Lines<'_> {
    /// One row of panels per problem, with one legend below.
    fn figure(&self, problems: &[&str], panel: f64) -> String {
        let legend = self.key(problems);
        let rows = problems.len() as f64 * (ABOVE + panel + BELOW);
        let height = (2.0 * MARGIN + rows + legend.height()).ceil();
        svg((PAGE, height), |canvas| {
            for (i, problem) in problems.iter().enumerate() {
                let top = MARGIN + i as f64 * (ABOVE + panel + BELOW);
                self.draw_problem(canvas, problem, (top + ABOVE, top + ABOVE + panel));
            }
            legend.draw(canvas, (MARGIN + LEFT, MARGIN + rows));
        })
    }

    /// One entry per kind of run, the signs, and the runs that have no line since nothing was left to do.
    fn key(&self, problems: &[&str]) -> Legend {
        let runs: Vec<&RunRow> = problems.iter().flat_map(|problem| self.runs_of(problem)).collect();
        let begun = |run: &&&RunRow| run.has_converged() && run.iterations == 0;
        let note = |run: &&RunRow| {
            let text = format!("{} on {}: converged at its start, no line", run.label(), run.problem);
            (Sign::Word, text)
        };
        let tolerance = (Sign::Line(TOLERANCE), "stopping tolerance".to_owned());
        let more = std::iter::once(tolerance).chain(runs.iter().filter(begun).map(note)).collect();
        self.legend(&runs, more, PAGE - 2.0 * MARGIN - LEFT)
    }

    fn draw_problem(&self, canvas: &Canvas, problem: &str, (top, bottom): (f64, f64)) {
        let runs = self.runs_of(problem);
        let left = MARGIN + LEFT;
        canvas.text(&title(problem, &runs), (left, top - ABOVE), TEXT, (HPos::Left, VPos::Top));
        let last = runs.iter().filter_map(|run| run.curve.last()).map(|point| point.iteration).max();
        let most = round_up(last.unwrap_or(1).max(10) as f64).log10();
        let pitch = (PAGE - 2.0 * MARGIN) / MEASURES.len() as f64;
        for (i, measure) in MEASURES.into_iter().enumerate() {
            let from = left + pitch * i as f64;
            let x = Axis::log((0.0, most), from, from + pitch - LEFT - RIGHT);
            self.draw_panel(canvas, measure, &runs, x, (top, bottom));
        }
    }

    fn draw_panel(
        &self,
        canvas: &Canvas,
        (measure, name): (Measure, &str),
        runs: &[&RunRow],
        x: Axis,
        (top, bottom): (f64, f64),
    ) {
        let lines = self.lines(runs, |_, point| log_point(point.iteration as f64, point.get(measure)));
        let tolerances = tolerances(runs, measure);
        let frame = Frame { x, y: Axis::log(range(&lines, &tolerances), bottom, top) };
        frame.draw(canvas);
        frame.name(canvas, "iterations", name);
        for tolerance in tolerances {
            frame.across(canvas, tolerance.log10(), TOLERANCE);
            let place = (frame.x.to + 0.9, frame.y.place(tolerance.log10()));
            canvas.text(&number(tolerance, 2), place, TICK_TEXT, (HPos::Left, VPos::Center));
        }
        draw_lines(canvas, &frame, &lines);
    }
}

/// The tolerances at which a measure stops some of the runs.
fn tolerances(runs: &[&RunRow], measure: Measure) -> Vec<f64> {
    let all =
        runs.iter().filter(|run| run.stopping_measure() == Some(measure)).filter_map(|run| run.tolerance);
    let mut tolerances: Vec<f64> = all.filter(|t| t.is_finite() && *t > 0.0).collect();
    tolerances.sort_by(f64::total_cmp);
    tolerances.dedup();
    tolerances
}

#[cfg(test)]
mod tests;
