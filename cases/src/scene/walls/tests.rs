use super::*;
use crate::scene::motion::Direction;
use nalgebra::Vector2;

#[test]
fn walls_turn_about_their_feet_and_shake_with_the_box() {
    let (amplitude_m, frequency_hz, direction) = (0.1, 0.25, Direction::Y);
    let vibration = Vibration { amplitude_m, frequency_hz, direction, phase_rad: 0.0, start_s: 1.0 };
    let walls = Walls {
        periodic: false,
        lid: None,
        width_m: Some(3.0),
        depth_m: None,
        tilt_rate_rad_per_s: std::f64::consts::FRAC_PI_4,
        tilt_start_s: 1.0,
        closing_speed_m_per_s: 0.0,
        depth_closing_speed_m_per_s: 0.0,
        belt_speed_m_per_s: 0.0,
        friction: None,
        bump_radius_m: None,
        vibration: Some(vibration),
    };
    let disc = Vector2::new(1.0, 1.5);
    let gaps = |time| walls.at(time)[..3].iter().map(|wall| wall.unwrap().gap(disc, 0.1)).collect::<Vec<_>>();
    assert_eq!(gaps(0.5), [1.4, 0.9, 1.9], "nothing moves before its start");
    // A second later the walls lean by π/4 and the box is at its highest, 0.1 m.
    let along = 1.4 / std::f64::consts::SQRT_2;
    let expected =
        [1.3, 1.0 / std::f64::consts::SQRT_2 - along - 0.1, along - 2.0 / -std::f64::consts::SQRT_2 - 0.1];
    for (gap, expected) in gaps(2.0).iter().zip(expected) {
        assert!((gap - expected).abs() < 1e-14, "{gap} m, {expected} m expected");
    }
}
