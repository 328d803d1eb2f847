//! The median of a sample, and how sure it is.

/// The median of a sample, between the bounds of its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Median {
    /// Lower bound.
    pub low: f64,
    /// The mean of the two in the middle of an even number.
    pub median: f64,
    /// Upper bound.
    pub high: f64,
}

/// Confidence of the interval of five values or more (–). Of five it is 94 %, between the least and the greatest; no interval of fewer
/// has as much.
const CONFIDENCE: f64 = 0.9;

impl Median {
    /// Returns the median of `values`, with the narrowest interval between two of them, as many from the least as from the greatest,
    /// that holds the median of what they are drawn from with a probability of at least 90 %, whatever its distribution: between the
    /// k-th and the k-th last of n it is 1 − 2¹⁻ⁿ Σ_{i<k} (n over i) (H. A. David, H. N. Nagaraja, Order Statistics, 3rd ed., 2003,
    /// section 7.1). Of fewer than five it is their whole span. `None` without values.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let n = values.len();
        let last = n.checked_sub(1)?;
        // ln of (n over i)/2ⁿ, which may be less than any number.
        let mut share = -(n as f64) * std::f64::consts::LN_2;
        let (mut outside, mut k) = (0.0, 0);
        for i in 0..n / 2 {
            outside += 2.0 * share.exp();
            if 1.0 - outside < CONFIDENCE {
                break;
            }
            k = i;
            share += ((n - i) as f64 / (i + 1) as f64).ln();
        }
        let median = f64::midpoint(values[last / 2], values[n / 2]);
        Some(Self { low: values[k], median, high: values[last - k] })
    }
}

/// Returns the middle value; the mean of the two in the middle of an even number; none without values.
pub fn median(values: Vec<f64>) -> Option<f64> {
    Median::of(values).map(|of| of.median)
}

#[cfg(test)]
mod tests {
    use super::Median;

    /// By tables of the binomial distribution; of 5,000 values nearly by the normal one, 2500 ∓ 1.645 √5000/2.
    #[test]
    fn the_interval_of_a_median_is_that_of_order_statistics() {
        for (n, low) in
            [(1, 1), (4, 1), (5, 1), (7, 1), (8, 2), (10, 2), (11, 3), (20, 6), (36, 13), (5000, 2442)]
        {
            let values = (1..=n).rev().map(f64::from).collect();
            let [low, n] = [low, n].map(f64::from);
            let expected = Median { low, median: 0.5 * (n + 1.0), high: n + 1.0 - low };
            assert_eq!(Median::of(values), Some(expected), "{n}");
        }
        assert_eq!(Median::of(Vec::new()), None);
    }
}
