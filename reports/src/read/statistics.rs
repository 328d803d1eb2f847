//! Small statistics of what is drawn.

pub(crate) use results::median;

/// The mean of a sample of a normal distribution, between the bounds of its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mean {
    pub(crate) low: f64,
    pub(crate) middle: f64,
    pub(crate) high: f64,
}

/// Normal quantiles that leave 2.5 and 5 % above them: bounds of intervals of 95 and 90 %.
pub(crate) const OF_95: f64 = 1.959_963_985;
pub(crate) const OF_90: f64 = 1.644_853_627;

impl Mean {
    /// Returns the mean of `values` with Student's interval, where `quantile` is that of the normal distribution; `None` of fewer than
    /// five.
    pub(crate) fn of(values: &[f64], quantile: f64) -> Option<Self> {
        let n = values.len() as f64;
        if n < 5.0 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let half = student(quantile, n - 1.0) * (variance / n).sqrt();
        Some(Self { low: mean - half, middle: mean, high: mean + half })
    }
}

/// Returns the quantile of Student's distribution with so many degrees of freedom, four or more, that corresponds to a `quantile` of the
/// normal one: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 26.7.5, within 0.3 %.
fn student(quantile: f64, free: f64) -> f64 {
    let z = quantile;
    let terms = [
        z,
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    terms.into_iter().rev().fold(0.0, |sum, term| sum / free + term)
}

/// The least and the greatest of the values that are numbers.
pub(crate) fn span(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = values.filter(|value| value.is_finite()).map(|value| (value, value));
    finite.reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}

/// A range with room at both ends, and some even if all values are equal.
pub(crate) fn padded(values: impl Iterator<Item = f64>, room: f64) -> (f64, f64) {
    let (low, high) = span(values).unwrap_or((0.0, 1.0));
    let room = if high > low { room * (high - low).max(1.0) } else { 0.3 };
    (low - room, high + room)
}

/// The values, each once, the least first.
pub(crate) fn rising(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// A straight line of least squares: its slope, a point of it, and the sum of squares of the distances of all x from that.
struct Line {
    slope: f64,
    at: (f64, f64),
    along: f64,
}

impl Line {
    /// The line through points with two different x.
    fn through(points: &[(f64, f64)]) -> Option<Self> {
        let n = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
        let at @ (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let along: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
        let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / along;
        (along > 0.0).then_some(Self { slope, at, along })
    }
}

/// Slope of the straight line of least squares through points, if they have two different x.
pub(crate) fn slope(points: &[(f64, f64)]) -> Option<f64> {
    Line::through(points).map(|line| line.slope)
}

/// That slope with Student's interval, where `quantile` is that of the normal distribution; `None` of fewer than six points.
pub(crate) fn slope_within(points: &[(f64, f64)], quantile: f64) -> Option<Mean> {
    let Line { slope: middle, at: (x, y), along } = Line::through(points).filter(|_| points.len() >= 6)?;
    let free = points.len() as f64 - 2.0;
    let left: f64 = points.iter().map(|p| (p.1 - y - middle * (p.0 - x)).powi(2)).sum();
    let half = student(quantile, free) * (left / free / along).sqrt();
    Some(Mean { low: middle - half, middle, high: middle + half })
}

/// The values, each once, in the order in which they come first.
pub(crate) fn unique<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    values.fold(Vec::new(), |mut all, value| {
        if !all.contains(&value) {
            all.push(value);
        }
        all
    })
}

/// The first item that `is`, else a new one at the end.
pub(crate) fn find_or_push<T>(
    items: &mut Vec<T>,
    is: impl Fn(&T) -> bool,
    new: impl FnOnce() -> T,
) -> &mut T {
    let index = items.iter().position(is).unwrap_or_else(|| {
        items.push(new());
        items.len() - 1
    });
    &mut items[index]
}

#[cfg(test)]
mod tests;
