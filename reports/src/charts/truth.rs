//! Measures against the truth: where a measure is smaller than the velocity error, it promises too much.

mod band;

use contact::Measure;

use super::against_truth::AgainstTruth;
use crate::draw::{
    Axis, Canvas, HPos, INSIDE, LOWEST, Line, Lines, LogPoint, Place, RGBColor, Room, Scale, Sign, TICK_TEXT,
    TOLERANCE, VPos, draw_lines, log, range, row, text_width, title,
};
use crate::read::{Point, Problems, RunRow, accuracy_text, number, span};
use crate::text::Part;
use band::Band;

/// A measure that every method can be stopped by: its name on an axis, and in a sentence.
type Named = (&'static str, &'static str, Measure);

const MEASURES: [Named; 3] = [
    ("ζ (–)", "ζ", Measure::Zeta),
    ("natural map (–)", "the natural map", Measure::NaturalMap),
    ("quadratic norm of LMGC90 (–)", "the quadratic norm", Measure::QuadDv),
];

/// The value of a measure at which the text says what it is worth.
const WORTH: f64 = 1e-4;

/// `truth-<problem>` for each problem, and `truth` with the errors behind a measure of 10⁻⁴.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let lacks = "no truth to compare with";
    AgainstTruth { name: "truth", lacks, figure, sentences, note: String::new() }.parts(study)
}

/// Content of a panel: lines, and behind them the bands of those that go up and down.
struct Shown {
    lines: Vec<Line>,
    bands: Vec<(RGBColor, Band)>,
    /// Ranges of the velocity error and of the measure.
    x: (f64, f64),
    y: (f64, f64),
}

fn figure(study: &Lines, problem: &str, runs: &[&RunRow]) -> String {
    let panels = MEASURES.each_ref().map(|measure| shown(study, runs, measure));
    let mut more = vec![(
        Sign::Line(TOLERANCE),
        "measure = velocity error; below it the measure promises too much".into(),
    )];
    if panels.iter().any(|shown| !shown.bands.is_empty()) {
        let text = "A band holds a curve that goes up and down; the line in it is the median.";
        more.push((Sign::Word, text.to_owned()));
    }
    let legend = study.legend_of_best(runs, more, INSIDE);
    row(&[title(problem, runs)], MEASURES.len(), &legend, |canvas, i, room| {
        panel(canvas, &panels[i], &MEASURES[i], room);
    })
}

fn shown(study: &Lines, runs: &[&RunRow], measure: &Named) -> Shown {
    let mut lines = study.lines_of_best(runs, |_, point| {
        // At its start a run has measured nothing. An error of 0 is at the end of the axis, not beyond all others.
        let pair = point.velocity_error().zip(point.get(measure.2));
        (point.iteration > 0).then(|| pair.map(|(error, measure)| (log(error).max(LOWEST), log(measure))))
    });
    let turn = |line: &Line| Line {
        points: line.points.iter().map(|point: &LogPoint| point.map(|(x, y)| (y, x))).collect(),
        ..*line
    };
    let x = range(&lines.iter().map(turn).collect::<Vec<_>>(), &[]);
    let y = range(&lines, &[]);
    let mut bands = Vec::new();
    for line in &mut lines {
        if let Some(mut band) = Band::of(&line.points, x.1 - x.0) {
            line.points = std::mem::take(&mut band.middle);
            bands.push((pale(line.look.pen.color), band));
        }
    }
    Shown { lines, bands, x, y }
}

/// A colour on its way to white.
fn pale(RGBColor(r, g, b): RGBColor) -> RGBColor {
    let pale = |c: u8| 255 - (255 - c) / 4;
    RGBColor(pale(r), pale(g), pale(b))
}

fn panel(canvas: &Canvas, Shown { lines, bands, x, y }: &Shown, measure: &Named, room: Room) {
    let name = "velocity error (–)";
    let frame = room.frame(canvas, (Scale::Ten, *x, name), (Scale::Ten, *y, measure.0));
    for (color, band) in bands {
        let edge = band.high.iter().chain(band.low.iter().rev());
        let inside = |at: f64, axis: &Axis| axis.place(at.clamp(axis.low, axis.high));
        let corners: Vec<Place> = edge.map(|(x, y)| (inside(*x, &frame.x), inside(*y, &frame.y))).collect();
        canvas.polygon(&corners, *color, None);
    }
    frame.draw_diagonal(canvas);
    if frame.diagonal().is_some() {
        // In the corner below the diagonal, where the curves of an honest measure do not come.
        let text = "promises too much";
        let place = (frame.x.to - text_width(text, TICK_TEXT) - 1.5, frame.y.from - 1.6);
        canvas.text(text, place, TICK_TEXT, (HPos::Left, VPos::Bottom));
    }
    draw_lines(canvas, &frame, lines);
}

fn sentences(study: &Lines, problem: &str) -> String {
    MEASURES.iter().map(|measure| sentence(study, problem, measure)).collect()
}

/// Between which velocity errors the runs are when the measure comes down to that value.
fn sentence(study: &Lines, problem: &str, measure: &Named) -> String {
    let small =
        |point: &&Point| point.iteration > 0 && point.get(measure.2).is_some_and(|value| value <= WORTH);
    let runs = study.runs_of(problem);
    let error = |run: &&RunRow| run.curve.iter().find(small)?.velocity_error();
    let errors: Vec<f64> = runs.iter().filter_map(error).collect();
    let (short, value) = (measure.1, accuracy_text(WORTH));
    match span(errors.iter().copied()) {
        Some((least, greatest)) => format!(
            "{problem}: where {short} is {value} for the first time, the velocity error is between {} and {} ({} of {} runs).\n",
            number(least, 2),
            number(greatest, 2),
            errors.len(),
            runs.len(),
        ),
        None => format!("{problem}: no run with a known velocity error brings {short} to {value}.\n"),
    }
}
