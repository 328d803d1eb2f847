//! Counts as columns × rows.

use super::*;

#[test]
fn bare_count_is_divided_as_squarely_as_it_goes() {
    for (count, nx, ny) in [(1, 1, 1), (2, 2, 1), (4, 2, 2), (7, 7, 1), (8, 4, 2), (25, 5, 5), (64, 8, 8)] {
        assert_eq!(Grid::of_count(count), Grid { nx, ny });
    }
}
