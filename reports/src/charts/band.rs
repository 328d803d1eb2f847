//! A curve that goes up and down, as the band that it fills and the middle of it: drawn whole it would cover all others.

use crate::draw::LogPoint;
use crate::read::{median, span};

/// Widths of a panel's x axis over that of a step of a band.
const STEPS: f64 = 60.0;
/// A curve goes up and down if it goes so many times its own height (–).
const UP_AND_DOWN: f64 = 4.0;

/// Places of a band from its greatest to its least x, as logarithms.
pub(super) struct Band {
    pub(super) low: Vec<(f64, f64)>,
    pub(super) high: Vec<(f64, f64)>,
    /// Medians, and the last point of the curve.
    pub(super) middle: Vec<LogPoint>,
}

impl Band {
    /// The band of a curve in a panel whose x axis has a length of `wide` (logarithms); none of a curve that goes one way.
    pub(super) fn of(points: &[LogPoint], wide: f64) -> Option<Self> {
        let known: Vec<(f64, f64)> = points.iter().copied().flatten().collect();
        let (low, high) = span(known.iter().map(|point| point.1))?;
        let way: f64 = known.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()).sum();
        if way <= UP_AND_DOWN * (high - low) {
            return None;
        }
        let step = wide / STEPS;
        let mut steps: Vec<(i64, f64)> = known.iter().map(|(x, y)| ((x / step).floor() as i64, *y)).collect();
        steps.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
        let mut band = Self { low: Vec::new(), high: Vec::new(), middle: Vec::new() };
        for of_step in steps.chunk_by(|a, b| a.0 == b.0) {
            let x = (of_step[0].0 as f64 + 0.5) * step;
            band.low.push((x, of_step[0].1));
            band.high.push((x, of_step[of_step.len() - 1].1));
            band.middle.push(median(of_step.iter().map(|(_, y)| *y).collect()).map(|y| (x, y)));
        }
        band.middle.push(known.last().copied());
        Some(band)
    }
}

#[cfg(test)]
mod tests;
