//! Panels of curves, declared by their axes, curves and guides; ranges and key follow from these.

use crate::draw::{
    Axis, Canvas, Frame, HPos, Legend, Line, Look, Pen, Place, RGBColor, Room, Scale, Sign, TEXT, TICK_TEXT,
    TOLERANCE, VPos, draw_lines, endings, fits_a_page, grid, inside_width, text_width,
};
use crate::own;
use crate::read::{
    Ending, Mean, OF_95, find_or_push, median, padded, rising, slope, slope_within, span, unique,
};

/// Points of a curve: how the run ended, and its place on the scales of the axes. One without bound is at the edge of its panel.
pub(crate) type Points = Vec<(Ending, (f64, f64))>;

/// A figure of panels with a key.
#[derive(Default)]
pub(crate) struct Plot {
    pub(crate) title: Vec<String>,
    pub(crate) panels: Vec<Panel>,
    /// Lines of the key before those of the curves.
    pub(crate) entries: Vec<(String, Look)>,
    /// Signs of the key after all others.
    pub(crate) signs: Vec<(Sign, String)>,
    /// Panels side by side; as many as suit their number where it is 0.
    pub(crate) columns: usize,
}

/// A frame with curves in it.
pub(crate) struct Panel {
    pub(crate) x: Side,
    pub(crate) y: Side,
    pub(crate) curves: Vec<Curve>,
    /// Lines of runs, above all else.
    pub(crate) lines: Vec<Line>,
    pub(crate) guides: Vec<Guide>,
    /// Areas below all else, with their colours.
    pub(crate) areas: Vec<(RGBColor, Vec<(f64, f64)>)>,
    /// Panels that share their axes have the range of all of them.
    pub(crate) shared: bool,
}

/// An axis: its scale and name, and the coordinates that its range holds beside those of the points; or its range as given.
pub(crate) struct Side {
    pub(crate) scale: Scale,
    pub(crate) name: String,
    pub(crate) holds: Vec<f64>,
    pub(crate) range: Option<(f64, f64)>,
}

/// Points of one look.
#[derive(Clone)]
pub(crate) struct Curve {
    /// Its name in the key; empty if it has none there.
    pub(crate) label: String,
    pub(crate) look: Look,
    pub(crate) points: Points,
    pub(crate) through: Through,
}

/// Line through the points of a curve.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Through {
    /// Line from point to point, thin to runs that made all their iterations and would need more.
    Points,
    /// Line through the medians of equal x.
    Medians,
    /// Power of x, fitted to the runs that converged.
    Fit,
    /// Level line: the only value, whatever x.
    Level,
    /// No line.
    Nothing,
}

/// A line to compare with.
#[derive(Clone)]
pub(crate) struct Guide {
    pub(crate) at: At,
    pub(crate) pen: Pen,
    /// Its name in the key; empty if it has none there.
    pub(crate) key: String,
    /// Words on it.
    pub(crate) beside: String,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum At {
    X(f64),
    Y(f64),
    /// Equal coordinates; panels that do not share their axes have the same range on both.
    Diagonal,
}

/// Slopes to compare fits with, as powers of x.
const SLOPES: [(f64, &str); 2] = [(0.5, "∝ √n"), (1.0, "∝ n")];
/// The part of a panel's height that is left to them.
const BELOW: f64 = 0.2;
/// Room at both ends of an axis, over the range of its points (–).
const ROOM: f64 = 0.08;

impl Side {
    pub(crate) fn new(scale: Scale, name: impl Into<String>) -> Self {
        Self { scale, name: name.into(), holds: Vec::new(), range: None }
    }

    pub(crate) fn holding(self, holds: impl IntoIterator<Item = f64>) -> Self {
        Self { holds: holds.into_iter().collect(), ..self }
    }
}

impl Guide {
    pub(crate) fn new(at: At, pen: Pen, key: impl Into<String>) -> Self {
        Self { at, pen, key: key.into(), beside: String::new() }
    }
}

impl Panel {
    pub(crate) fn new(x: Side, y: Side, curves: Vec<Curve>) -> Self {
        Self { x, y, curves, lines: Vec::new(), guides: Vec::new(), areas: Vec::new(), shared: false }
    }

    pub(crate) fn guided(self, guides: impl IntoIterator<Item = Guide>) -> Self {
        Self { guides: guides.into_iter().collect(), ..self }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.points().next().is_none()
    }

    fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let of_lines = self.lines.iter().flat_map(|line| line.points.iter().copied().flatten());
        self.curves.iter().flat_map(|curve| &curve.points).map(|(_, point)| *point).chain(of_lines)
    }

    fn fits(&self) -> bool {
        self.curves.iter().any(|curve| curve.through == Through::Fit)
    }

    /// Draws the panel with the ranges of `like`, itself among them.
    fn draw(&self, canvas: &Canvas, like: &[&Self], room: Room) {
        let points = || like.iter().flat_map(|panel| panel.points());
        let diagonal = self.guides.iter().any(|guide| guide.at == At::Diagonal);
        let other = |of: fn((f64, f64)) -> f64| points().filter(move |_| diagonal).map(of);
        let xs = points().map(|point| point.0).chain(self.x.holds.iter().copied());
        let x = padded(xs.chain(other(|point| point.1).filter(|_| !self.shared)), ROOM);
        let x = self.x.range.unwrap_or(x);
        let ys = points().map(|point| point.1).chain(self.y.holds.iter().copied());
        let mut y = self.y.range.unwrap_or_else(|| padded(ys.chain(other(|point| point.0)), ROOM));
        if self.fits() {
            y.0 -= BELOW / (1.0 - BELOW) * (y.1 - y.0);
        }
        let frame = room.frame(canvas, (self.x.scale, x, &self.x.name), (self.y.scale, y, &self.y.name));
        for (color, corners) in &self.areas {
            canvas.polygon(&corners.iter().map(|at| clamped(&frame, *at)).collect::<Vec<_>>(), *color, None);
        }
        for guide in &self.guides {
            guide.draw(canvas, &frame);
        }
        if self.is_empty() && self.lines.is_empty() {
            return canvas.text("no value", frame.middle(), TEXT, (HPos::Center, VPos::Center));
        }
        if self.fits() {
            draw_slopes(canvas, &frame);
        }
        for curve in &self.curves {
            curve.draw_line(canvas, &frame);
        }
        draw_signs(canvas, &frame, &self.curves);
        if !self.lines.is_empty() {
            draw_lines(canvas, &frame, &self.lines);
        }
    }
}

impl Guide {
    fn draw(&self, canvas: &Canvas, frame: &Frame) {
        match self.at {
            At::X(x) => {
                let x = frame.x.place(x);
                canvas.line(&[(x, frame.y.from), (x, frame.y.to)], self.pen);
            }
            At::Y(y) => {
                frame.across(canvas, y, self.pen);
                // Beside the ticks.
                let place = (frame.x.from + 2.0, frame.y.place(y) - 0.2);
                canvas.text(&self.beside, place, TICK_TEXT, (HPos::Left, VPos::Bottom));
            }
            At::Diagonal => {
                if let Some(ends) = frame.diagonal() {
                    canvas.line(&ends, self.pen);
                    let corner = (frame.x.to - 1.5, frame.y.from - 1.6);
                    canvas.text(&self.beside, corner, TICK_TEXT, (HPos::Right, VPos::Bottom));
                }
            }
        }
    }
}

impl Curve {
    pub(crate) fn new(label: impl Into<String>, look: Look, points: Points, through: Through) -> Self {
        Self { label: label.into(), look, points, through }
    }

    /// Its points, all of runs that converged.
    pub(crate) fn of(
        label: impl Into<String>,
        look: Look,
        points: impl IntoIterator<Item = (f64, f64)>,
        through: Through,
    ) -> Self {
        let points = points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite());
        Self::new(label, look, points.map(|point| (Ending::Converged, point)).collect(), through)
    }

    fn converged(&self) -> Vec<(f64, f64)> {
        let converged = self.points.iter().filter(|(ending, _)| *ending == Ending::Converged);
        converged.map(|(_, point)| *point).collect()
    }

    /// Exponent of the power of x fitted to the points that converged, if they have so many x.
    pub(crate) fn exponent(&self, places: usize) -> Option<f64> {
        let points = self.converged();
        slope(&points).filter(|_| rising(points.iter().map(|point| point.0)).len() >= places)
    }

    /// That exponent with its interval of 95 %, of six points or more.
    pub(crate) fn exponent_within(&self, places: usize) -> Option<Mean> {
        slope_within(&self.converged(), OF_95).filter(|_| self.exponent(places).is_some())
    }

    /// Points that a line joins, also thinly; none without bound.
    fn joined(&self) -> Vec<(f64, f64)> {
        let joins = |ending| matches!(ending, Ending::Converged | Ending::IterationLimit);
        let joined = self.points.iter().filter(|(ending, point)| joins(*ending) && point.1.is_finite());
        joined.map(|(_, point)| *point).collect()
    }

    /// Reports whether the key has a line of it.
    fn has_line(&self) -> bool {
        match self.through {
            Through::Nothing => false,
            Through::Level => true,
            Through::Points => several(&self.joined()),
            Through::Medians | Through::Fit => several(&self.converged()),
        }
    }

    fn draw_line(&self, canvas: &Canvas, frame: &Frame) {
        let pen = self.look.pen;
        let line = |points: Vec<(f64, f64)>, pen| {
            canvas.line(&points.iter().map(|point| frame.place(*point)).collect::<Vec<_>>(), pen);
        };
        match self.through {
            Through::Nothing => {}
            Through::Level => frame.across(canvas, self.points[0].1.1, pen),
            Through::Points => {
                line(self.joined(), Pen { width: 0.4 * pen.width, ..pen });
                line(self.converged(), pen);
            }
            Through::Medians => line(medians(&self.converged()), pen),
            Through::Fit => line(fit(&self.converged()), pen),
        }
    }
}

impl Plot {
    pub(crate) fn svg(&self) -> String {
        grid(&self.title, self.shape(), &self.legend(), |canvas, i, room| {
            let Some(panel) = self.panels.get(i) else { return };
            let shared = self.panels.iter().filter(|other| other.shared).collect::<Vec<_>>();
            panel.draw(canvas, if panel.shared { &shared[..] } else { std::slice::from_ref(&panel) }, room);
        })
    }

    /// A line for each name, a sign where no line is drawn, a word where there is nothing; how runs ended, the guides and the rest.
    /// Reports whether the panels have room on a page.
    pub(crate) fn fits_a_page(&self) -> bool {
        fits_a_page(self.shape().1, self.legend().height())
    }

    /// Returns how many panels side by side have room for their names.
    fn most_columns(&self) -> usize {
        let widths = self.panels.iter().map(|panel| text_width(&panel.y.name, TEXT));
        (inside_width() / widths.fold(1.0, f64::max)) as usize
    }

    /// Panels side by side, and rows of them.
    fn shape(&self) -> (usize, usize) {
        let columns = match (own::style().columns.unwrap_or(self.columns), self.panels.len()) {
            (0, 4) => 2,
            (0, count) => count.min(self.most_columns()).clamp(1, 3),
            (columns, _) => columns.min(self.most_columns()).max(1),
        };
        (columns, self.panels.len().div_ceil(columns))
    }

    fn legend(&self) -> Legend {
        let (mut lines, mut signs) = (self.entries.clone(), Vec::new());
        let runs = || {
            self.panels.iter().flat_map(|p| &p.lines).filter(|l| !(l.label.is_empty() || l.points.is_empty()))
        };
        for run in runs() {
            find_or_push(&mut lines, |(label, _)| *label == run.label, || (run.label.clone(), run.look));
        }
        let curves = || self.panels.iter().flat_map(|panel| &panel.curves);
        for label in unique(curves().map(|curve| curve.label.as_str())).into_iter().filter(|l| !l.is_empty())
        {
            let named: Vec<&Curve> = curves().filter(|curve| curve.label == label).collect();
            let look = named[0].look;
            if named.iter().any(|curve| curve.has_line()) {
                lines.push((label.to_owned(), look));
            } else if named.iter().any(|curve| !curve.points.is_empty()) {
                signs.push((Sign::Mark(look.mark, look.pen), label.to_owned()));
            } else {
                signs.push((Sign::Word, format!("{label}: no value")));
            }
        }
        let ended = curves().flat_map(|curve| &curve.points).map(|(ending, _)| *ending);
        let ended = ended.filter(|ending| *ending != Ending::Converged);
        signs.extend(endings(ended.chain(runs().map(|run| run.ending))));
        let guides =
            || self.panels.iter().flat_map(|panel| &panel.guides).filter(|guide| !guide.key.is_empty());
        for key in unique(guides().map(|guide| guide.key.as_str())) {
            signs
                .extend(guides().find(|guide| guide.key == key).map(|g| (Sign::Line(g.pen), key.to_owned())));
        }
        if curves().any(|curve| curve.through == Through::Level) {
            signs.push((Sign::Word, "Level lines: methods without the setting that varies.".to_owned()));
        }
        Legend::new(lines, signs.into_iter().chain(self.signs.clone()).collect(), inside_width())
    }
}

/// Reports whether points have at least two x.
fn several(points: &[(f64, f64)]) -> bool {
    points.iter().any(|(x, _)| *x != points[0].0)
}

/// The medians of equal x, by x.
pub(crate) fn medians(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let of = |x: f64| points.iter().filter(|point| point.0 == x).map(|point| point.1).collect();
    let xs = rising(points.iter().map(|point| point.0)).into_iter();
    xs.filter_map(|x| Some((x, median(of(x))?))).collect()
}

/// Ends of the fitted line over the places that there are; of two it joins the means.
fn fit(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let Some((slope, (low, high))) = slope(points).zip(span(points.iter().map(|point| point.0))) else {
        return Vec::new();
    };
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    [low, high].map(|at| (at, y + slope * (at - x))).to_vec()
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

/// The signs of all curves: that of the curve for a run that converged, that of its ending for another. What no line
/// passes through comes last, and beside what it would cover.
fn draw_signs(canvas: &Canvas, frame: &Frame, all: &[Curve]) {
    let place = |point| clamped(frame, point);
    let mut taken = Vec::new();
    let is_fixed = |curve: &Curve| curve.through == Through::Nothing || several(&curve.converged());
    for curve in all.iter().filter(|curve| is_fixed(curve)) {
        for point in curve.converged() {
            canvas.mark(curve.look.mark, place(point), curve.look.pen);
            taken.push(place(point));
        }
    }
    for curve in all {
        let fixed = is_fixed(curve);
        for (ending, point) in curve.points.iter().filter(|(e, _)| !fixed || *e != Ending::Converged) {
            let place = if point.1.is_finite() { free(&taken, place(*point), frame) } else { place(*point) };
            match ending {
                Ending::Converged => canvas.mark(curve.look.mark, place, curve.look.pen),
                failed => canvas.ending(*failed, place, curve.look.pen.color),
            }
            taken.push(place);
        }
    }
}

/// The place of a point, at the edge of the frame if it is beyond.
fn clamped(frame: &Frame, (x, y): (f64, f64)) -> Place {
    let clamped = |axis: &Axis, at: f64| axis.place(at.clamp(axis.low, axis.high));
    (clamped(&frame.x, x), clamped(&frame.y, y))
}

/// The place beside (x, y), in the frame, that is nearest to it and not under a sign.
fn free(taken: &[Place], (x, y): Place, frame: &Frame) -> Place {
    /// Two signs side by side (mm).
    const PITCH: f64 = 2.0;
    let apart = |place: &Place| taken.iter().all(|t| (t.0 - place.0).hypot(t.1 - place.1) > 0.95 * PITCH);
    let inside = |place: &Place| (frame.x.from + 1.0..=frame.x.to - 1.0).contains(&place.0);
    let beside = (1..=20).flat_map(|k| [1.0, -1.0].map(|side| (x + side * PITCH * f64::from(k), y)));
    std::iter::once((x, y)).chain(beside.filter(inside)).find(apart).unwrap_or((x, y))
}
