//! Curves in logarithms: their range, and what of them lies in a frame.

use crate::read::{Ending, span};

/// Stands for the logarithms of zero and of infinity: beyond every number, and still fit to interpolate with.
const BEYOND: f64 = 400.0;

/// Below this a measure is round-off, and so is its distance to zero (logarithm).
pub(crate) const LOWEST: f64 = -12.0;

/// Logarithms of a cost and of a measure; `None` where one is undefined.
pub(crate) type LogPoint = Option<(f64, f64)>;

/// A logarithm that is a number for any value that is one.
pub(crate) fn log(value: f64) -> f64 {
    value.max(0.0).log10().clamp(-BEYOND, BEYOND)
}

/// Range of the curves and the tolerances, at least a decade: all that the settled runs reach between 10⁻¹² and 10³,
/// and of the others what lies below ten, so that they are seen to leave the frame.
pub(crate) fn range(values: impl Iterator<Item = (Ending, f64)>, tolerances: &[f64]) -> (f64, f64) {
    /// Room for the sign at the end of a line, and between the labels that meet in a corner.
    const ROOM: f64 = 0.3;
    let reached = values.map(|(ending, value)| {
        let settled = matches!(ending, Ending::Converged | Ending::IterationLimit | Ending::Stalled);
        let highest = if settled { 3.0 } else { 1.0 };
        value.clamp(LOWEST, highest)
    });
    let logs = reached.chain(tolerances.iter().map(|tolerance| tolerance.log10()));
    span(logs).map_or((-4.0, 0.0), |(low, high)| (low.min(high - 1.0) - ROOM, high + ROOM))
}

/// The pieces of a curve between two heights, cut where it crosses them; a lone point is a piece.
pub(crate) fn visible(points: &[LogPoint], (low, high): (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let (mut pieces, mut piece) = (Vec::new(), Vec::new());
    let mut previous = None;
    for &point in points {
        if let Some(to) = point {
            let from = previous.unwrap_or(to);
            if let Some((entry, exit)) = cut(from, to, (low, high)) {
                if piece.is_empty() {
                    piece.push(entry);
                }
                if piece.last() != Some(&exit) {
                    piece.push(exit);
                }
            }
        }
        let leaves = point.is_none_or(|(_, y)| !(low..=high).contains(&y));
        if leaves && !piece.is_empty() {
            pieces.push(std::mem::take(&mut piece));
        }
        previous = point;
    }
    if !piece.is_empty() {
        pieces.push(piece);
    }
    pieces
}

/// The pieces of a curve inside a frame.
pub(crate) fn inside(points: &[LogPoint], x: (f64, f64), y: (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let turned = |piece: &[(f64, f64)]| piece.iter().map(|&(x, y)| Some((y, x))).collect::<Vec<LogPoint>>();
    let within = visible(points, y).into_iter().flat_map(|piece| visible(&turned(&piece), x));
    within.map(|piece| piece.into_iter().map(|(y, x)| (x, y)).collect()).collect()
}

type Segment = ((f64, f64), (f64, f64));

/// The part of a segment between two heights.
fn cut(from: (f64, f64), to: (f64, f64), (low, high): (f64, f64)) -> Option<Segment> {
    let rise = to.1 - from.1;
    if rise == 0.0 {
        return (low..=high).contains(&from.1).then_some((from, to));
    }
    let crossings = ((low - from.1) / rise, (high - from.1) / rise);
    let enter = crossings.0.min(crossings.1).max(0.0);
    let leave = crossings.0.max(crossings.1).min(1.0);
    let at = |t: f64| (from.0 + t * (to.0 - from.0), (from.1 + t * rise).clamp(low, high));
    (enter <= leave).then(|| (at(enter), if leave == 1.0 { to } else { at(leave) }))
}

/// The place after a share of the length of all pieces.
pub(crate) fn along(pieces: &[Vec<(f64, f64)>], share: f64) -> Option<(f64, f64)> {
    let length = |s: &[(f64, f64)]| (s[1].0 - s[0].0).hypot(s[1].1 - s[0].1);
    let segments = || pieces.iter().flat_map(|piece| piece.windows(2));
    let mut left = share * segments().map(length).sum::<f64>();
    for segment in segments() {
        let length = length(segment);
        if left <= length && length > 0.0 {
            let t = left / length;
            let between = |a: f64, b: f64| a + t * (b - a);
            return Some((between(segment[0].0, segment[1].0), between(segment[0].1, segment[1].1)));
        }
        left -= length;
    }
    None
}

#[cfg(test)]
mod tests;
