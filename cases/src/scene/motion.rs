//! Motion that is a given function of time: a table of velocities, read as piecewise linear.

use contact::shown;

/// A time (s) and the velocity then, as [t, `v_x`, `v_y`] (m/s).
pub(crate) type Row = [f64; 3];

/// How far a table has led at a `time` (s) since time 0, along x and y (m): the integral of what is linear from row to row, and
/// constant before the first and after the last.
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

/// What of a table has no meaning, by its `key`.
pub(crate) fn check(table: &[Row], key: &str) -> Result<(), String> {
    for (k, row) in table.iter().enumerate() {
        let row_shown = row.map(shown).join(", ");
        if !row.iter().all(|value| value.is_finite()) {
            return Err(format!("`{key}[{k}]` is [{row_shown}]: its values must be finite"));
        }
        if k > 0 && row[0] <= table[k - 1][0] {
            return Err(format!(
                "`{key}[{k}]` is [{row_shown}]: its time must be later than that of the row before, {}",
                shown(table[k - 1][0])
            ));
        }
    }
    Ok(())
}
