//! Axes, and the frame that two of them span. A logarithmic axis is one of logarithms to base ten.

use crate::draw::{Canvas, FRAME, GRID, HPos, LEADING, Pen, Place, TEXT, TICK_TEXT, VPos};
use crate::read::{number, power_of_ten};

/// Lengths of ticks at powers of ten and between them (mm).
const MAJOR_TICK: f64 = 1.1;
const MINOR_TICK: f64 = 0.6;
/// Labels nearer to each other than this (mm) are hard to read.
const LABEL_PITCH: f64 = 6.5;
/// An axis that is shorter (in logarithms) has room for more labels than one, two and five times a power.
const SHORT_AXIS: f64 = 0.5;
/// Width of a digit of a label, and the room between two labels (mm).
const DIGIT: f64 = 1.4;
const APART: f64 = 1.0;

/// Meaning of the coordinates of an axis, which sets its ticks.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Scale {
    /// Logarithms, with powers of ten.
    Ten,
    /// Logarithms to base ten too, with powers of two.
    Two,
    /// Shares from 0 to 1.
    Share,
    /// −log₁₀(2 − ω), with ω at the ticks: what matters of a relaxation is how near it is to 2.
    Relaxation,
}

impl Scale {
    /// The coordinate of ω on [`Scale::Relaxation`].
    pub(crate) fn of_relaxation(omega: f64) -> f64 {
        -(2.0 - omega).log10()
    }
}

/// A range of coordinates on a length of paper (mm).
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    pub(crate) scale: Scale,
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

impl Axis {
    /// A logarithmic axis with powers of ten.
    pub(crate) fn log((low, high): (f64, f64), from: f64, to: f64) -> Self {
        Self { scale: Scale::Ten, low, high, from, to }
    }

    /// Returns the position of a coordinate on paper.
    pub(crate) fn place(&self, log: f64) -> f64 {
        self.from + (log - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    fn holds(&self, log: f64) -> bool {
        // Round-off must not lose the power at an end.
        (self.low - 1e-9..=self.high + 1e-9).contains(&log)
    }

    /// Logarithms of the powers of ten on the axis.
    fn decades(&self) -> Vec<i32> {
        (self.low.floor() as i32..=self.high.ceil() as i32).filter(|e| self.holds(f64::from(*e))).collect()
    }

    /// The labels with their logarithms: powers of ten in steps that keep labels apart; where there are fewer than two,
    /// some of their multiples too.
    pub(crate) fn labels(&self) -> Vec<(f64, String)> {
        match self.scale {
            Scale::Ten => self.powers_of_ten(),
            Scale::Two => self.powers_of_two(),
            Scale::Share => {
                // Quarters, or tenths where there is room for few of them.
                let parts = if self.high - self.low < 0.6 { 10 } else { 4 };
                (0..=parts)
                    .map(|k| f64::from(k) / f64::from(parts))
                    .filter(|share| self.holds(*share))
                    .map(|share| (share, share.to_string()))
                    .collect()
            }
            Scale::Relaxation => [0.0, 1.0, 1.5, 1.8, 1.9, 1.95, 1.98, 1.99, 1.995, 1.998, 1.999]
                .map(|omega| (Scale::of_relaxation(omega), omega.to_string()))
                .into_iter()
                .filter(|(place, _)| self.holds(*place))
                .collect(),
        }
    }

    /// In steps that keep them apart.
    fn powers_of_two(&self) -> Vec<(f64, String)> {
        let octave = 2f64.log10();
        let power = |exponent: u32| (f64::from(exponent) * octave, (1_u64 << exponent).to_string());
        let held: Vec<u32> = (0..32).filter(|exponent| self.holds(f64::from(*exponent) * octave)).collect();
        let digits = held.last().map_or(0, |last| power(*last).1.len());
        let pitch = (self.place(octave) - self.place(0.0)).abs();
        let step = ((DIGIT * digits as f64 + APART) / pitch).ceil() as u32;
        held.into_iter().filter(|exponent| exponent.is_multiple_of(step.max(1))).map(power).collect()
    }

    fn powers_of_ten(&self) -> Vec<(f64, String)> {
        let decades = self.decades();
        if decades.len() < 2 {
            return self.labels_between();
        }
        let pitch = (self.place(1.0) - self.place(0.0)).abs();
        let step = (LABEL_PITCH / pitch).ceil() as i32;
        let labelled = decades.into_iter().filter(|exponent| exponent % step == 0);
        labelled.map(|exponent| (f64::from(exponent), power_of_ten(exponent))).collect()
    }

    fn labels_between(&self) -> Vec<(f64, String)> {
        let multiples = |multiples: &[f64]| -> Vec<(f64, String)> {
            let powers =
                (self.low.floor() as i32..=self.high.ceil() as i32).map(|exponent| 10f64.powi(exponent));
            let values =
                powers.flat_map(|power| multiples.iter().map(move |m| (m * power, m.fract() == 0.0)));
            let digits = |whole| if whole { 1 } else { 2 };
            let labels = values.map(|(value, whole)| (value.log10(), number(value, digits(whole))));
            labels.filter(|(log, _)| self.holds(*log)).collect()
        };
        let few = multiples(&[1.0, 2.0, 5.0]);
        let more = multiples(&[1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0]);
        match (few.len(), more.len()) {
            (0 | 1, 0 | 1) => multiples(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
            (2, 3..) if self.high - self.low < SHORT_AXIS => more,
            (0 | 1, _) => more,
            _ => few,
        }
    }

    /// Places of the ticks at 2, 3 … 9 times a power of ten.
    fn minor_places(&self) -> Vec<f64> {
        let first = self.low.floor() as i32;
        let logs = (first..=self.high.ceil() as i32)
            .flat_map(|exponent| (2..10).map(move |m| f64::from(exponent) + f64::from(m).log10()));
        logs.filter(|log| self.holds(*log)).map(|log| self.place(log)).collect()
    }

    /// Places of the ticks at powers of ten, and between them, with their lengths.
    pub(crate) fn ticks(&self) -> Vec<(f64, f64)> {
        if self.scale != Scale::Ten {
            return self.labels().into_iter().map(|(at, _)| (self.place(at), MAJOR_TICK)).collect();
        }
        let major = self.decades().into_iter().map(|e| (self.place(f64::from(e)), MAJOR_TICK));
        major.chain(self.minor_places().into_iter().map(|place| (place, MINOR_TICK))).collect()
    }
}

/// A panel: an axis to the right, one upwards.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
}

/// On which side of a panel's edge the ticks are.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Ticks {
    Inside,
    Outside,
}

impl Frame {
    /// Returns the position on paper of a point given by its logarithms.
    pub(crate) fn place(&self, (x, y): (f64, f64)) -> Place {
        (self.x.place(x), self.y.place(y))
    }

    /// Its middle, for a word instead of a curve.
    pub(crate) fn middle(&self) -> Place {
        (f64::midpoint(self.x.from, self.x.to), f64::midpoint(self.y.from, self.y.to))
    }

    /// The ends of the line on which both axes have the same value, if it is in the frame.
    pub(crate) fn diagonal(&self) -> Option<[Place; 2]> {
        let (low, high) = (self.x.low.max(self.y.low), self.x.high.min(self.y.high));
        (low < high).then(|| [low, high].map(|at| self.place((at, at))))
    }

    /// A line at one height (its logarithm), from edge to edge.
    pub(crate) fn across(&self, canvas: &Canvas, at: f64, pen: Pen) {
        let y = self.y.place(at);
        canvas.line(&[(self.x.from, y), (self.x.to, y)], pen);
    }

    /// Grid, ticks and their labels; what is drawn next lies above them.
    pub(crate) fn draw(&self, canvas: &Canvas) {
        for (log, _) in self.x.labels() {
            let x = self.x.place(log);
            canvas.line(&[(x, self.y.from), (x, self.y.to)], GRID);
        }
        for (log, _) in self.y.labels() {
            let y = self.y.place(log);
            canvas.line(&[(self.x.from, y), (self.x.to, y)], GRID);
        }
        self.draw_border(canvas, Ticks::Inside);
        self.label_x(canvas, Ticks::Inside);
        self.label_y(canvas, Ticks::Inside);
    }

    /// Edges and ticks alone.
    pub(crate) fn draw_border(&self, canvas: &Canvas, ticks: Ticks) {
        let (left, right, bottom, top) = (self.x.from, self.x.to, self.y.from, self.y.to);
        let inwards = if ticks == Ticks::Inside { 1.0 } else { -1.0 };
        for (x, length) in self.x.ticks() {
            canvas.line(&[(x, bottom), (x, bottom - inwards * length)], FRAME);
        }
        for (y, length) in self.y.ticks() {
            canvas.line(&[(left, y), (left + inwards * length, y)], FRAME);
        }
        canvas.line(&[(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)], FRAME);
    }

    pub(crate) fn label_x(&self, canvas: &Canvas, ticks: Ticks) {
        let y = self.y.from + 0.8 + room(ticks);
        for (log, text) in self.x.labels() {
            canvas.text(&text, (self.x.place(log), y), TICK_TEXT, (HPos::Center, VPos::Top));
        }
    }

    pub(crate) fn label_y(&self, canvas: &Canvas, ticks: Ticks) {
        let x = self.x.from - 0.9 - room(ticks);
        for (log, text) in self.y.labels() {
            canvas.text(&text, (x, self.y.place(log)), TICK_TEXT, (HPos::Right, VPos::Center));
        }
    }

    /// The names of both axes: below, and above the upper left corner.
    pub(crate) fn name(&self, canvas: &Canvas, x: &str, y: &str) {
        let below = (self.middle().0, self.y.from + 0.8 + LEADING);
        canvas.text(x, below, TEXT, (HPos::Center, VPos::Top));
        canvas.text(y, (self.x.from, self.y.to - 0.8), TEXT, (HPos::Left, VPos::Bottom));
    }
}

/// Returns the room that ticks take beside a panel (mm).
fn room(ticks: Ticks) -> f64 {
    if ticks == Ticks::Outside { MAJOR_TICK } else { 0.0 }
}

#[cfg(test)]
mod tests;
