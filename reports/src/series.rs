//! Runs of one method that agree in all but what a chart varies, as a series of points.

use std::collections::BTreeMap;

use plotters::style::text_anchor::{HPos, VPos};

use crate::ReportError;
use crate::axis::Frame;
use crate::canvas::Canvas;
use crate::ending::Ending;
use crate::groups::{differing, settings_text};
use crate::legend::{Look, Looks};
use crate::rows::RunRow;
use crate::statistics::padded;
use crate::style::{DASHES, Mark, Pen, TEXT, WHITE};

/// Points of a series: how the run ended, logarithms of x and y.
pub(crate) type Points = Vec<(Ending, (f64, f64))>;

/// The same of something that was reached, however the run ended later.
pub(crate) fn reached(points: Points) -> Points {
    points.into_iter().map(|(_, point)| (Ending::Converged, point)).collect()
}

/// The runs of a method with the same settings.
#[derive(Clone)]
pub(crate) struct Series<'r> {
    pub(crate) method: &'r str,
    /// The settings in which it differs from the method's other series.
    pub(crate) group: String,
    pub(crate) look: Look,
    pub(crate) runs: Vec<&'r RunRow>,
}

/// All series in the order of the study; runs of one may differ in the settings `varied`.
pub(crate) fn series<'r>(runs: &'r [RunRow], varied: &[&str]) -> Vec<Series<'r>> {
    let (keys, looks) =
        (differing(runs.iter().map(|run| (&run.method, &run.settings)), varied), Looks::new(runs));
    let one_method = runs.windows(2).all(|pair| pair[0].method == pair[1].method);
    let mut all: Vec<Series> = Vec::new();
    let mut known: BTreeMap<(&str, String), usize> = BTreeMap::new();
    let mut of_method: BTreeMap<&str, usize> = BTreeMap::new();
    for run in runs {
        let group = settings_text(run, &keys);
        if let Some(&index) = known.get(&(run.method.as_str(), group.clone())) {
            all[index].runs.push(run);
            continue;
        }
        let earlier = of_method.entry(&run.method).or_default();
        // Where there is one method alone, colours and marks tell its settings apart as well.
        let (pen, mark) = if one_method { Looks::nth(*earlier) } else { looks.method(&run.method) };
        let look = Look { pen: Pen { dash: DASHES[*earlier % DASHES.len()], ..pen }, mark };
        *earlier += 1;
        known.insert((&run.method, group.clone()), all.len());
        all.push(Series { method: &run.method, group, look, runs: vec![run] });
    }
    all
}

impl Series<'_> {
    pub(crate) fn label(&self) -> String {
        if self.group.is_empty() {
            self.method.to_owned()
        } else {
            format!("{}, {}", self.method, self.group)
        }
    }

    /// Logarithms of x and y of its runs, by x; those without are left out.
    pub(crate) fn points(&self, x: impl Fn(&RunRow) -> f64, y: impl Fn(&RunRow) -> Option<f64>) -> Points {
        let point = |run: &&RunRow| Some((run.ending, (x(run).log10(), y(run)?.log10())));
        let finite = |(_, (x, y)): &(Ending, (f64, f64))| x.is_finite() && y.is_finite();
        let mut points: Vec<_> = self.runs.iter().filter_map(point).filter(finite).collect();
        points.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        points
    }
}

/// Range of the x or y of points, with room.
pub(crate) fn reach<'p>(
    points: impl Iterator<Item = &'p (Ending, (f64, f64))>,
    of: fn(&(f64, f64)) -> f64,
) -> (f64, f64) {
    padded(points.map(|(_, point)| of(point)), 0.08)
}

/// The signs of a series: that of its method for a run that converged, that of its ending for another.
pub(crate) fn draw_points(
    canvas: &Canvas,
    frame: &Frame,
    look: Look,
    points: &[(Ending, (f64, f64))],
) -> Result<(), ReportError> {
    for (ending, point) in points {
        let place = frame.place(*point);
        match (ending, look.mark) {
            (Ending::Converged, Mark::None) => {
                let edge = Pen { color: WHITE, width: 0.1, dash: &[] };
                canvas.disc(place, 0.7, look.pen.color, Some(edge))?;
            }
            (Ending::Converged, mark) => canvas.mark(mark, place, look.pen)?,
            (failed, _) => failed.draw(canvas, place, look.pen.color)?,
        }
    }
    Ok(())
}

/// Said in a panel without points.
pub(crate) fn draw_empty(canvas: &Canvas, frame: &Frame) -> Result<(), ReportError> {
    canvas.text("no value", frame.middle(), TEXT, (HPos::Center, VPos::Center))
}
