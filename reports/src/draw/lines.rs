//! The runs of a study with their curves and looks, and lines of them in a frame.

use std::collections::{BTreeMap, BTreeSet};

use contact::Measure;

use crate::draw::{
    Canvas, Frame, HPos, LogPoint, Look, Looks, Mark, OTHERS, Place, Sign, TEXT, VPos, along, inside,
};
use crate::read::{ACCURACIES, COSTS, Cost, Ending, RunRow, Sample, accuracy_text};

/// Data shared by all panels of a study: its runs and their looks.
pub(crate) struct Lines<'t> {
    pub(crate) runs: &'t [RunRow],
    pub(crate) looks: Looks<'t>,
}

/// More lines than these are not told apart at a glance.
const MOST_TOLD_APART: usize = 12;

/// The line of a run.
pub(crate) struct Line {
    /// Its name in the key; empty if it has none there.
    pub(crate) label: String,
    pub(crate) look: Look,
    pub(crate) ending: Ending,
    pub(crate) points: Vec<LogPoint>,
}

impl<'t> Lines<'t> {
    pub(crate) fn of(runs: &'t [RunRow]) -> Self {
        Self { runs, looks: Looks::new(runs) }
    }

    /// Reports whether some run on a problem was measured against a known solution.
    pub(crate) fn knows_truth(&self, problem: &str) -> bool {
        let known = |run: &&RunRow| run.curve.iter().any(|point| point.velocity_error().is_some());
        self.runs_of(problem).iter().any(known)
    }

    /// The runs on a problem in the order of the legend; one that was skipped has no line.
    pub(crate) fn runs_of(&self, problem: &str) -> Vec<&'t RunRow> {
        let has_line = |run: &&RunRow| run.problem == problem && run.status != Ending::Skipped;
        let mut runs: Vec<&RunRow> = self.runs.iter().filter(has_line).collect();
        runs.sort_by_cached_key(|run| self.looks.rank(run));
        runs
    }

    /// Says how many runs on a problem are grey, and why the others are not.
    pub(crate) fn others(&self, problem: &str) -> Option<(Sign, String)> {
        let runs = self.runs_of(problem);
        let others = runs.len() - best(&runs).len();
        let [coarser @ .., finest] = &ACCURACIES.map(accuracy_text);
        let coarser: Vec<&str> = coarser.iter().rev().map(String::as_str).collect();
        let text = format!(
            "{others} other runs. In colour: of each method the first to {finest} (else {}), in seconds and in work.",
            coarser.join(", ")
        );
        (others > 0).then_some((Sign::Line(OTHERS), text))
    }

    /// Returns the lines of [`Lines::lines`], with those of all but the best runs behind the others, and grey.
    pub(crate) fn lines_of_best(
        &self,
        runs: &[&RunRow],
        at: impl Fn(&RunRow, &Sample) -> Option<LogPoint>,
    ) -> Vec<Line> {
        let best = best(runs);
        let (coloured, others): (Vec<&RunRow>, Vec<&RunRow>) =
            runs.iter().partition(|run| best.contains(&run.run));
        let mut lines = self.lines(&others, &at);
        for line in &mut lines {
            (line.look, line.label) = (Look { pen: OTHERS, mark: Mark::None }, String::new());
        }
        lines.extend(self.lines(&coloured, at));
        lines
    }

    /// A line per run, through the points that `at` makes of its samples.
    pub(crate) fn lines(
        &self,
        runs: &[&RunRow],
        at: impl Fn(&RunRow, &Sample) -> Option<LogPoint>,
    ) -> Vec<Line> {
        let line = |run: &&RunRow| Line {
            label: run.label(),
            look: self.looks.look(run),
            ending: run.status,
            points: run.curve.iter().filter_map(|point| at(run, point)).collect(),
        };
        runs.iter().map(line).collect()
    }
}

/// Runs by their numbers, to be told apart among `runs`: all, if they are few; of many, of each method the first, in
/// each cost, to the finest accuracy that the method reaches, or else the one that ends nearest.
fn best(runs: &[&RunRow]) -> BTreeSet<u32> {
    if runs.len() <= MOST_TOLD_APART {
        return runs.iter().map(|run| run.run).collect();
    }
    let mut of_methods: BTreeMap<&str, Vec<&RunRow>> = BTreeMap::new();
    for run in runs {
        of_methods.entry(&run.method).or_default().push(run);
    }
    of_methods.values().flat_map(|runs| COSTS.iter().filter_map(|cost| first(runs, cost))).collect()
}

/// The number of the first run to the finest accuracy that any reaches, or of the one that ends nearest.
fn first(runs: &[&RunRow], cost: &Cost) -> Option<u32> {
    let least = |price: &dyn Fn(&RunRow) -> Option<f64>| {
        let priced = runs.iter().filter_map(|run| Some((price(run)?, run.run)));
        priced.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, run)| run)
    };
    let at = |accuracy: f64| least(&|run| cost.to(run, Measure::VelocityError, accuracy));
    let end = || least(&|run| run.curve.last()?.velocity_error());
    ACCURACIES.into_iter().rev().find_map(at).or_else(end)
}

/// Lines cut at the frame, with signs of their methods, and signs at their ends of how they ended.
pub(crate) fn draw_lines(canvas: &Canvas, frame: &Frame, lines: &[Line]) {
    const MARKS: usize = 3;
    let (mut drawn, mut ends) = (0, Vec::new());
    for (i, line) in lines.iter().enumerate() {
        let pieces = inside(&line.points, (frame.x.low, frame.x.high), (frame.y.low, frame.y.high));
        drawn += pieces.len();
        for piece in &pieces {
            let places: Vec<Place> = piece.iter().map(|&point| frame.place(point)).collect();
            canvas.line(&places, line.look.pen);
        }
        for k in 0..MARKS {
            // A phase of its own, so that signs of neighbours do not cover each other.
            let phase = (i as f64 + 0.5) / lines.len() as f64;
            if let Some(point) = along(&pieces, (k as f64 + phase) / MARKS as f64) {
                canvas.mark(line.look.mark, frame.place(point), line.look.pen);
            }
        }
        ends.extend(pieces.last().and_then(|piece| piece.last()).map(|&end| (line, end)));
    }
    // Above all lines, and failures above the rest.
    ends.sort_by_key(|(line, _)| line.ending != Ending::Converged);
    for (line, end) in ends {
        canvas.ending(line.ending, frame.place(end), line.look.pen.color);
    }
    if drawn == 0 {
        canvas.text("no value in this range", frame.middle(), TEXT, (HPos::Center, VPos::Center));
    }
}
