//! Logarithmic axes, and the frame that two of them span.

use plotters::style::text_anchor::{HPos, VPos};

use crate::ReportError;
use crate::canvas::{Canvas, Place};
use crate::number::power_of_ten;
use crate::style::{FRAME, GRID, TICK_TEXT};

/// Lengths of ticks at powers of ten and between them (mm).
const MAJOR_TICK: f64 = 1.1;
const MINOR_TICK: f64 = 0.6;
/// Labels nearer to each other than this (mm) are hard to read.
const LABEL_PITCH: f64 = 5.0;

/// A range of logarithms to base ten on a length of paper (mm).
pub(crate) struct LogAxis {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

impl LogAxis {
    /// Where a logarithm is on paper.
    pub(crate) fn place(&self, log: f64) -> f64 {
        self.from + (log - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// The powers of ten on the axis.
    fn decades(&self) -> std::ops::RangeInclusive<i32> {
        // Round-off must not lose the power at an end.
        (self.low - 1e-9).ceil() as i32..=(self.high + 1e-9).floor() as i32
    }

    /// The powers of ten that get a label, in steps that keep labels apart.
    fn labelled(&self) -> Vec<i32> {
        let pitch = (self.place(1.0) - self.place(0.0)).abs();
        let step = (LABEL_PITCH / pitch).ceil() as i32;
        self.decades().filter(|exponent| exponent % step == 0).collect()
    }

    /// Places of the ticks at 2, 3 … 9 times a power of ten.
    fn minor_places(&self) -> Vec<f64> {
        let first = self.low.floor() as i32;
        let logs = (first..=self.high.ceil() as i32)
            .flat_map(|exponent| (2..10).map(move |m| f64::from(exponent) + f64::from(m).log10()));
        logs.filter(|log| (self.low..=self.high).contains(log)).map(|log| self.place(log)).collect()
    }
}

/// A panel: iterations to the right, a measure upwards.
pub(crate) struct Frame {
    pub(crate) x: LogAxis,
    pub(crate) y: LogAxis,
}

impl Frame {
    /// Where a point, given by its logarithms, is on paper.
    pub(crate) fn place(&self, (x, y): (f64, f64)) -> Place {
        (self.x.place(x), self.y.place(y))
    }

    /// Grid, ticks and their labels; what is drawn next lies above them.
    pub(crate) fn draw(&self, canvas: &Canvas) -> Result<(), ReportError> {
        let (left, right, bottom, top) = (self.x.from, self.x.to, self.y.from, self.y.to);
        for exponent in self.x.decades() {
            let x = self.x.place(f64::from(exponent));
            canvas.line(&[(x, bottom), (x, top)], GRID)?;
            canvas.line(&[(x, bottom), (x, bottom - MAJOR_TICK)], FRAME)?;
        }
        for exponent in self.y.decades() {
            let y = self.y.place(f64::from(exponent));
            canvas.line(&[(left, y), (right, y)], GRID)?;
            canvas.line(&[(left, y), (left + MAJOR_TICK, y)], FRAME)?;
        }
        for x in self.x.minor_places() {
            canvas.line(&[(x, bottom), (x, bottom - MINOR_TICK)], FRAME)?;
        }
        for y in self.y.minor_places() {
            canvas.line(&[(left, y), (left + MINOR_TICK, y)], FRAME)?;
        }
        canvas.line(&[(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)], FRAME)?;
        for exponent in self.x.labelled() {
            let place = (self.x.place(f64::from(exponent)), bottom + 0.8);
            canvas.text(&power_of_ten(exponent), place, TICK_TEXT, (HPos::Center, VPos::Top))?;
        }
        for exponent in self.y.labelled() {
            let place = (left - 0.9, self.y.place(f64::from(exponent)));
            canvas.text(&power_of_ten(exponent), place, TICK_TEXT, (HPos::Right, VPos::Center))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_at_both_ends_are_kept_and_minor_ticks_lie_between() {
        let axis = LogAxis { low: -4.0, high: 0.0, from: 0.0, to: 40.0 };
        assert_eq!(axis.labelled(), [-4, -3, -2, -1, 0]);
        assert_eq!(axis.minor_places().len(), 32);
        assert_eq!(axis.place(-3.0), 10.0);
    }

    #[test]
    fn many_decades_are_labelled_in_steps() {
        let axis = LogAxis { low: -12.0, high: 2.0, from: 60.0, to: 0.0 };
        assert_eq!(axis.labelled(), [-12, -10, -8, -6, -4, -2, 0, 2]);
    }
}
