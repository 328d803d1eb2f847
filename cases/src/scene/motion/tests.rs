use super::*;
use nalgebra::Vector2;

#[test]
fn vibration_of_a_quarter_turn_back_begins_at_rest() {
    let phase_rad = -std::f64::consts::FRAC_PI_2;
    let (amplitude_m, frequency_hz, direction) = (0.1, 1.0, Direction::X);
    let from_rest = Vibration { amplitude_m, frequency_hz, direction, phase_rad, start_s: 0.0 };
    assert_eq!(from_rest.displacement::<Vector2<f64>>(0.0), Vector2::zeros());
    // A (1 − cos(2π f t)): all the way after half a period; A (2π f t)²/2 soon after the start.
    assert!((from_rest.displacement::<Vector2<f64>>(0.5).x - 0.2).abs() < 1e-15);
    let soon = 0.1 * (std::f64::consts::TAU * 1e-4_f64).powi(2) / 2.0;
    assert!((from_rest.displacement::<Vector2<f64>>(1e-4).x / soon - 1.0).abs() < 1e-6);
}
