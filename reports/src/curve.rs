//! Curves of a measure over iterations, in logarithms: their range, and what of them lies in a frame.

/// Stands for the logarithms of zero and of infinity: beyond every number, and still fit to interpolate with.
const BEYOND: f64 = 400.0;

/// Logarithms of iteration and measure; `None` where the measure is undefined.
pub(crate) type LogPoint = Option<(f64, f64)>;

/// A point in logarithms. Iteration 0 has no place on the axis.
pub(crate) fn log_point(iteration: u64, measure: Option<f64>) -> Option<LogPoint> {
    let log = |value: f64| value.log10().clamp(-BEYOND, BEYOND);
    (iteration > 0).then(|| measure.map(|value| ((iteration as f64).log10(), log(value.max(0.0)))))
}

/// Range of the curves and the tolerances, at least a decade: all that the settled runs reach between 10⁻¹² and 10³,
/// and of the others what lies below ten, so that they are seen to leave the frame.
pub(crate) fn range(curves: &[(bool, Vec<LogPoint>)], tolerances: &[f64]) -> (f64, f64) {
    const LOWEST: f64 = -12.0;
    /// Room for the sign at the end of a line, and between the labels that meet in a corner.
    const ROOM: f64 = 0.3;
    let reached = curves.iter().flat_map(|(settled, points)| {
        let highest = if *settled { 3.0 } else { 1.0 };
        points.iter().flatten().map(move |&(_, y)| y.clamp(LOWEST, highest))
    });
    let logs = reached.chain(tolerances.iter().map(|tolerance| tolerance.log10()));
    let (low, high) =
        logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    if low > high {
        return (-4.0, 0.0);
    }
    (low.min(high - 1.0) - ROOM, high + ROOM)
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

/// Height of the pieces at a given x, if one of them passes there.
pub(crate) fn height_at(pieces: &[Vec<(f64, f64)>], x: f64) -> Option<f64> {
    let segment = pieces.iter().flat_map(|piece| piece.windows(2)).find(|s| s[0].0 <= x && x <= s[1].0)?;
    let run = segment[1].0 - segment[0].0;
    let t = if run > 0.0 { (x - segment[0].0) / run } else { 0.0 };
    Some(segment[0].1 + t * (segment[1].1 - segment[0].1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_is_cut_where_it_leaves_and_enters_the_frame() {
        let points = [Some((0.0, 1.0)), Some((1.0, 3.0)), Some((2.0, -1.0))];
        let pieces = visible(&points, (0.0, 2.0));
        assert_eq!(pieces, [vec![(0.0, 1.0), (0.5, 2.0)], vec![(1.25, 2.0), (1.75, 0.0)]]);
    }

    #[test]
    fn undefined_value_breaks_the_curve() {
        let points = [Some((0.0, 1.0)), Some((1.0, 1.0)), None, Some((3.0, 1.0))];
        assert_eq!(visible(&points, (0.0, 2.0)), [vec![(0.0, 1.0), (1.0, 1.0)], vec![(3.0, 1.0)]]);
    }

    #[test]
    fn zero_and_infinity_leave_the_frame_at_its_edges() {
        let points: Vec<LogPoint> =
            [1.0, 0.0].into_iter().zip(1..).filter_map(|(value, i)| log_point(i, Some(value))).collect();
        let pieces = visible(&points, (-4.0, 0.0));
        assert_eq!(pieces.len(), 1);
        assert_eq!(pieces[0][1].1, -4.0);
        let infinite = log_point(10, Some(f64::INFINITY)).unwrap().unwrap();
        assert_eq!(infinite, (1.0, BEYOND));
        assert!(visible(&[Some(infinite)], (-4.0, 0.0)).is_empty());
    }

    #[test]
    fn iteration_zero_has_no_place() {
        assert_eq!(log_point(0, Some(1.0)), None);
        assert_eq!(log_point(1, None), Some(None));
    }

    #[test]
    fn range_holds_values_and_tolerance_with_a_little_room() {
        let curve = vec![Some((0.0, -0.5)), None, Some((1.0, -2.5))];
        assert_eq!(range(&[(true, curve.clone())], &[1e-4]), (-4.3, -0.2));
        assert_eq!(range(&[(true, curve)], &[]), (-2.8, -0.2));
        assert_eq!(range(&[(true, vec![Some((0.0, 0.0))])], &[]), (-1.3, 0.3));
        assert_eq!(range(&[], &[]), (-4.0, 0.0));
    }

    #[test]
    fn failed_run_does_not_stretch_the_range() {
        let explosion = vec![Some((0.0, -0.5)), Some((1.0, 300.0))];
        assert_eq!(range(&[(false, explosion)], &[]), (-0.8, 1.3));
    }

    #[test]
    fn height_is_interpolated() {
        assert_eq!(height_at(&[vec![(0.0, 0.0), (2.0, 4.0)]], 0.5), Some(1.0));
        assert_eq!(height_at(&[vec![(0.0, 0.0), (2.0, 4.0)]], 2.5), None);
    }
}
