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
    let points = [(1.0, 1.0), (0.0, 2.0)].map(|(value, i)| Some((log(i), log(value))));
    let pieces = visible(&points, (-4.0, 0.0));
    assert_eq!(pieces.len(), 1);
    assert_eq!(pieces[0][1].1, -4.0);
    let infinite = (log(10.0), log(f64::INFINITY));
    assert_eq!(infinite, (1.0, BEYOND));
    assert!(visible(&[Some(infinite)], (-4.0, 0.0)).is_empty());
}

#[test]
fn range_holds_values_and_tolerance_with_a_little_room() {
    let of = |values: &[f64], tolerances: &[f64]| {
        range(values.iter().map(|value| (Ending::Converged, *value)), tolerances)
    };
    assert_eq!(of(&[-0.5, -2.5], &[1e-4]), (-4.3, -0.2));
    assert_eq!(of(&[-0.5, -2.5], &[]), (-2.8, -0.2));
    assert_eq!(of(&[0.0], &[]), (-1.3, 0.3));
    assert_eq!(of(&[], &[]), (-4.0, 0.0));
}

#[test]
fn failed_run_does_not_stretch_the_range() {
    let explosion = [-0.5, 300.0].map(|value| (Ending::Diverged, value));
    assert_eq!(range(explosion.into_iter(), &[]), (-0.8, 1.3));
}

#[test]
fn curve_is_cut_at_all_sides_of_a_frame() {
    let points = [Some((-2.0, 0.5)), Some((2.0, 0.5)), Some((2.0, 3.0)), Some((0.0, 1.0))];
    let pieces = inside(&points, (-1.0, 1.5), (0.0, 2.0));
    assert_eq!(pieces, [vec![(-1.0, 0.5), (1.5, 0.5)], vec![(1.0, 2.0), (0.0, 1.0)]]);
}

#[test]
fn place_along_pieces_is_measured_from_their_start() {
    let pieces = [vec![(0.0, 0.0), (2.0, 0.0)], vec![(5.0, 1.0), (5.0, 3.0)]];
    assert_eq!(along(&pieces, 0.25), Some((1.0, 0.0)));
    assert_eq!(along(&pieces, 0.75), Some((5.0, 2.0)));
    assert_eq!(along(&[vec![(0.0, 0.0)]], 0.5), None);
}
