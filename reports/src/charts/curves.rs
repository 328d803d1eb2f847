//! Charts of the samples of runs, "measure against cost or measure", each of them one declaration.

use contact::Measure;

use crate::draw::{
    Axis, Canvas, Frame, HPos, INSIDE, LOWEST, Line, Lines, LogPoint, MOST_LINES, PARETO, Place, RGBColor,
    Room, Scale, Sign, TICK_TEXT, TOLERANCE, VPos, draw_lines, fits_a_page, grid, log, range, text_width,
    title,
};
use crate::read::{ACCURACIES, Point, Problems, RunRow, file_name, number, padded, problems};
use crate::text::{Part, nothing, too_many};

use super::band::Band;

/// A logarithm; `None` where its value is undefined.
type Log = Option<f64>;

/// A quantity of a sample.
pub(super) struct Sampled {
    /// Name of its axis, and one for panels with little room.
    pub(super) title: &'static str,
    pub(super) short: &'static str,
    pub(super) of: Of,
}

pub(super) enum Of {
    /// A cost: samples without any have no place.
    Cost(fn(&RunRow, &Point) -> Option<f64>),
    Measure(Measure),
}

/// A declared chart.
pub(super) struct Curves {
    /// Name of its figures.
    pub(super) name: &'static str,
    /// The axes of its panels, to the right and upwards.
    pub(super) panels: &'static [(Sampled, Sampled)],
    /// True where it needs a known solution; of many runs then the best alone are told apart.
    pub(super) of_truth: bool,
    /// True where below equal values a measure promises too much, and curves that go up and down are bands.
    pub(super) promises: bool,
    /// Said in the key.
    pub(super) key: &'static [&'static str],
}

/// Curves of a panel, its ranges, and the bands behind them.
struct Shown {
    lines: Vec<Line>,
    bands: Vec<(RGBColor, Band)>,
    x: (f64, f64),
    y: (f64, f64),
    tolerances: Vec<f64>,
}

impl Sampled {
    /// The logarithm at a sample, where it has a place; `None` inside where it is undefined.
    fn at(&self, run: &RunRow, point: &Point) -> Option<Log> {
        match self.of {
            Of::Cost(of) => of(run, point).filter(|cost| *cost > 0.0).map(|cost| Some(log(cost))),
            Of::Measure(measure) => Some(point.get(measure).map(log)),
        }
    }

    fn is(&self, measure: Measure) -> bool {
        matches!(self.of, Of::Measure(own) if own == measure)
    }
}

impl Curves {
    /// A figure for each problem, and one of all of them if a page holds that many; a sentence where there is none.
    pub(super) fn parts(&self, study: &Problems) -> Vec<Part> {
        let lines = Lines::of(&study.runs);
        let mut all = problems(&study.runs);
        all.retain(|problem| !self.of_truth || lines.knows_truth(problem));
        if all.is_empty() && !self.of_truth {
            return vec![nothing(self.name, self.name, "no run in this study")];
        }
        let mut parts = Vec::new();
        for problem in &all {
            let (name, count) =
                (format!("{}-{}", self.name, file_name(problem)), lines.runs_of(problem).len());
            parts.push(match count {
                many if many > MOST_LINES => too_many(name, problem, many),
                _ => Part::figure(name, self.figure(&lines, &[problem])),
            });
        }
        let few = all.iter().all(|problem| lines.runs_of(problem).len() <= MOST_LINES);
        if !self.of_truth && few && fits_a_page(all.len(), self.legend(&lines, &all).height()) {
            parts.push(Part::figure(self.name, self.figure(&lines, &all)).beside_the_page());
        }
        parts
    }

    /// A row of panels per problem, with one legend below.
    fn figure(&self, study: &Lines, problems: &[&str]) -> String {
        let titles: Vec<String> =
            problems.iter().map(|problem| title(problem, &study.runs_of(problem))).collect();
        let columns = self.panels.len();
        let several = problems.len() > 1;
        grid(&titles, (columns, problems.len()), &self.legend(study, problems), |canvas, i, room| {
            let ((x, y), problem) = (&self.panels[i % columns], problems[i / columns]);
            let of = if several { format!("{problem}: ") } else { String::new() };
            let name = if several || columns > 2 { y.short } else { y.title };
            self.draw(canvas, &self.shown(study, problem, (x, y)), (x.title, &(of + name)), room);
        })
    }

    /// One entry per kind of run, the signs, and the runs that have no line since nothing was left to do.
    fn legend(&self, study: &Lines, problems: &[&str]) -> crate::draw::Legend {
        let runs: Vec<&RunRow> = problems.iter().flat_map(|problem| study.runs_of(problem)).collect();
        let mut signs: Vec<(Sign, String)> = Vec::new();
        if self.of_truth && !self.promises {
            signs.push((Sign::Line(PARETO), "Pareto front: nothing is cheaper and as accurate".to_owned()));
        }
        let of_line = match (self.of_truth, self.promises) {
            (_, true) => "measure = velocity error; below it the measure promises too much",
            (true, _) => "accuracies of the tables",
            (false, _) => "stopping tolerance",
        };
        signs.push((Sign::Line(TOLERANCE), of_line.to_owned()));
        signs.extend(self.key.iter().map(|key| (Sign::Word, (*key).to_owned())));
        if self.of_truth {
            return study.legend_of_best(&runs, signs, INSIDE);
        }
        let begun = runs.iter().filter(|run| run.has_converged() && run.iterations == 0);
        signs.extend(begun.map(|run| {
            (Sign::Word, format!("{} on {}: converged at its start, no line", run.label(), run.problem))
        }));
        study.legend(&runs, signs, INSIDE)
    }

    fn shown(&self, study: &Lines, problem: &str, (x, y): (&Sampled, &Sampled)) -> Shown {
        let runs = study.runs_of(problem);
        let at = |run: &RunRow, point: &Point| {
            // At its start a run has measured nothing. An error of 0 is at the end of the axis, not beyond all others.
            let (to, up) = (x.at(run, point)?, y.at(run, point)?);
            let is_begun = point.iteration > 0 || !self.promises;
            is_begun.then(|| to.zip(up).map(|(to, up)| (if self.promises { to.max(LOWEST) } else { to }, up)))
        };
        let mut lines = if self.of_truth { study.lines_of_best(&runs, at) } else { study.lines(&runs, at) };
        let stopped = |run: &&&RunRow| run.stopping_measure().is_some_and(|measure| y.is(measure));
        let mut tolerances: Vec<f64> = if self.promises {
            Vec::new()
        } else if self.of_truth {
            ACCURACIES.to_vec()
        } else {
            runs.iter().filter(stopped).filter_map(|run| run.tolerance).collect()
        };
        tolerances.retain(|tolerance| tolerance.is_finite() && *tolerance > 0.0);
        tolerances.sort_by(f64::total_cmp);
        tolerances.dedup();
        let turn = |line: &Line| Line {
            points: line.points.iter().map(|point: &LogPoint| point.map(|(x, y)| (y, x))).collect(),
            ..*line
        };
        let costs = runs.iter().flat_map(|run| run.curve.iter().filter_map(|point| x.at(run, point)));
        let x = match x.of {
            Of::Measure(_) => range(&lines.iter().map(turn).collect::<Vec<_>>(), &[]),
            Of::Cost(_) => padded(costs.flatten(), 0.05),
        };
        let y = range(&lines, if self.of_truth { &[] } else { &tolerances });
        let mut bands = Vec::new();
        for line in lines.iter_mut().filter(|_| self.promises) {
            if let Some(mut band) = Band::of(&line.points, x.1 - x.0) {
                line.points = std::mem::take(&mut band.middle);
                bands.push((pale(line.look.pen.color), band));
            }
        }
        Shown { lines, bands, x, y, tolerances }
    }

    fn draw(&self, canvas: &Canvas, shown: &Shown, (x, y): (&str, &str), room: Room) {
        let frame = room.frame(canvas, (Scale::Ten, shown.x, x), (Scale::Ten, shown.y, y));
        let clamped = |axis: &Axis, at: f64| axis.place(at.clamp(axis.low, axis.high));
        let place = |(x, y): &(f64, f64)| -> Place { (clamped(&frame.x, *x), clamped(&frame.y, *y)) };
        for (color, band) in &shown.bands {
            let edge = band.high.iter().chain(band.low.iter().rev());
            canvas.polygon(&edge.map(place).collect::<Vec<_>>(), *color, None);
        }
        for tolerance in shown.tolerances.iter().filter(|t| (shown.y.0..shown.y.1).contains(&t.log10())) {
            frame.across(canvas, tolerance.log10(), TOLERANCE);
            if !self.of_truth {
                let beside = (frame.x.from + 1.0, frame.y.place(tolerance.log10()) - 0.2);
                canvas.text(&number(*tolerance, 2), beside, TICK_TEXT, (HPos::Left, VPos::Bottom));
            }
        }
        if self.promises {
            draw_promises(canvas, &frame);
        } else if self.of_truth {
            let front = front(shown.lines.iter().flat_map(|line| &line.points));
            canvas.line(&front.iter().map(place).collect::<Vec<_>>(), PARETO);
        }
        draw_lines(canvas, &frame, &shown.lines);
    }
}

/// The diagonal, and in the corner below it, where the curves of an honest measure do not come, what it means.
fn draw_promises(canvas: &Canvas, frame: &Frame) {
    const TEXT: &str = "promises too much";
    frame.draw_diagonal(canvas);
    if frame.diagonal().is_some() {
        let place = (frame.x.to - text_width(TEXT, TICK_TEXT) - 1.5, frame.y.from - 1.6);
        canvas.text(TEXT, place, TICK_TEXT, (HPos::Left, VPos::Bottom));
    }
}

/// A colour on its way to white.
fn pale(RGBColor(r, g, b): RGBColor) -> RGBColor {
    let pale = |c: u8| 255 - (255 - c) / 4;
    RGBColor(pale(r), pale(g), pale(b))
}

/// Corners of the stairs below which no sample lies, from the cheapest to the most accurate.
fn front<'p>(points: impl Iterator<Item = &'p LogPoint>) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = points.copied().flatten().collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut stairs: Vec<(f64, f64)> = Vec::new();
    for (x, y) in points {
        match stairs.last() {
            Some(&(_, lowest)) if y >= lowest => {}
            Some(&(_, lowest)) => stairs.extend([(x, lowest), (x, y)]),
            None => stairs.push((x, y)),
        }
    }
    stairs
}

#[cfg(test)]
mod tests;
