use super::*;

#[test]
fn cells_meet_halfway_and_reach_as_far_outwards() {
    let edges = edges([10.0, 1.0, 1000.0, 10.0].into_iter());
    assert_eq!(edges, [(1.0, (-0.5, 0.5)), (10.0, (0.5, 2.0)), (1000.0, (2.0, 4.0))]);
    assert_eq!(around(&edges, 10.0), (0.5, 2.0));
}

#[test]
fn cell_alone_has_a_width() {
    assert_eq!(edges([1.0].into_iter()), [(1.0, (-0.25, 0.25))]);
}
