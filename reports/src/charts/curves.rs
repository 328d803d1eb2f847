//! Charts of the samples of runs, "measure against cost or measure", each of them one declaration.

use contact::Measure;

use crate::draw::{
    At, Curve, Guide, LOWEST, Lines, LogPoint, Look, MOST_LINES, Mark, PARETO, Panel, Plot, RGBColor, Scale,
    Side, Sign, TOLERANCE, Through, log, range, title,
};
use crate::read::{ACCURACIES, Problems, RunRow, Sample, file_name, number, padded, problems, rising};
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
    Cost(fn(&RunRow, &Sample) -> Option<f64>),
    Measure(Measure),
}

/// A declared chart.
pub(super) struct Curves {
    /// Name of its figures.
    pub(super) name: &'static str,
    /// First line of its figures.
    pub(super) title: &'static str,
    /// The axes of its panels, to the right and upwards.
    pub(super) panels: &'static [(Sampled, Sampled)],
    /// True where it needs a known solution; of many runs then the best alone are told apart.
    pub(super) of_truth: bool,
    /// True where the x axis is the velocity error: curves that go up and down are bands, and a line is where measure and error are equal.
    pub(super) against_error: bool,
    /// True where a run has the value of a sample until the next one; false where values are joined.
    pub(super) stairs: bool,
    /// Said in the key.
    pub(super) key: &'static [&'static str],
}

impl Sampled {
    /// The logarithm at a sample, where it has a place; `None` inside where it is undefined.
    fn at(&self, run: &RunRow, point: &Sample) -> Option<Log> {
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
                _ => Part::figure(name, self.plot(&lines, &[problem]).svg()),
            });
        }
        let few = all.iter().all(|problem| lines.runs_of(problem).len() <= MOST_LINES);
        let plot = (!self.of_truth && few).then(|| self.plot(&lines, &all)).filter(Plot::fits_a_page);
        parts.extend(plot.map(|plot| Part::figure(self.name, plot.svg()).beside_the_page()));
        parts
    }

    fn plot(&self, study: &Lines, problems: &[&str]) -> Plot {
        let of_problem = |problem: &&str| title(problem, &study.runs_of(problem));
        let several = problems.len() > 1;
        let mut panels = Vec::new();
        for (problem, (x, y)) in
            problems.iter().flat_map(|of| self.panels.iter().map(move |panel| (of, panel)))
        {
            let of = if several { format!("{problem}: ") } else { String::new() };
            let name = if several || self.panels.len() > 2 { y.short } else { y.title };
            panels.push(self.panel(study, problem, (x, y), of + name));
        }
        let mut signs: Vec<(Sign, String)> = Vec::new();
        if self.of_truth && !self.against_error {
            signs.push((
                Sign::Line(PARETO),
                "Pareto front: no run reaches this error at lower cost".to_owned(),
            ));
        }
        signs.extend(self.key.iter().map(|key| (Sign::Word, (*key).to_owned())));
        for problem in problems {
            if self.of_truth {
                signs.extend(study.others(problem));
                continue;
            }
            let begun = |run: &&RunRow| run.has_converged() && run.iterations == 0;
            signs.extend(study.runs_of(problem).into_iter().filter(begun).map(|run| {
                (Sign::Word, format!("{} on {problem}: converged at its start, no line", run.label()))
            }));
        }
        let title = std::iter::once(self.title.to_owned()).chain(problems.iter().map(of_problem)).collect();
        let columns = if self.panels.len() == 1 { 0 } else { self.panels.len() };
        Plot { title, panels, signs, columns, ..Plot::default() }
    }

    fn panel(&self, study: &Lines, problem: &str, (x, y): (&Sampled, &Sampled), name: String) -> Panel {
        let runs = study.runs_of(problem);
        let at = |run: &RunRow, point: &Sample| {
            // At its start a run has measured nothing. An error of 0 is at the end of the axis, not beyond all others.
            let (to, up) = (x.at(run, point)?, y.at(run, point)?);
            let is_begun = point.iteration > 0 || !self.against_error;
            is_begun.then(|| {
                to.zip(up).map(|(to, up)| (if self.against_error { to.max(LOWEST) } else { to }, up))
            })
        };
        let mut lines = if self.of_truth { study.lines_of_best(&runs, at) } else { study.lines(&runs, at) };
        if self.stairs {
            for line in &mut lines {
                line.points = stairs(&line.points);
            }
        }
        let stopped = |run: &&&RunRow| y.is(run.stop_on.0);
        let (tolerances, key) = match (self.of_truth, self.against_error) {
            (_, true) => (Vec::new(), "measure = velocity error; below it the measure is the smaller"),
            (true, _) => (ACCURACIES.to_vec(), "accuracies of the tables"),
            (false, _) => {
                let asked = runs.iter().filter(stopped).filter_map(|run| run.tolerance);
                (rising(asked.filter(|tolerance| *tolerance > 0.0)), "stopping tolerance")
            }
        };
        let reached = |of: fn(&(f64, f64)) -> f64| {
            lines
                .iter()
                .flat_map(move |line| line.points.iter().flatten().map(move |at| (line.ending, of(at))))
        };
        let costs = runs.iter().flat_map(|run| run.curve.iter().filter_map(|point| x.at(run, point)));
        let wide = match x.of {
            Of::Measure(_) => range(reached(|at| at.0), &[]),
            Of::Cost(_) => padded(costs.flatten(), 0.05),
        };
        let high = range(reached(|at| at.1), if self.of_truth { &[] } else { &tolerances });
        let mut areas = Vec::new();
        for line in lines.iter_mut().filter(|_| self.against_error) {
            if let Some(Band { low, high, middle }) = Band::of(&line.points, wide.1 - wide.0) {
                line.points = middle;
                areas.push((
                    pale(line.look.pen.color),
                    high.into_iter().chain(low.into_iter().rev()).collect(),
                ));
            }
        }
        let beside = |tolerance| if self.of_truth { String::new() } else { number(tolerance, 2) };
        let tolerances =
            tolerances.into_iter().filter(|tolerance| (high.0..high.1).contains(&tolerance.log10()));
        let across = tolerances.map(|t| (At::Y(t.log10()), beside(t)));
        let equal = self.against_error.then(|| (At::Diagonal, "measure < error below".to_owned()));
        let guides = across.chain(equal);
        let guides = guides.map(|(at, beside)| Guide { beside, ..Guide::new(at, TOLERANCE, key) });
        let points =
            lines.iter().flat_map(|line| &line.points).filter(|_| self.of_truth && !self.against_error);
        let clamped = |(x, y): (f64, f64)| (x.clamp(wide.0, wide.1), y.clamp(high.0, high.1));
        let front = front(points).into_iter().map(clamped);
        let front = Curve::of("", Look { pen: PARETO, mark: Mark::None }, front, Through::Points);
        let side = |name: String, range| Side { range: Some(range), ..Side::new(Scale::Ten, name) };
        let panel = Panel::new(side(x.title.to_owned(), wide), side(name, high), vec![front]);
        Panel { lines, areas, ..panel.guided(guides) }
    }
}

/// A colour on its way to white.
fn pale(RGBColor(r, g, b): RGBColor) -> RGBColor {
    let pale = |c: u8| 255 - (255 - c) / 4;
    RGBColor(pale(r), pale(g), pale(b))
}

/// The points of a line with a corner between each two: the first value holds until the next.
fn stairs(points: &[LogPoint]) -> Vec<LogPoint> {
    let corner = |(before, next): (&LogPoint, &LogPoint)| before.zip(*next).map(|((_, y), (x, _))| (x, y));
    let mut all = Vec::with_capacity(2 * points.len());
    for (k, point) in points.iter().enumerate() {
        all.extend(k.checked_sub(1).and_then(|k| corner((&points[k], point))).map(Some));
        all.push(*point);
    }
    all
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
