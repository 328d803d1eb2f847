//! The best direction and the derived one against the number of grains.

use super::field::Field;
use crate::draw::{
    BLACK, Canvas, DERIVED, Frame, INK, INSIDE, Legend, Mark, Pen, Place, Scale, Sign, draw_empty, row,
};
use crate::read::{counted, median, number, padded};

const MEDIAN: Pen = Pen::solid(BLACK, 0.3);
const MEDIAN_DERIVED: Pen = Pen { color: INK, width: 0.3, dash: &[1.6, 0.8] };
const MEDIAN_ADAPTIVE: Pen = Pen { color: BLACK, width: 0.3, dash: &[0.3, 0.6] };
const BEST_POINT: Pen = Pen::solid(BLACK, 0.25);

/// Points with their grains; each a logarithm.
type Points = Vec<(f64, f64)>;

/// Left: best and derived κ_l, one point per problem and group. Right: iterations of the derived over the best.
pub(crate) fn figure(fields: &[Field]) -> String {
    let points = |of: &dyn Fn(&Field) -> Option<f64>| -> Points {
        let log = |field: &Field| Some((f64::from(field.grains.max(1)).log10(), of(field)?.log10()));
        fields.iter().filter_map(log).filter(|(_, y)| y.is_finite()).collect()
    };
    let best = points(&|field| field.best().map(|cell| cell.kappa_l));
    let derived = points(&|field| field.kappa.map(|(l, _)| l));
    let ratios = points(&|field| field.ratio(field.derived));
    let adaptive = points(&|field| field.ratio(field.adaptive));
    let legend = Legend::new(Vec::new(), signs(&best, &derived, (&ratios, &adaptive)), INSIDE);
    let grains = padded(best.iter().chain(&derived).map(|p| p.0), 0.15);
    let x = (Scale::Ten, grains, "grains");
    row(&[head(fields)], 2, &legend, |canvas, i, room| {
        if i == 0 {
            let kappa = padded(best.iter().chain(&derived).map(|p| p.1), 0.1);
            let frame = room.frame(canvas, x, (Scale::Ten, kappa, "κ_l, at contacts (–)"));
            draw(canvas, &frame, &derived, (Mark::Diamond, DERIVED), MEDIAN_DERIVED);
            return draw(canvas, &frame, &best, (Mark::Ring, BEST_POINT), MEDIAN);
        }
        let times = padded(ratios.iter().chain(&adaptive).map(|p| p.1).chain([0.0]), 0.05);
        let frame = room.frame(canvas, x, (Scale::Ten, times, "iterations over those of the best (–)"));
        draw(canvas, &frame, &ratios, (Mark::Diamond, DERIVED), MEDIAN_DERIVED);
        if !adaptive.is_empty() {
            draw(canvas, &frame, &adaptive, (Mark::Cross, BEST_POINT), MEDIAN_ADAPTIVE);
        }
    })
}

/// A point per problem, and a line through the medians of equal numbers of grains.
fn draw(canvas: &Canvas, frame: &Frame, points: &Points, (mark, pen): (Mark, Pen), line: Pen) {
    if points.is_empty() {
        return draw_empty(canvas, frame);
    }
    let places: Vec<Place> = medians(points).into_iter().map(|point| frame.place(point)).collect();
    canvas.line(&places, line);
    for &point in points {
        canvas.mark(mark, frame.place(point), pen);
    }
}

fn medians(points: &Points) -> Points {
    let mut xs: Vec<f64> = points.iter().map(|point| point.0).collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup();
    let of = |x: f64| points.iter().filter(|point| point.0 == x).map(|point| point.1).collect();
    xs.into_iter().filter_map(|x| Some((x, median(of(x))?))).collect()
}

fn head(fields: &[Field]) -> String {
    let (first, run) = (&fields[0], fields[0].cells.first().map(|cell| cell.run));
    let stop = run.and_then(|run| Some(format!(", iterations to {}", run.rule()?)));
    let runs = fields.iter().map(|field| field.cells.len()).sum();
    format!(
        "{}: {}, {}{}",
        first.method,
        counted(fields.len(), "problem"),
        counted(runs, "run"),
        stop.unwrap_or_default()
    )
}

/// Signs of what is drawn: a single number of grains has medians, and no line through them.
fn signs(best: &Points, derived: &Points, (ratios, adaptive): (&Points, &Points)) -> Vec<(Sign, String)> {
    let mut signs = Vec::new();
    let mut entry = |points: &[&Points], (mark, pen), text: &str, line: Pen, median: &str| {
        if points.iter().any(|points| !points.is_empty()) {
            signs.push((Sign::Mark(mark, pen), text.to_owned()));
        }
        if points.iter().any(|points| medians(points).len() > 1) {
            signs.push((Sign::Line(line), median.to_owned()));
        }
    };
    entry(&[best], (Mark::Ring, BEST_POINT), "best of the grid, one per problem", MEDIAN, "their median");
    entry(&[derived, ratios], (Mark::Diamond, DERIVED), "derived", MEDIAN_DERIVED, "median of the derived");
    let adapted = "derived, then adapted";
    entry(&[adaptive], (Mark::Cross, BEST_POINT), adapted, MEDIAN_ADAPTIVE, "median of the adapted");
    for (what, points) in [("derived", ratios), ("adapted", adaptive)] {
        let text =
            |(x, y): (f64, f64)| format!("{} at {:.0} grains", number(10f64.powf(y), 3), 10f64.powf(x));
        let texts: Vec<String> = medians(points).into_iter().map(text).collect();
        if !texts.is_empty() {
            signs.push((Sign::Word, format!("Median ratio, {what}: {}.", texts.join(", "))));
        }
    }
    signs
}
