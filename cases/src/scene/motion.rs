//! Motions that are a given function of time: a table of velocities, read as piecewise linear, and a vibration.

use crate::scene::coordinates::Row;
use contact::{Place, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Returns the displacement that a table of velocities gives from time 0 to a `time` (s), in metres: the integral of a velocity
/// that is linear from row to row, and constant before the first and after the last.
pub(crate) fn displacement(table: &[Row], time: f64) -> [f64; 3] {
    let row = |k: usize| {
        let [t, x, y, z] = table[k].list();
        (t, [x, y, z])
    };
    displacement_of(table.len(), row, time)
}

/// Returns the integral from time 0 to a `time` (s) of rates in a table of `rows`, each a time and the rates then.
pub(crate) fn displacement_of<const N: usize>(
    rows: usize,
    row: impl Fn(usize) -> (f64, [f64; N]),
    time: f64,
) -> [f64; N] {
    let (now, begin) = (integral(rows, &row, time), integral(rows, &row, 0.0));
    std::array::from_fn(|axis| now[axis] - begin[axis])
}

/// The integral from the first row to a `time` (s), or backwards to it.
fn integral<const N: usize>(rows: usize, row: &impl Fn(usize) -> (f64, [f64; N]), time: f64) -> [f64; N] {
    let mut sum = [0.0; N];
    if rows == 0 {
        return sum;
    }
    let (first, last) = (row(0), row(rows - 1));
    for axis in 0..N {
        sum[axis] = (time - first.0).min(0.0) * first.1[axis] + (time - last.0).max(0.0) * last.1[axis];
    }
    for k in 1..rows {
        let ((t, from), (t_next, to)) = (row(k - 1), row(k));
        let passed = (time - t).clamp(0.0, t_next - t);
        let share = passed / (t_next - t);
        for axis in 0..N {
            sum[axis] += passed * (from[axis] + 0.5 * share * (to[axis] - from[axis]));
        }
    }
    sum
}

/// The greatest speed of a table (m/s).
pub(crate) fn greatest_speed(table: &[Row]) -> f64 {
    let speed = |row: &Row| {
        let [_, x, y, z] = row.list();
        x.hypot(y).hypot(z)
    };
    table.iter().map(speed).fold(0.0, f64::max)
}

/// Refuses a table without meaning, by its `key`.
pub(crate) fn check<'t>(table: impl IntoIterator<Item = &'t [f64]>, key: &str) -> Result<(), String> {
    let mut before: Option<f64> = None;
    for (k, row) in table.into_iter().enumerate() {
        if let Some(before) = before.filter(|before| row[0] <= *before) {
            let row: Vec<String> = row.iter().map(|value| shown(*value)).collect();
            return Err(format!(
                "`{key}[{k}]` is [{}]: its time must be later than that of the row before, {}",
                row.join(", "),
                shown(before)
            ));
        }
        before = Some(row[0]);
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
