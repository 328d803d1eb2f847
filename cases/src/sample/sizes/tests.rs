//! Means of many draws against those of the distributions.

use super::{Radii, Sizes};

const RANGE: [f64; 2] = [0.5, 2.0];

fn drawn(sizes: &Sizes, dimensions: i32) -> Vec<f64> {
    Radii { sizes, range: RANGE, dimensions }.drawn(100_000, 3).unwrap()
}

/// The mean of a power of the radii, within `within` of what is `expected`; all of them in the range.
fn has_mean(radii: &[f64], power: i32, expected: f64, within: f64) {
    assert!(radii.iter().all(|radius| (RANGE[0]..=RANGE[1]).contains(radius)));
    let mean = radii.iter().map(|radius| radius.powi(power)).sum::<f64>() / radii.len() as f64;
    assert!((mean / expected - 1.0).abs() < within, "{mean} for {expected}");
}

#[test]
fn uniform_distributions_have_their_means() {
    let [a, b] = RANGE;
    has_mean(&drawn(&Sizes::UniformByNumber, 2), 1, 0.5 * (a + b), 4e-3);
    has_mean(&drawn(&Sizes::UniformByNumber, 2), 2, (a * a + a * b + b * b) / 3.0, 8e-3);
    // Numbers as r⁻²: the mean of r is a b ln(b/a)/(b − a), that of r² is a b.
    let discs = drawn(&Sizes::UniformByMass, 2);
    has_mean(&discs, 1, a * b * (b / a).ln() / (b - a), 4e-3);
    has_mean(&discs, 2, a * b, 8e-3);
    // Half of the mass lies below the middle of the range.
    for (radii, power) in [(discs, 2), (drawn(&Sizes::UniformByMass, 3), 3)] {
        let mass = |radius: &f64| radius.powi(power);
        let below: f64 = radii.iter().filter(|radius| **radius < 0.5 * (a + b)).map(mass).sum();
        let share = below / radii.iter().map(mass).sum::<f64>();
        assert!((share - 0.5).abs() < 1e-2, "{share}");
    }
}

#[test]
fn log_normal_distribution_has_its_mean_and_deviation_where_nothing_is_cut() {
    let radii = drawn(&Sizes::LogNormal { median_m: 1.0, deviation: 0.1 }, 2);
    has_mean(&radii, 1, (0.5_f64 * 0.01).exp(), 1e-3);
    has_mean(&radii, 2, (2.0_f64 * 0.01).exp(), 2e-3);
    // Cut on both sides, with the median in the middle of the logarithms: half lie below.
    let cut = drawn(&Sizes::LogNormal { median_m: 1.0, deviation: 1.0 }, 2);
    let below = cut.iter().filter(|radius| **radius < 1.0).count() as f64 / cut.len() as f64;
    assert!((below - 0.5).abs() < 6e-3, "{below}");
}

#[test]
fn given_radii_have_their_shares() {
    let radii = drawn(&Sizes::Given { radii_m: vec![0.5, 1.0, 2.0], shares: vec![1.0, 2.0, 5.0] }, 2);
    for (radius, share) in [(0.5, 0.125), (1.0, 0.25), (2.0, 0.625)] {
        let found = radii.iter().filter(|other| **other == radius).count() as f64 / radii.len() as f64;
        assert!((found - share).abs() < 6e-3, "{radius}: {found}");
    }
}

#[test]
fn what_has_no_meaning_is_named() {
    let refused =
        |sizes: Sizes| Radii { sizes: &sizes, range: RANGE, dimensions: 2 }.drawn(1, 1).unwrap_err();
    let given =
        |radii_m: &[f64], shares: &[f64]| Sizes::Given { radii_m: radii_m.to_vec(), shares: shares.to_vec() };
    assert!(refused(given(&[1.0], &[])).contains("`sample.sizes.shares` has 0 values"));
    assert!(refused(given(&[1.0, 3.0], &[1.0, 1.0])).contains("`sample.sizes.radii_m` has 3"));
    assert!(refused(given(&[1.0, 2.0], &[1.0, 0.0])).contains("`sample.sizes.shares` has 0"));
    let log_normal = |median_m, deviation| refused(Sizes::LogNormal { median_m, deviation });
    assert!(log_normal(1.0, 0.0).contains("`sample.sizes.deviation` is 0"));
    assert!(log_normal(1e3, 0.1).contains("next to no radius"));
}
