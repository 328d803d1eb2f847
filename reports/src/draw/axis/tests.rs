use super::*;

fn logs(axis: &Axis) -> Vec<f64> {
    axis.labels().into_iter().map(|(log, _)| log).collect()
}

#[test]
fn powers_at_both_ends_are_kept_and_minor_ticks_lie_between() {
    let axis = Axis::log((-4.0, 0.0), 0.0, 40.0);
    assert_eq!(logs(&axis), [-4.0, -3.0, -2.0, -1.0, 0.0]);
    assert_eq!(axis.minor_places().len(), 32);
    assert_eq!(axis.place(-3.0), 10.0);
}

#[test]
fn many_decades_are_labelled_in_steps() {
    let axis = Axis::log((-12.0, 2.0), 60.0, 0.0);
    assert_eq!(logs(&axis), [-12.0, -10.0, -8.0, -6.0, -4.0, -2.0, 0.0, 2.0]);
}

#[test]
fn powers_of_two_are_labelled_by_their_values() {
    let axis = Axis { scale: Scale::Two, ..Axis::log((-0.1, 1.0), 0.0, 40.0) };
    let texts: Vec<String> = axis.labels().into_iter().map(|(_, text)| text).collect();
    assert_eq!(texts, ["1", "2", "4", "8"]);
    assert_eq!(axis.ticks().len(), 4);
}

#[test]
fn many_powers_of_two_are_labelled_in_steps() {
    let axis = Axis { scale: Scale::Two, ..Axis::log((-0.1, 3.7), 0.0, 42.0) };
    let texts: Vec<String> = axis.labels().into_iter().map(|(_, text)| text).collect();
    assert_eq!(texts, ["1", "4", "16", "64", "256", "1024", "4096"]);
}

#[test]
fn short_axis_has_labels_between_the_powers() {
    let axis = Axis::log((2.2, 3.1), 0.0, 40.0);
    let texts: Vec<String> = axis.labels().into_iter().map(|(_, text)| text).collect();
    assert_eq!(texts, ["200", "500", "1000"]);
}
