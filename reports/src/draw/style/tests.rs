use std::collections::BTreeSet;

use super::*;
use crate::families::{METHODS, SPARE};

fn parts(RGBColor(r, g, b): RGBColor) -> [f64; 3] {
    [r, g, b].map(f64::from)
}

/// Hue (°) of a colour that has one.
fn hue(color: RGBColor) -> Option<f64> {
    let [r, g, b] = parts(color);
    let (low, high) = (r.min(g).min(b), r.max(g).max(b));
    let hue = 60.0
        * if high == r {
            (g - b) / (high - low)
        } else if high == g {
            2.0 + (b - r) / (high - low)
        } else {
            4.0 + (r - g) / (high - low)
        };
    (high > low).then_some(hue.rem_euclid(360.0))
}

#[test]
fn shades_keep_the_hue_of_their_method_and_their_distance_from_all_others() {
    let spare = SPARE.iter().map(|family| ("a spare one", family));
    let all: Vec<_> = METHODS.iter().map(|(method, family)| (*method, family)).chain(spare).collect();
    for (i, (method, family)) in all.iter().enumerate() {
        for shade in family.shades {
            match (hue(shade), hue(family.shades[0])) {
                (Some(hue), Some(own)) => assert!((hue - own).abs() <= 8.0, "{method}: {hue} for {own}"),
                (hue, own) => assert_eq!(hue, own, "{method}"),
            }
            for (other, others) in all.iter().skip(i + 1) {
                for of_other in others.shades {
                    let apart = parts(shade)
                        .iter()
                        .zip(parts(of_other))
                        .map(|(a, b)| (a - b).powi(2))
                        .sum::<f64>()
                        .sqrt();
                    assert!(
                        apart >= 48.0,
                        "{method} and {other} ({i}) have shades that differ by {apart}: {shade:?}, {of_other:?}"
                    );
                }
            }
        }
    }
}

fn lightness(fill: usize) -> f64 {
    let RGBColor(r, g, b) = SUBDOMAINS[fill];
    0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
}

#[test]
fn methods_of_the_paper_differ_in_grey() {
    let grey = |method: &str| {
        let RGBColor(r, g, b) = METHODS.iter().find(|(name, _)| *name == method).unwrap().1.shades[0];
        0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
    };
    let mut greys = ["nsgs", "nsgs-dd", "latin-dd", "jacobi", "cg"].map(grey);
    greys.sort_by(f64::total_cmp);
    assert!(greys.windows(2).all(|pair| pair[1] - pair[0] >= 18.0), "{greys:?}");
}

#[test]
fn subdomains_side_by_side_differ_in_grey_and_those_across_differ_too() {
    for (columns, rows) in [(2, 1), (4, 2), (2, 4), (3, 2), (8, 1), (1, 8), (8, 8), (1, 16), (16, 1), (5, 5)]
    {
        for name in [format!("{columns}x{rows}"), format!("{columns}x{rows}-balanced")] {
            let fill_at = |column: u32, row: u32| subdomain_fill(&name, column + columns * row);
            for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
                let here = fill_at(column, row);
                for (right, up, apart) in [(1, 0, 20.0), (0, 1, 20.0), (1, 1, 10.0)] {
                    if column + right < columns && row + up < rows {
                        let there = fill_at(column + right, row + up);
                        let differ = (lightness(here) - lightness(there)).abs();
                        assert!(differ >= apart, "{name}: {here} and {there} differ by {differ} of 255");
                    }
                }
            }
        }
    }
}

#[test]
fn up_to_eight_subdomains_have_as_many_fills() {
    for name in ["4x2", "2x4", "8x1", "2x2-balanced"] {
        let fills: BTreeSet<usize> = (0..8).map(|subdomain| subdomain_fill(name, subdomain)).collect();
        assert_eq!(fills.len(), 8, "{name}");
    }
}
