//! Runs of one method that agree in all but what a chart varies, as a series of points.

use std::collections::BTreeMap;

use crate::draw::{Canvas, Frame, HPos, Look, Looks, Place, Sign, TEXT, VPos};
use crate::read::{Ending, RunRow, differing, padded, settings_text};

/// Lines of a key, and its signs.
type Key = (Vec<(String, Look)>, Vec<(Sign, String)>);

/// Look of a series, and its points.
type Drawn<'p> = (Look, &'p [(Ending, (f64, f64))]);

/// Points of a series: how the run ended, logarithms of x and y.
pub(crate) type Points = Vec<(Ending, (f64, f64))>;

/// Marks all points as converged: they were reached, however the run ended later.
pub(crate) fn on_the_way(points: Points) -> Points {
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

/// All series in the order of the study; runs of one may differ in the settings `varied`. Every one has a sign.
pub(crate) fn series<'r>(runs: impl IntoIterator<Item = &'r RunRow>, varied: &[&str]) -> Vec<Series<'r>> {
    let runs: Vec<&RunRow> = runs.into_iter().collect();
    let (keys, looks) = (
        differing(runs.iter().map(|run| (&run.method, &run.settings)), varied),
        Looks::new(runs.iter().copied()),
    );
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
        let look = if one_method {
            looks.variant_alone(&run.method, *earlier)
        } else {
            looks.variant(&run.method, *earlier)
        };
        *earlier += 1;
        known.insert((&run.method, group.clone()), all.len());
        all.push(Series { method: &run.method, group, look: look.signed(), runs: vec![run] });
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

/// Reports whether points that converged have at least two x: a line then joins or fits them.
pub(crate) fn has_line(points: &[(Ending, (f64, f64))]) -> bool {
    let mut xs = points.iter().filter(|(ending, _)| *ending == Ending::Converged).map(|(_, (x, _))| *x);
    xs.next().is_some_and(|first| xs.any(|x| x != first))
}

/// The key of series, each with its points in all panels: lines with their signs; signs alone where no line is drawn; words
/// where there is nothing.
pub(crate) fn key<'p>(series: impl Iterator<Item = (String, Look, Vec<&'p Points>, bool)>) -> Key {
    let (mut lines, mut signs) = (Vec::new(), Vec::new());
    for (label, look, panels, line) in series {
        if line || panels.iter().any(|points| has_line(points)) {
            lines.push((label, look));
        } else if panels.iter().any(|points| !points.is_empty()) {
            signs.push((Sign::Mark(look.mark, look.pen), label));
        } else {
            signs.push((Sign::Word, label + ": no value"));
        }
    }
    (lines, signs)
}

/// The signs of all series: that of the method for a run that converged, that of its ending for another. What no line
/// passes through comes last, and beside what it would cover.
pub(crate) fn draw_signs(canvas: &Canvas, frame: &Frame, all: &[Drawn]) {
    let mut taken = Vec::new();
    for (look, points) in all.iter().filter(|(_, points)| has_line(points)) {
        for (_, point) in points.iter().filter(|(ending, _)| *ending == Ending::Converged) {
            let place = frame.place(*point);
            canvas.mark(look.mark, place, look.pen);
            taken.push(place);
        }
    }
    for (look, points) in all {
        let joined = has_line(points);
        for (ending, point) in points.iter().filter(|(e, _)| !joined || *e != Ending::Converged) {
            let place = free(&taken, frame.place(*point), frame);
            match ending {
                Ending::Converged => canvas.mark(look.mark, place, look.pen),
                failed => canvas.ending(*failed, place, look.pen.color),
            }
            taken.push(place);
        }
    }
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

/// Said in a panel without points.
pub(crate) fn draw_empty(canvas: &Canvas, frame: &Frame) {
    canvas.text("no value", frame.middle(), TEXT, (HPos::Center, VPos::Center));
}
