//! Which line is which run, below the panels and covering nothing; and what the ends of lines say.

use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};

use crate::ReportError;
use crate::canvas::{Canvas, Place, text_width};
use crate::rows::RunRow;
use crate::style::{DASHES, LEADING, METHODS, Mark, Pen, TEXT, TOLERANCE, WHITE};

/// Length of the sample of a line (mm).
const KEY: f64 = 9.0;
/// Between a key and its text, and between columns (mm).
const GAP: f64 = 1.3;
const COLUMN_GAP: f64 = 5.0;

/// How the curve of a run looks.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub(crate) pen: Pen,
    pub(crate) mark: Mark,
}

/// Looks for all runs of a study, so that a method looks the same on every problem.
pub(crate) struct Looks<'t> {
    /// Methods in the order of the study, each with its kinds of run in the order of their subdomains.
    methods: Vec<(&'t str, Vec<Kind<'t>>)>,
    /// Whether runs differ in how they begin.
    both_starts: bool,
}

/// Subdomains, variant, warm start: what tells two runs of a method on a problem apart.
type Kind<'t> = (u32, &'t str, bool);

fn kind(run: &RunRow) -> Kind<'_> {
    (run.subdomains, &run.variant, run.warm_start)
}

impl<'t> Looks<'t> {
    pub(crate) fn new(runs: &'t [RunRow]) -> Self {
        let mut methods: Vec<(&str, Vec<Kind>)> = Vec::new();
        for run in runs {
            let known = methods.iter().position(|(method, _)| *method == run.method);
            let index = known.unwrap_or_else(|| {
                methods.push((&run.method, Vec::new()));
                methods.len() - 1
            });
            let kinds = &mut methods[index].1;
            if !kinds.contains(&kind(run)) {
                kinds.push(kind(run));
            }
        }
        for (_, kinds) in &mut methods {
            // Stable: kinds with as many subdomains stay in the order of the study.
            kinds.sort_by_key(|&(subdomains, _, _)| subdomains);
        }
        let both_starts = runs.iter().any(|run| run.warm_start) && runs.iter().any(|run| !run.warm_start);
        Self { methods, both_starts }
    }

    /// Place of a run in the order of the legend.
    pub(crate) fn rank(&self, run: &RunRow) -> (usize, usize) {
        let method = self.methods.iter().position(|(method, _)| *method == run.method).unwrap_or(0);
        let place = |(_, kinds): &(&str, Vec<Kind>)| kinds.iter().position(|k| *k == kind(run));
        (method, self.methods.get(method).and_then(place).unwrap_or(0))
    }

    pub(crate) fn look(&self, run: &RunRow) -> Look {
        let (method, variant) = self.rank(run);
        let (pen, mark) = METHODS[method % METHODS.len()];
        Look { pen: Pen { dash: DASHES[variant % DASHES.len()], ..pen }, mark }
    }

    pub(crate) fn label(&self, run: &RunRow) -> String {
        let mut label = run.method.clone();
        if !run.variant.is_empty() {
            label.extend([" ", run.variant.as_str()]);
        }
        if self.both_starts && run.warm_start {
            label += ", warm start";
        }
        label
    }
}

/// How a run ended, as a sign at the end of its line.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Ending {
    Converged,
    IterationLimit,
    Failed,
}

impl Ending {
    pub(crate) fn of(status: &str) -> Self {
        match status {
            "converged" => Self::Converged,
            "iteration-limit" => Self::IterationLimit,
            _ => Self::Failed,
        }
    }

    pub(crate) fn draw(self, canvas: &Canvas, (x, y): Place, color: RGBColor) -> Result<(), ReportError> {
        const HALF: f64 = 0.85;
        let pen = Pen { color, width: 0.3, dash: &[] };
        match self {
            Self::Converged => {
                canvas.disc((x, y), 0.7, color, Some(Pen { color: WHITE, width: 0.1, dash: &[] }))
            }
            Self::IterationLimit => {
                canvas.polygon(&[(x, y - HALF), (x + 1.7 * HALF, y), (x, y + HALF)], WHITE, Some(pen))
            }
            Self::Failed => {
                let pen = Pen { width: 0.45, ..pen };
                canvas.line(&[(x - HALF, y - HALF), (x + HALF, y + HALF)], pen)?;
                canvas.line(&[(x - HALF, y + HALF), (x + HALF, y - HALF)], pen)
            }
        }
    }
}

/// Entries in columns, filled downwards so that the variants of a method stand together.
pub(crate) struct Legend {
    entries: Vec<(String, Look)>,
    rows: usize,
    /// Widths of the columns (mm).
    column: f64,
}

impl Legend {
    /// Lays entries out in a width (mm).
    pub(crate) fn new(entries: Vec<(String, Look)>, width: f64) -> Result<Self, ReportError> {
        let mut column = 0.0_f64;
        for (label, _) in &entries {
            column = column.max(KEY + GAP + text_width(label, TEXT)? + COLUMN_GAP);
        }
        let columns = if column > 0.0 { ((width / column) as usize).max(1) } else { 1 };
        Ok(Self { rows: entries.len().div_ceil(columns), entries, column })
    }

    /// Height with the line that explains the signs (mm).
    pub(crate) fn height(&self) -> f64 {
        LEADING * (self.rows + 1) as f64
    }

    pub(crate) fn draw(&self, canvas: &Canvas, (left, top): Place) -> Result<(), ReportError> {
        for (i, (label, look)) in self.entries.iter().enumerate() {
            let x = left + self.column * (i / self.rows) as f64;
            let y = top + LEADING * ((i % self.rows) as f64 + 0.5);
            canvas.line(&[(x, y), (x + KEY, y)], look.pen)?;
            canvas.mark(look.mark, (x + KEY / 2.0, y), look.pen)?;
            canvas.text(label, (x + KEY + GAP, y), TEXT, (HPos::Left, VPos::Center))?;
        }
        draw_signs(canvas, (left, top + LEADING * (self.rows as f64 + 0.5)))
    }
}

/// What the signs at the ends of lines and the thin dashed line mean.
fn draw_signs(canvas: &Canvas, (left, y): Place) -> Result<(), ReportError> {
    let color = TOLERANCE.color;
    let endings = [
        (Ending::Converged, "converged"),
        (Ending::IterationLimit, "iteration limit"),
        (Ending::Failed, "failed, or left the frame"),
    ];
    let mut x = left;
    canvas.text("ends:", (x, y), TEXT, (HPos::Left, VPos::Center))?;
    x += text_width("ends:", TEXT)? + 2.0 * GAP;
    for (ending, text) in endings {
        ending.draw(canvas, (x, y), color)?;
        x += 2.0 * GAP;
        canvas.text(text, (x, y), TEXT, (HPos::Left, VPos::Center))?;
        x += text_width(text, TEXT)? + COLUMN_GAP;
    }
    canvas.line(&[(x, y), (x + KEY, y)], TOLERANCE)?;
    canvas.text("stopping tolerance", (x + KEY + GAP, y), TEXT, (HPos::Left, VPos::Center))
}
