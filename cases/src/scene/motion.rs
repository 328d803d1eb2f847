//! Motions that are a given function of time: a table of velocities, read as piecewise linear, and a vibration.

use contact::{Place, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A time (s) and the velocity then, as [t, `v_x`, `v_y`] (m/s).
pub(crate) type Row = [f64; 3];

/// Returns the displacement along x and y that a table gives from time 0 to a `time` (s), in metres: the integral of a velocity
/// that is linear from row to row, and constant before the first and after the last.
pub(crate) fn displacement(table: &[Row], time: f64) -> [f64; 2] {
    let (now, begin) = (integral(table, time), integral(table, 0.0));
    [now[0] - begin[0], now[1] - begin[1]]
}

/// The integral from the first row to a `time` (s), or backwards to it (m).
fn integral(table: &[Row], time: f64) -> [f64; 2] {
    let (Some(first), Some(last)) = (table.first(), table.last()) else { return [0.0; 2] };
    let mut sum = [0.0; 2];
    for axis in 0..2 {
        sum[axis] = (time - first[0]).min(0.0) * first[1 + axis] + (time - last[0]).max(0.0) * last[1 + axis];
    }
    for rows in table.windows(2) {
        let [[t, from @ ..], [t_next, to @ ..]] = [rows[0], rows[1]];
        let passed = (time - t).clamp(0.0, t_next - t);
        let share = passed / (t_next - t);
        for axis in 0..2 {
            sum[axis] += passed * (from[axis] + 0.5 * share * (to[axis] - from[axis]));
        }
    }
    sum
}

/// The greatest speed of a table (m/s).
pub(crate) fn greatest_speed(table: &[Row]) -> f64 {
    table.iter().map(|[_, x, y]| x.hypot(*y)).fold(0.0, f64::max)
}

/// Refuses a table without meaning, by its `key`.
pub(crate) fn check(table: &[Row], key: &str) -> Result<(), String> {
    for (k, row) in table.iter().enumerate() {
        let row_shown = row.map(shown).join(", ");
        if k > 0 && row[0] <= table[k - 1][0] {
            return Err(format!(
                "`{key}[{k}]` is [{row_shown}]: its time must be later than that of the row before, {}",
                shown(table[k - 1][0])
            ));
        }
    }
    Ok(())
}

/// The fewest time steps in a period of a vibration: walls move by the mean velocity of each, which is then within 1/2 % of its
/// greatest, and at a whole number of periods per time step they would stand still.
const PER_PERIOD: f64 = 20.0;

/// Motion by A (sin(2π f (t − start) + φ) − sin φ) from `start_s` on. It begins at its full speed with φ = 0, at
/// rest with φ = −π/2. Its greatest acceleration is Γ = A (2π f)²/g times that of gravity.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vibration {
    /// A (m).
    pub amplitude_m: f64,
    /// f (Hz).
    pub frequency_hz: f64,
    /// Direction: x, y or, for spheres, z.
    pub direction: Direction,
    /// φ (rad).
    #[serde(default)]
    pub phase_rad: f64,
    /// Time at which it begins (s).
    #[serde(default)]
    pub start_s: f64,
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Horizontal.
    X,
    /// Vertical.
    Y,
    /// Horizontal, towards the viewer.
    Z,
}

impl Vibration {
    /// 2π f A (m/s).
    pub(crate) fn greatest_speed(&self) -> f64 {
        (std::f64::consts::TAU * self.frequency_hz * self.amplitude_m).abs()
    }

    /// Refuses a vibration, that of a `place` in the scene, whose period is cut by the time step of `h` (s) into too few parts.
    pub(crate) fn check_resolved(&self, place: &str, h: f64) -> Result<(), String> {
        let period = 1.0 / self.frequency_hz.abs();
        // To the rounding of decimal fractions.
        if period >= PER_PERIOD * h * (1.0 - 1e-9) {
            return Ok(());
        }
        Err(format!(
            "`{place}.vibration.frequency_hz` is {}, a period of {} s, and `scene.time_step_s` is {}: a period must be at least \
             {PER_PERIOD} time steps, {} s",
            shown(self.frequency_hz),
            shown(period),
            shown(h),
            shown(PER_PERIOD * h)
        ))
    }

    /// Returns its displacement at a `time` (s), in metres.
    pub(crate) fn displacement<P: Place>(&self, time: f64) -> P {
        let turned = std::f64::consts::TAU * self.frequency_hz * (time - self.start_s).max(0.0);
        let value = self.amplitude_m * (libm::sin(turned + self.phase_rad) - libm::sin(self.phase_rad));
        match self.direction {
            Direction::X => P::of([value, 0.0, 0.0]),
            Direction::Y => P::of([0.0, value, 0.0]),
            Direction::Z => P::of([0.0, 0.0, value]),
        }
    }
}

#[cfg(test)]
mod tests;
