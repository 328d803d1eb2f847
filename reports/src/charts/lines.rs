//! Charts "y against x by series", each of them one declaration in `declared.rs`: its x, its panels, what sets its series apart,
//! figures, lines or fits, ideals, and the columns of its table.

use polars::prelude::{Column, DataFrame};

use super::quantities::{Quantity, named, table};
use crate::draw::{
    At, Curve, DASHES, Guide, MOST_LINES, Panel, Pen, Plot, Points, Scale, Series, Side, Sign, TOLERANCE,
    Through, series, title,
};
use crate::read::{
    Ending, Mean, Problems, RunRow, Verdicts, WORK, counted, file_name, find_or_push, problems,
    stopped_at_1e_2, threads, unique,
};
use crate::text::{Part, frame, nothing, too_many};

/// A declared chart. Quantities stand by their names.
#[derive(Clone, Copy)]
pub(crate) struct Lines {
    /// Name of its table, and begin of those of its figures.
    pub(crate) name: &'static str,
    /// Name of its figures, if that is another.
    pub(crate) figures: &'static str,
    /// First line of its figures.
    pub(crate) title: &'static str,
    /// The quantity on the x axis.
    pub(crate) x: &'static str,
    /// The quantities on the y axes, a panel each.
    pub(crate) y: &'static str,
    /// The setting in which the runs of a series may differ.
    pub(crate) varied: &'static str,
    /// Name that sets series of a method apart beside its settings, of a run; dashes tell it.
    pub(crate) apart: Option<fn(&RunRow) -> String>,
    pub(crate) each: Each,
    pub(crate) through: Through,
    /// The runs that it is of.
    pub(crate) of: fn(&RunRow) -> bool,
    /// Panels with a line to compare with.
    pub(crate) ideals: &'static [(&'static str, Ideal)],
    /// Said in the key.
    pub(crate) key: &'static str,
    /// Columns of the table with a row per run; without any there is a row per series, with the exponents of fits.
    pub(crate) columns: &'static str,
    /// Below the table.
    pub(crate) note: &'static str,
}

/// A line to compare with.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Ideal {
    /// As many times as x says, measured by a run at x = 1.
    X(&'static str),
    /// As many times as x says, where all runs had as many threads.
    OnThreads(&'static str),
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

/// Fewer places than this have no exponent: through two points every power fits.
const PLACES: usize = 3;
/// Half the height of an axis around an ideal of one, at least (logarithm).
const AROUND_ONE: f64 = 0.35;

impl Lines {
    fn x(&self) -> &'static Quantity {
        named(self.x).expect("a declared quantity has a name")
    }

    /// Makes its figures and its table.
    pub(crate) fn parts(&self, study: &Problems) -> Vec<Part> {
        let all = self.series(study.runs.iter().filter(|run| (self.of)(run)).collect());
        let mut made = all.clone();
        for series in &mut made {
            series.runs.retain(|run| run.status != Ending::Skipped);
        }
        let mut parts = Vec::new();
        if self.each == Each::Problem {
            for problem in problems(all.iter().flat_map(|series| series.runs.iter().copied())) {
                let mut here = made.clone();
                for series in &mut here {
                    series.runs.retain(|run| run.problem == problem);
                }
                here.retain(|series| !series.runs.is_empty());
                let shown: Vec<&RunRow> =
                    here.iter().flat_map(|series| series.runs.iter().copied()).collect();
                parts.push(self.figure(
                    &format!("-{}", file_name(problem)),
                    title(problem, &shown),
                    &here,
                    study,
                ));
            }
        } else {
            parts.push(self.of_study(&made, study));
        }
        parts.push(if self.columns.is_empty() {
            self.exponents(&made, &study.runs)
        } else {
            Part::table(self.name, table(&all, self.columns), self.note)
        });
        parts
    }

    /// The series; where something else sets them apart, of several cases these too, those of several x, with what comes most
    /// often, as many as there are dashes.
    fn series<'r>(&self, runs: Vec<&'r RunRow>) -> Vec<Series<'r>> {
        let whole = series(runs.iter().copied(), &[self.varied]);
        let Some(apart) = self.apart else { return whole };
        let case = |run: &RunRow| run.case().map(str::to_owned);
        let several = unique(runs.iter().map(|run| case(run))).len() > 1;
        let apart = |run: &RunRow| {
            let words = [case(run).filter(|_| several), Some(apart(run)).filter(|words| !words.is_empty())];
            words.into_iter().flatten().collect::<Vec<_>>().join(", ")
        };
        let mut often: Vec<(String, usize)> = Vec::new();
        for run in runs {
            find_or_push(&mut often, |(of, _)| *of == apart(run), || (apart(run), 0)).1 += 1;
        }
        if often.iter().all(|(name, _)| name.is_empty()) {
            return whole;
        }
        often.sort_by_key(|(_, runs)| std::cmp::Reverse(*runs));
        // Numbers in a name by their size.
        often.truncate(DASHES.len());
        often.sort_by_key(|(name, _)| (name.len(), name.clone()));
        let mut all = Vec::new();
        for (series, ((name, _), dash)) in
            whole.iter().flat_map(|s| often.iter().zip(DASHES).map(move |o| (s, o)))
        {
            let mut own = series.clone();
            own.runs.retain(|run| apart(run) == *name);
            own.across = true;
            own.group = [&series.group, name]
                .into_iter()
                .filter(|t| !t.is_empty())
                .cloned()
                .collect::<Vec<_>>()
                .join(", ");
            own.look.pen = Pen { dash, ..own.look.pen };
            if unique(own.runs.iter().map(|run| (self.x().of)(&own, run).map(f64::to_bits))).len() > 1 {
                all.push(own);
            }
        }
        all
    }

    /// The figure of all problems; a sentence where x has a single value.
    fn of_study(&self, all: &[Series], study: &Problems) -> Part {
        let shown = || all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run)));
        let xs = unique(shown().filter_map(|(series, run)| (self.x().of)(series, run)));
        let (x, found) = (self.x().title, format!("{}-found", self.name));
        if xs.len() < 2 {
            let same = xs.first().map_or("no run".to_owned(), |n| {
                format!("every problem has {}", counted(*n as usize, x.trim_end_matches('s')))
            });
            return nothing(found, self.name, &format!("{same}, and cost has nothing to grow with"));
        }
        let n = if self.through == Through::Fit { ", n" } else { "" };
        let counts = format!(
            "{}, {}, {} of {x}{n}",
            counted(problems(shown().map(|(_, run)| run)).len(), "problem"),
            counted(shown().count(), "run"),
            counted(xs.len(), "number"),
        );
        self.figure("", counts, all, study)
    }

    /// The panels, each of a quantity, on all problems or on one; one of 10⁻² tells nothing where all runs stop there.
    fn panels<'p>(&self, all: &[Series], runs: &'p [RunRow]) -> Vec<(&'static Quantity, Option<&'p str>)> {
        let shown = || all.iter().flat_map(|series| series.runs.iter().copied());
        let quantities = self.y.split_whitespace().filter_map(named);
        let quantities = quantities.filter(|y| y.name != "to_natural_map_1e_2" || !stopped_at_1e_2(shown()));
        let problems = match self.each {
            Each::PanelOfProblem => problems(runs).into_iter().map(Some).collect(),
            Each::Problem | Each::Study => vec![None],
        };
        quantities.flat_map(|quantity| problems.iter().map(move |problem| (quantity, *problem))).collect()
    }

    /// Points of a series, on one problem or on all.
    fn points(&self, series: &Series, y: &Quantity, problem: Option<&str>) -> Points {
        let on = series.runs.iter().filter(|run| problem.is_none_or(|problem| run.problem == problem));
        let point = |run: &&RunRow| {
            let ending = if y.on_the_way { Ending::Converged } else { run.status };
            Some((ending, ((self.x().of)(series, run)?.log10(), (y.of)(series, run)?.log10())))
        };
        let finite = |(_, (x, y)): &(Ending, (f64, f64))| x.is_finite() && y.is_finite();
        let mut points: Points = on.filter_map(point).filter(finite).collect();
        points.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        points
    }

    /// A figure of series with all panels.
    fn figure(&self, of: &str, title: String, all: &[Series], study: &Problems) -> Part {
        let name = if self.figures.is_empty() { self.name } else { self.figures };
        if all.len() > MOST_LINES {
            let name = if of.is_empty() { format!("{name}-found") } else { format!("{name}{of}") };
            return too_many(name, &title, all.len());
        }
        let fitting = self.through == Through::Fit;
        let mut panels: Vec<Panel> = Vec::new();
        for (y, problem) in self.panels(all, &study.runs) {
            let mut curves: Vec<Curve> = Vec::new();
            for series in all {
                let points = self.points(series, y, problem);
                curves.push(Curve::new(series.label(), series.look, points, self.through));
            }
            // A method that knows nothing of what varies, where others of the panel have several values of it.
            let several = curves.iter().flat_map(|curve| &curve.points).any(|(_, (log, _))| *log > 0.0);
            for (series, curve) in all.iter().zip(&mut curves) {
                let varies = series.runs.iter().any(|run| run.settings.contains_key(self.varied));
                if self.x == self.varied
                    && !varies
                    && several
                    && matches!(*curve.points, [(Ending::Converged, _)])
                {
                    curve.through = Through::Level;
                }
            }
            let run = study.runs.iter().find(|run| problem.is_none_or(|problem| run.problem == problem));
            let grains = counted(run.map_or(0, |run| run.grains as usize), "grain");
            let title = y.title.replace("{threads}", &threads(&study.runs)).replace("{grains}", &grains);
            let fewest = study.runs.iter().map(|run| run.provenance.threads).min();
            panels.push(self.panel(y, title, curves, fewest.unwrap_or(1)));
        }
        let mut titles = vec![self.title.to_owned(), title];
        let mut signs = Vec::new();
        if fitting {
            if !panels.iter().all(Panel::is_empty) {
                panels.retain(|panel| !panel.is_empty());
            }
            titles.push(bracket(&mut panels));
        }
        signs.extend((!self.key.is_empty()).then(|| (Sign::Word, self.key.to_owned())));
        Part::figure(format!("{name}{of}"), Plot { title: titles, panels, signs, ..Plot::default() }.svg())
    }

    fn panel(&self, y: &Quantity, title: String, curves: Vec<Curve>, threads: u32) -> Panel {
        let ideal = self.ideals.iter().find(|(name, _)| *name == y.name).map(|(_, ideal)| *ideal);
        let has_one = curves.iter().flat_map(|curve| &curve.points).any(|(_, (log, _))| *log == 0.0);
        let most =
            curves.iter().flat_map(|curve| &curve.points).fold(0.0, |most: f64, (_, (x, _))| most.max(*x));
        let has_threads = f64::from(threads).log10() >= most;
        let (guide, holds) = match ideal {
            Some(Ideal::X(key)) if has_one => (Some(Guide::new(At::Diagonal, TOLERANCE, key)), vec![]),
            Some(Ideal::OnThreads(key)) if has_one && has_threads => {
                (Some(Guide::new(At::Diagonal, TOLERANCE, key)), vec![])
            }
            Some(Ideal::One(key)) => {
                (Some(Guide::new(At::Y(0.0), TOLERANCE, key)), vec![-AROUND_ONE, AROUND_ONE])
            }
            _ => (None, vec![]),
        };
        let (x, y) = (Side::new(self.x().scale, self.x().title), Side::new(Scale::Ten, title).holding(holds));
        Panel { shared: ideal.is_some(), ..Panel::new(x, y, curves).guided(guide) }
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
        let curve = |y: &Quantity, series: &Series| {
            Curve::new("", series.look, self.points(series, y, None), self.through)
        };
        let fits = self.y.split_whitespace().filter_map(named);
        let fits = fits.map(|y| (y.name, all.iter().map(|series| curve(y, series)).collect::<Vec<_>>()));
        let fits: Vec<(&str, Vec<Curve>)> = fits.collect();
        columns.extend(fits.iter().map(|(name, curves)| {
            let exponents: Vec<Option<f64>> = curves.iter().map(|curve| curve.exponent(PLACES)).collect();
            Column::new(format!("{name}_exponent").into(), exponents)
        }));
        for (name, curves) in fits {
            let within: Vec<Option<Mean>> =
                curves.iter().map(|curve| curve.exponent_within(PLACES)).collect();
            let bound = |end: &str, of: fn(&Mean) -> f64| {
                let bounds: Vec<Option<f64>> = within.iter().map(|mean| mean.as_ref().map(of)).collect();
                Column::new(format!("{name}_exponent_{end}").into(), bounds)
            };
            columns.extend([bound("low", |mean| mean.low), bound("high", |mean| mean.high)]);
        }
        let table = frame(DataFrame::new(all.len(), columns));
        Part::table(self.name, table, self.note.replace("{WORK}", WORK))
    }
}

/// Adds the exponents of fits to the names of curves, where there are some, and says so.
fn bracket(panels: &mut [Panel]) -> String {
    let of_curve =
        |i: usize| panels.iter().map(move |panel| panel.curves[i].exponent(PLACES)).collect::<Vec<_>>();
    let all: Vec<Vec<Option<f64>>> =
        (0..panels.first().map_or(0, |p| p.curves.len())).map(of_curve).collect();
    if all.iter().flatten().all(Option::is_none) {
        return format!("Lines join the means of the sizes; an exponent needs {PLACES}.");
    }
    for panel in panels {
        for (curve, exponents) in panel.curves.iter_mut().zip(&all) {
            let texts: Vec<String> = exponents.iter().map(|exponent| rounded(*exponent)).collect();
            curve.label = format!("{} ({})", curve.label, texts.join(", "));
        }
    }
    format!(
        "In brackets the exponents of the powers fitted to {PLACES} sizes or more, in the order of the panels."
    )
}

/// An exponent as a key has it; no zero has a sign.
fn rounded(exponent: Option<f64>) -> String {
    let text = exponent.map_or("–".to_owned(), |e| format!("{e:.2}"));
    text.replace("-0.00", "0.00").replace('-', "−")
}
