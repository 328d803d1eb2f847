//! Charts "y against x by series", each of them one declaration in [`DECLARED`]: its x axis, its panels, what sets its series
//! apart, lines or fits through them, its ideal, its notes and the columns of its table.
//!
//! [`DECLARED`]: super::declared

use polars::prelude::Column;

use super::scaling::{Same, table};
use crate::draw::{
    Canvas, Frame, HPos, INSIDE, Legend, MOST_LINES, Pen, Points, Room, Scale, Series, Sign, TICK_TEXT,
    TOLERANCE, VPos, draw_empty, draw_signs, endings, grid, has_line, key, on_the_way, reach, series, title,
};
use crate::read::{
    Ending, Problems, RunRow, Verdicts, WORK, counted, distinct, file_name, problems, slope, span,
    stopped_at_1e_2, threads, unique,
};
use crate::text::{Part, frame, nothing, too_many};

/// A sentence of a key, with the series that it is said of.
pub(crate) type Note = (&'static str, fn(&[Series]) -> bool);

/// A declared chart.
pub(crate) struct Lines {
    /// Name of its table, and begin of those of its figures.
    pub(crate) name: &'static str,
    pub(crate) x: X,
    pub(crate) panels: &'static [Panel],
    /// The setting in which the runs of a series may differ.
    pub(crate) varied: &'static [&'static str],
    pub(crate) each: Each,
    pub(crate) through: Through,
    /// The runs that it is of.
    pub(crate) of: fn(&RunRow) -> bool,
    /// Sentences of the key, each with the series that it is said of.
    pub(crate) notes: &'static [Note],
    /// Columns of the table with a row per run; of a fit there is a row per series.
    pub(crate) columns: &'static str,
    /// Below the table.
    pub(crate) note: &'static str,
}

/// The x axis, the same in all panels.
pub(crate) struct X {
    pub(crate) title: &'static str,
    pub(crate) scale: Scale,
    pub(crate) of: fn(&RunRow) -> u32,
}

/// A quantity on the y axis of a panel.
#[derive(Clone, Copy)]
pub(crate) struct Panel {
    /// Begin of its column in the table of a fit.
    pub(crate) column: &'static str,
    /// Name of the axis; `{threads}` and `{grains}` stand for those of the runs.
    pub(crate) title: &'static str,
    pub(crate) of: fn(&Series, &RunRow) -> Option<f64>,
    /// True if it was reached however the run ended.
    pub(crate) on_the_way: bool,
    /// Panels with an ideal have the same axes.
    pub(crate) ideal: Option<Ideal>,
}

/// A line to compare with.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Ideal {
    /// As many times as x says.
    X(&'static str),
    /// One, in the midst of at least a factor of two.
    One(&'static str),
}

/// Figures of a chart.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Each {
    /// One for each problem.
    Problem,
    /// One of all problems.
    Study,
    /// One of all problems, with a panel for each.
    PanelOfProblem,
}

/// Lines of a chart.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Through {
    /// They join points.
    Points,
    /// They are powers of x, fitted to the runs that converged.
    Fit,
}

/// A panel as it is drawn: its axis, and the only problem that it is of.
struct Drawn<'p> {
    panel: &'p Panel,
    title: String,
    problem: Option<&'p str>,
}

/// Fewer places than this have no exponent: through two points every power fits.
const PLACES: usize = 3;
/// Slopes to compare with, as powers of x.
const SLOPES: [(f64, &str); 2] = [(0.5, "∝ √n"), (1.0, "∝ n")];
/// The part of a panel's height that is left to them.
const BELOW: f64 = 0.2;
/// Half the height of an axis around an ideal of one, at least (logarithm).
const AROUND_ONE: f64 = 0.35;

impl Panel {
    pub(crate) const fn new(
        column: &'static str,
        title: &'static str,
        of: fn(&Series, &RunRow) -> Option<f64>,
    ) -> Self {
        Self { column, title, of, on_the_way: false, ideal: None }
    }

    pub(crate) const fn on_the_way(self) -> Self {
        Self { on_the_way: true, ..self }
    }

    pub(crate) const fn ideal(self, ideal: Ideal) -> Self {
        Self { ideal: Some(ideal), ..self }
    }
}

impl Lines {
    /// Makes its figures and its table.
    pub(crate) fn parts(&self, study: &Problems) -> Vec<Part> {
        let runs: Vec<&RunRow> = study.runs.iter().filter(|run| (self.of)(run)).collect();
        let all = series(runs.iter().copied(), self.varied);
        let mut drawn = all.clone();
        for series in &mut drawn {
            series.runs.retain(|run| run.ending != Ending::Skipped);
        }
        let mut parts = Vec::new();
        if self.each == Each::Problem {
            for problem in problems(runs.iter().copied()) {
                let name = format!("{}-{}", self.name, file_name(problem));
                let mut drawn = drawn.clone();
                for series in &mut drawn {
                    series.runs.retain(|run| run.problem == problem);
                }
                drawn.retain(|series| !series.runs.is_empty());
                let shown: Vec<&RunRow> =
                    drawn.iter().flat_map(|series| series.runs.iter().copied()).collect();
                parts.push(self.figure(name, &[title(problem, &shown)], &drawn, &study.runs));
            }
        } else {
            parts.push(self.of_study(&drawn, &study.runs));
        }
        parts.push(match self.through {
            Through::Points => self.table(&all, |run, other| run.problem == other.problem),
            Through::Fit => self.exponents(&drawn, &study.runs),
        });
        parts
    }

    /// The table with a row for each run.
    pub(crate) fn table(&self, all: &[Series], same: Same) -> Part {
        Part::table(self.name, table(all, self.columns, same), self.note)
    }

    /// The figure of all problems; a sentence where x has a single value.
    fn of_study(&self, all: &[Series], runs: &[RunRow]) -> Part {
        let found = format!("{}-found", self.name);
        if all.len() > MOST_LINES {
            return too_many(found, self.name, all.len());
        }
        let shown = || all.iter().flat_map(|series| &series.runs);
        let xs = unique(shown().map(|run| (self.x.of)(run)));
        if xs.len() < 2 {
            let noun = self.x.title.trim_end_matches('s');
            let same = xs
                .first()
                .map_or("no run".to_owned(), |n| format!("every problem has {}", counted(*n as usize, noun)));
            return nothing(found, self.name, &format!("{same}, and cost has nothing to grow with"));
        }
        let counts = format!(
            "{}, {}, {} of {}, n",
            counted(problems(runs).len(), "problem"),
            counted(shown().count(), "run"),
            counted(xs.len(), "number"),
            self.x.title,
        );
        let fitted = self.panels.iter().any(|panel| all.iter().any(|s| self.exponent(s, panel).is_some()));
        let lines = if fitted {
            format!(
                "In brackets the exponents of the powers fitted to {PLACES} sizes or more, in the order of the panels."
            )
        } else {
            format!("Lines join the means of the sizes; an exponent needs {PLACES}.")
        };
        self.figure(self.name.to_owned(), &[counts, lines], all, runs)
    }

    /// Points of a series in a panel.
    fn points(&self, series: &Series, panel: &Panel) -> Points {
        let points = series.points(|run| f64::from((self.x.of)(run)), |run| (panel.of)(series, run));
        if panel.on_the_way { on_the_way(points) } else { points }
    }

    /// The exponent of the power of x fitted over enough places.
    fn exponent(&self, series: &Series, panel: &Panel) -> Option<f64> {
        let points = converged(&self.points(series, panel));
        let places = distinct(points.iter().map(|point| point.0));
        slope(&points).filter(|_| places >= PLACES)
    }

    /// Panels that have something to show: one of 10⁻² tells nothing where all runs stop there.
    fn drawn<'p>(&'p self, all: &[Series], runs: &'p [RunRow]) -> Vec<Drawn<'p>> {
        let shown = || all.iter().flat_map(|series| series.runs.iter().copied());
        let twice = |panel: &&Panel| panel.column == "to_natural_map_1e_2" && stopped_at_1e_2(shown());
        let mut panels: Vec<&Panel> = self.panels.iter().filter(|panel| !twice(panel)).collect();
        let has_points = |panel: &Panel| all.iter().any(|series| !self.points(series, panel).is_empty());
        if self.through == Through::Fit && panels.iter().any(|panel| has_points(panel)) {
            panels.retain(|panel| has_points(panel));
        }
        let of = |panel: &'p Panel, problem: Option<&'p str>| {
            let run = runs.iter().find(|run| problem.is_none_or(|problem| run.problem == problem));
            let grains = counted(run.map_or(0, |run| run.grains as usize), "grain");
            let title = panel.title.replace("{threads}", &threads(runs)).replace("{grains}", &grains);
            Drawn { panel, title, problem }
        };
        let problems = if self.each == Each::PanelOfProblem {
            problems(runs).into_iter().map(Some).collect()
        } else {
            vec![None]
        };
        panels.iter().flat_map(|panel| problems.iter().map(move |problem| of(panel, *problem))).collect()
    }

    /// A figure of series with all panels.
    pub(crate) fn figure(&self, name: String, title: &[String], all: &[Series], runs: &[RunRow]) -> Part {
        if all.len() > MOST_LINES {
            return too_many(name, &title.join("; "), all.len());
        }
        let panels = self.drawn(all, runs);
        let on = |series: &Series, drawn: &Drawn| {
            let mut here = series.clone();
            here.runs.retain(|run| drawn.problem.is_none_or(|problem| run.problem == problem));
            self.points(&here, drawn.panel)
        };
        // By panel, then by series.
        let clouds: Vec<Vec<Points>> =
            panels.iter().map(|panel| all.iter().map(|series| on(series, panel)).collect()).collect();
        let legend = self.legend(all, &panels, &clouds);
        let shared: Vec<&Points> = panels
            .iter()
            .zip(&clouds)
            .filter(|(drawn, _)| drawn.panel.ideal.is_some())
            .flat_map(|(_, clouds)| clouds)
            .collect();
        let columns = match panels.len() {
            4 => 2,
            count => count.clamp(1, 3),
        };
        let svg = grid(title, (columns, panels.len().div_ceil(columns)), &legend, |canvas, i, room| {
            let Some(drawn) = panels.get(i) else { return };
            let range = if drawn.panel.ideal.is_some() { shared.clone() } else { clouds[i].iter().collect() };
            self.panel(canvas, all, drawn, (&clouds[i], &range), room);
        });
        Part::figure(name, svg)
    }

    fn legend(&self, all: &[Series], panels: &[Drawn], clouds: &[Vec<Points>]) -> Legend {
        let exponents: Vec<Vec<Option<f64>>> = match self.through {
            Through::Points => Vec::new(),
            Through::Fit => all
                .iter()
                .map(|s| panels.iter().map(|drawn| self.exponent(s, drawn.panel)).collect())
                .collect(),
        };
        let fitted = exponents.iter().flatten().any(Option::is_some);
        let keyed = all.iter().enumerate().map(|(i, series)| {
            let mut label = series.label();
            if fitted {
                let texts: Vec<String> = exponents[i].iter().map(|e| rounded(*e)).collect();
                label = format!("{label} ({})", texts.join(", "));
            }
            let of_series: Vec<&Points> = clouds.iter().map(|clouds| &clouds[i]).collect();
            let level = clouds.iter().any(|clouds| self.level(series, &clouds[i], clouds).is_some());
            let joined = |points: &&Points| has_line(&on_the_way(joined(points)));
            let line = level || self.through == Through::Points && of_series.iter().any(joined);
            (label, series.look, of_series, line)
        });
        let (entries, mut signs) = key(keyed);
        let shown = clouds.iter().flatten().flatten();
        signs.extend(endings(shown.map(|(ending, _)| *ending).filter(|ending| *ending != Ending::Converged)));
        let ideals = panels.iter().zip(clouds).filter_map(|(drawn, clouds)| ideal(drawn.panel, clouds));
        let texts = unique(ideals.map(|(Ideal::X(text) | Ideal::One(text))| text));
        signs.extend(texts.into_iter().map(|text| (Sign::Line(TOLERANCE), text.to_owned())));
        let has_level =
            |clouds: &Vec<Points>| all.iter().zip(clouds).any(|(s, p)| self.level(s, p, clouds).is_some());
        if clouds.iter().any(has_level) {
            signs.push((Sign::Word, "Level lines: methods without subdomains.".to_owned()));
        }
        let said = self.notes.iter().filter(|(_, of)| of(all));
        signs.extend(said.map(|(note, _)| (Sign::Word, (*note).to_owned())));
        Legend::new(entries, signs, INSIDE)
    }

    /// The value of a method that knows nothing of what varies, where others of the panel have several values of it.
    fn level(&self, series: &Series, points: &Points, clouds: &[Points]) -> Option<f64> {
        let varied = self.varied.first()?;
        let whole = series.runs.iter().all(|run| !run.settings.contains_key(*varied));
        let several = clouds.iter().flatten().any(|(_, (log, _))| *log > 0.0);
        match points.as_slice() {
            [(Ending::Converged, (_, value))] if whole && several => Some(*value),
            _ => None,
        }
    }

    /// A panel whose axes hold the points of `range`, and the ideal beside them.
    fn panel(
        &self,
        canvas: &Canvas,
        all: &[Series],
        drawn: &Drawn,
        (clouds, range): (&[Points], &[&Points]),
        room: Room,
    ) {
        let x = reach(range.iter().copied().flatten(), |point| point.0);
        let ideal = ideal(drawn.panel, clouds);
        let diagonal: Points = match ideal {
            Some(Ideal::X(_)) => {
                range.iter().copied().flatten().map(|&(ending, (log, _))| (ending, (log, log))).collect()
            }
            _ => Vec::new(),
        };
        let (mut low, mut high) = reach(range.iter().copied().flatten().chain(&diagonal), |point| point.1);
        if let Some(Ideal::One(_)) = ideal {
            (low, high) = (low.min(-AROUND_ONE), high.max(AROUND_ONE));
        }
        if self.through == Through::Fit {
            low -= BELOW / (1.0 - BELOW) * (high - low);
        }
        let y = (Scale::Ten, (low, high), drawn.title.as_str());
        let frame = room.frame(canvas, (self.x.scale, x, self.x.title), y);
        match ideal {
            Some(Ideal::X(_)) => frame.draw_diagonal(canvas),
            Some(Ideal::One(_)) => frame.across(canvas, 0.0, TOLERANCE),
            None => {}
        }
        if clouds.iter().all(Vec::is_empty) {
            return draw_empty(canvas, &frame);
        }
        if self.through == Through::Fit {
            draw_slopes(canvas, &frame);
        }
        for (series, points) in all.iter().zip(clouds) {
            match self.through {
                Through::Points => self.join(canvas, &frame, series, (points, clouds)),
                Through::Fit => {
                    let fit = fit(&converged(points)).map(|line| line.map(|point| frame.place(point)));
                    canvas.line(fit.as_ref().map_or(&[], |line| line.as_slice()), series.look.pen);
                }
            }
        }
        let signs: Vec<_> =
            all.iter().zip(clouds).map(|(series, points)| (series.look, points.as_slice())).collect();
        draw_signs(canvas, &frame, &signs);
    }

    /// The line of a series, thin to runs that made all their iterations and would need more.
    fn join(&self, canvas: &Canvas, frame: &Frame, series: &Series, (points, clouds): (&Points, &[Points])) {
        let pen = series.look.pen;
        if let Some(value) = self.level(series, points, clouds) {
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

    /// The table of a fit, with a row for each series.
    fn exponents(&self, all: &[Series], runs: &[RunRow]) -> Part {
        let verdicts = Verdicts::of(runs);
        let failed =
            |series: &Series| series.runs.iter().filter(|run| !verdicts.is_right(run)).count() as u64;
        let mut columns = vec![
            Column::new("method".into(), all.iter().map(Series::label).collect::<Vec<_>>()),
            Column::new("runs".into(), all.iter().map(|s| s.runs.len() as u64).collect::<Vec<_>>()),
            Column::new("failed".into(), all.iter().map(failed).collect::<Vec<_>>()),
        ];
        columns.extend(self.panels.iter().map(|panel| {
            let values: Vec<Option<f64>> = all.iter().map(|series| self.exponent(series, panel)).collect();
            Column::new(format!("{}_exponent", panel.column).into(), values)
        }));
        let table = frame(polars::prelude::DataFrame::new(all.len(), columns));
        Part::table(self.name, table, self.note.replace("{WORK}", WORK))
    }
}

/// Points that a line goes through.
fn joined(points: &Points) -> Points {
    let joins = |ending| matches!(ending, Ending::Converged | Ending::IterationLimit);
    points.iter().filter(|(ending, _)| joins(*ending)).copied().collect()
}

fn converged(points: &Points) -> Vec<(f64, f64)> {
    points.iter().filter(|(ending, _)| *ending == Ending::Converged).map(|(_, point)| *point).collect()
}

/// The ideal of a panel; one in proportion to x needs a run at x = 1 that it is measured by.
fn ideal(panel: &Panel, clouds: &[Points]) -> Option<Ideal> {
    let has_one = || clouds.iter().flatten().any(|(_, (log, _))| *log == 0.0);
    panel.ideal.filter(|ideal| matches!(ideal, Ideal::One(_)) || has_one())
}

/// An exponent as a key has it; no zero has a sign.
fn rounded(exponent: Option<f64>) -> String {
    let text = exponent.map_or("–".to_owned(), |e| format!("{e:.2}"));
    text.replace("-0.00", "0.00").replace('-', "−")
}

/// The slopes to compare with, from one place below the points.
fn draw_slopes(canvas: &Canvas, frame: &Frame) {
    let (wide, high) = (frame.x.high - frame.x.low, frame.y.high - frame.y.low);
    let from = (frame.x.low + 0.4 * wide, frame.y.low + 0.03 * high);
    for ((slope, text), lower) in SLOPES.into_iter().zip([1.2, -1.2]) {
        let run = (0.3 * wide).min(0.8 * BELOW * high / slope);
        let to = frame.place((from.0 + run, from.1 + slope * run));
        canvas.line(&[frame.place(from), to], TOLERANCE);
        canvas.text(text, (to.0 + 0.6, to.1 + lower), TICK_TEXT, (HPos::Left, VPos::Center));
    }
}

/// Ends of the fitted line over the places that there are; of two it joins the means.
fn fit(points: &[(f64, f64)]) -> Option<[(f64, f64); 2]> {
    let slope = slope(points)?;
    let (low, high) = span(points.iter().map(|point| point.0))?;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    Some([low, high].map(|at| (at, y + slope * (at - x))))
}
