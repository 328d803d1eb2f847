//! Weights and cuts of partitions.

use super::*;
use nalgebra::Vector2;

/// Six points on a line, the last three times as heavy as the others.
fn line() -> (Vec<Vector2<f64>>, [f64; 6]) {
    ((0..6).map(|k| Vector2::new(f64::from(k), 0.0)).collect(), [1.0, 1.0, 1.0, 1.0, 1.0, 3.0])
}

#[test]
fn balanced_shares_have_equal_weight_and_boxes_equal_size() {
    let (points, weights) = line();
    let halves = |scheme: Scheme, weights: &[f64]| {
        scheme.partition(&points, weights, &points, Grid::of(2, 1)).unwrap()
    };
    let loads = |partition: &Partition| -> [f64; 2] {
        let load = |e: u32| partition.subdomain.iter().zip(&weights).filter(move |(of, _)| **of == e);
        [0, 1].map(|e| load(e).map(|(_, weight)| weight).sum())
    };
    let balanced = halves(Scheme::Balanced, &weights);
    assert_eq!(balanced.subdomain, [0, 0, 0, 0, 1, 1]);
    assert_eq!(loads(&balanced), [4.0, 4.0]);
    let boxes = halves(Scheme::Boxes, &weights);
    assert_eq!(boxes.subdomain, [0, 0, 0, 1, 1, 1]);
    assert_eq!(loads(&boxes), [3.0, 5.0]);
    assert_eq!(boxes, halves(Scheme::Balanced, &[1.0; 6]));
}

/// A grain in contact with six others, and one of these with a wall as well.
#[test]
fn cut_counts_the_copies_of_a_grain_beyond_the_first() {
    let ends = (1..7).map(|other| (other, Some(0))).chain([(6, None)]);
    let adjacency = Adjacency::new(ends, 8);
    let cut = |subdomain: [u32; 7]| Partition { subdomain: subdomain.into(), count: 3 }.cut(&adjacency);
    assert_eq!(cut([0; 7]), 0);
    assert_eq!(cut([0, 0, 1, 1, 2, 2, 2]), 2, "three copies of grain 0");
    assert_eq!(cut([0, 0, 1, 1, 2, 2, 0]), 3, "and two of grain 6");
}
