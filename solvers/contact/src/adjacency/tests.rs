//! Neighbours of a grain.

use super::*;

#[test]
fn contacts_around_a_grain_rise_and_a_wall_has_none() {
    let adjacency = Adjacency::new([(1, Some(0)), (0, None), (2, Some(1)), (0, Some(2))].into_iter(), 4);
    let around: Vec<&[u32]> = (0..adjacency.grain_count()).map(|grain| adjacency.around(grain)).collect();
    assert_eq!(around, [&[0, 1, 3][..], &[0, 2], &[2, 3], &[]]);
}

#[test]
fn a_hundred_items_around_one_grain_have_a_hundred_colours() {
    let items = (1..=100).map(|k| [0, k].into_iter()).chain([[100, 101].into_iter()]);
    let colours = greedy_colours(items, 102);
    assert_eq!(colours[..100], (0..100).collect::<Vec<_>>());
    assert_eq!(colours[100], 0, "grain 100 has the colour 99 only");
}
