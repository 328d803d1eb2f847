//! Roots of a polynomial of degree four between −1 and 1, by the roots of its derivatives.

/// p₀ + p₁ t + p₂ t² + p₃ t³ + p₄ t⁴.
pub(crate) type Quartic = [f64; 5];

/// The value and the derivative at t.
fn at(p: &[f64], t: f64) -> (f64, f64) {
    p.iter().rev().fold((0.0, 0.0), |(value, slope), p| (value * t + p, slope * t + value))
}

/// The root between two points where p has different signs, by Newton's steps that stay between.
fn between(p: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let (first, last) = (at(p, low).0, at(p, high).0);
    if first == 0.0 {
        return Some(low);
    }
    if last == 0.0 || (first > 0.0) == (last > 0.0) {
        // That at the upper end belongs to the next piece, or to the next quarter.
        return None;
    }
    let mut t = 0.5 * (low + high);
    // 1e-16 is 54 halvings away, and Newton's steps are mostly taken.
    for _ in 0..120 {
        let (value, slope) = at(p, t);
        if value == 0.0 {
            break;
        }
        if (value > 0.0) == (first > 0.0) {
            low = t;
        } else {
            high = t;
        }
        let newton = t - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == t {
            break;
        }
        t = next;
    }
    Some(t)
}

/// The roots t in [−1, 1), in ascending order, and how many: where a derivative keeps its sign there is one at most.
pub(crate) fn roots(p: &Quartic) -> ([f64; 4], usize) {
    let (mut found, mut count) = ([0.0; 4], 0);
    for degree in 1..=4 {
        // The derivative of p that has this degree.
        let order = 4 - degree;
        let factor = |k: usize| ((k + 1)..=(k + order)).map(|k| k as f64).product::<f64>();
        let derivative: Quartic =
            std::array::from_fn(|k| if k <= degree { factor(k) * p[k + order] } else { 0.0 });
        let (mut roots, mut next, mut low) = ([0.0; 4], 0, -1.0);
        for k in 0..=count {
            let high = if k < count { found[k] } else { 1.0 };
            if let Some(root) = between(&derivative[..=degree], low, high) {
                roots[next] = root;
                next += 1;
            }
            low = high;
        }
        (found, count) = (roots, next);
    }
    (found, count)
}

#[cfg(test)]
mod tests {
    use super::roots;

    #[test]
    fn roots_of_a_product_are_those_of_its_factors() {
        // (t − 0.9)(t − 0.5)(t + 0.25)(t + 3)
        let mut p = vec![1.0];
        for root in [0.9, 0.5, -0.25, -3.0] {
            let mut q = vec![0.0; p.len() + 1];
            for (k, c) in p.iter().enumerate() {
                q[k + 1] += c;
                q[k] -= root * c;
            }
            p = q;
        }
        let (found, count) = roots(&p.try_into().expect("five coefficients"));
        assert_eq!(count, 3);
        for (found, expected) in found.iter().zip([-0.25, 0.5, 0.9]) {
            assert!((found - expected).abs() < 1e-14, "{found}");
        }
    }
}
