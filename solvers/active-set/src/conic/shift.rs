//! σ of a contact as it follows the velocities, smoothed: μ|`v_t`|²/√(|`v_t`|² + δ²).

use contact::law::tangential;
use nalgebra::SVector;

/// Returns the σ of a contact that slides with `speed`, smoothed over δ (√J).
pub(super) fn smoothed(friction: f64, speed: f64, delta: f64) -> f64 {
    if speed > 0.0 { friction * speed * (speed / speed.hypot(delta)) } else { 0.0 }
}

/// Returns the slope of [`smoothed`] in v (–).
pub(super) fn slope_of<const D: usize>(friction: f64, v: SVector<f64, D>, delta: f64) -> SVector<f64, D> {
    let (along, speed) = tangential(v);
    let root = speed.hypot(delta);
    if root > 0.0 { along * (friction / root * (1.0 + (delta / root).powi(2))) } else { along }
}
