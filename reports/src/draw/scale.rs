//! Numbers as colours, on a logarithmic scale of which the lightness falls all the way: it also reads in grey.

use crate::draw::{Axis, BLACK, Canvas, FRAME, HPos, Place, RGBColor, TEXT, TICK_TEXT, VPos, WHITE};
use crate::read::span;

/// Width of the bar (mm).
const WIDTH: f64 = 3.0;

pub(crate) struct ColorScale {
    low: f64,
    high: f64,
}

impl ColorScale {
    /// From the least to the greatest of `values > 0`; none without values.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        /// A range narrower than this (in logarithms) would show differences that are none.
        const NARROWEST: f64 = 0.3;
        span(values.map(f64::log10)).map(|(low, high)| Self { low, high: high.max(low + NARROWEST) })
    }

    /// Light for few, dark for many.
    pub(crate) fn color(&self, value: f64) -> RGBColor {
        shade((value.log10() - self.low) / (self.high - self.low))
    }

    /// Black or white, whichever is seen on `fill`.
    pub(crate) fn ink_on(fill: RGBColor) -> RGBColor {
        let luma = 0.299 * f64::from(fill.0) + 0.587 * f64::from(fill.1) + 0.114 * f64::from(fill.2);
        if luma > 130.0 { BLACK } else { WHITE }
    }

    /// A bar of `height` mm below `(left, top)`, with its name above and its numbers to the right.
    pub(crate) fn draw(&self, canvas: &Canvas, name: &str, (left, top): Place, height: f64) {
        const PIECES: usize = 96;
        let (right, bottom) = (left + WIDTH, top + height);
        for i in 0..PIECES {
            let from = bottom - height * i as f64 / PIECES as f64;
            // Up to the top, so that no white shows between pieces.
            let piece = [(left, from), (right, from), (right, top), (left, top)];
            canvas.polygon(&piece, shade((i as f64 + 0.5) / PIECES as f64), None);
        }
        let axis = Axis::log((self.low, self.high), bottom, top);
        canvas.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], FRAME);
        for (y, length) in axis.ticks() {
            canvas.line(&[(right, y), (right + length, y)], FRAME);
        }
        for (log, text) in axis.labels() {
            let place = (right + 1.6, axis.place(log));
            canvas.text(&text, place, TICK_TEXT, (HPos::Left, VPos::Center));
        }
        canvas.text(name, (left, top - 1.0), TEXT, (HPos::Left, VPos::Bottom));
    }
}

/// Viridis of matplotlib, from dark to light in even steps.
const VIRIDIS: [(u8, u8, u8); 8] = [
    (68, 1, 84),
    (70, 50, 127),
    (54, 92, 141),
    (39, 127, 143),
    (31, 162, 136),
    (74, 194, 110),
    (160, 219, 57),
    (254, 232, 37),
];

fn shade(share: f64) -> RGBColor {
    let step = (1.0 - share).clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let (low, high) = (VIRIDIS[step.floor() as usize], VIRIDIS[step.ceil() as usize]);
    let less = step.ceil() - step;
    let mixed = |low: u8, high: u8| (less * f64::from(low) + (1.0 - less) * f64::from(high)).round() as u8;
    RGBColor(mixed(low.0, high.0), mixed(low.1, high.1), mixed(low.2, high.2))
}

#[cfg(test)]
mod tests;
