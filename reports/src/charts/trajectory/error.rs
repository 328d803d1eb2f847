//! Errors of a simulation against the reference of its scene.

use results::simulation::Observed;

use crate::read::Simulation;

/// Observables compared, as named on axes.
pub(crate) const OBSERVABLES: [&str; 4] =
    ["wall impulse (–)", "kinetic energy (–)", "greatest overlap (d)", "mean height (d)"];

/// The errors of a simulation over the common times t_k of its series x and the reference's y, in the order of
/// [`OBSERVABLES`]; none if it did not come to the end of the reference.
///
/// - impulses of floor, left and right wall from one time to the next: √(Σ |x_k − y_k|² / Σ |y_k|²);
/// - kinetic energy: √(Σ (x_k − y_k)² / Σ y_k²);
/// - greatest overlap and mean height, in mean diameters d: √(Σ (x_k − y_k)² / n) / d.
pub(crate) fn errors(simulation: &Simulation, reference: &Simulation) -> Option<[f64; 4]> {
    let (x, y) = (simulation.series(), reference.series());
    if x.is_empty() || x.len() != y.len() {
        return None;
    }
    let d = reference.mean_diameter_m * (x.len() as f64).sqrt();
    let walls = |of: fn(&Observed) -> [f64; 3]| norms(x, y, |row| of(row).to_vec());
    let one = |of: fn(&Observed) -> f64| norms(x, y, |row| vec![of(row)]);
    let relative = |(error, scale): (f64, f64)| if error == 0.0 { 0.0 } else { error / scale };
    Some([
        relative(walls(|row| [row.floor_impulse_n_s, row.left_impulse_n_s, row.right_impulse_n_s])),
        relative(one(|row| row.kinetic_energy_j)),
        one(|row| row.greatest_overlap_m).0 / d,
        one(|row| row.mean_height_m).0 / d,
    ])
}

/// √Σ |x_k − y_k|² and √Σ |y_k|².
fn norms(x: &[Observed], y: &[Observed], of: impl Fn(&Observed) -> Vec<f64>) -> (f64, f64) {
    let (mut error, mut scale) = (0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        for (x, y) in of(x).iter().zip(of(y)) {
            error += (x - y) * (x - y);
            scale += y * y;
        }
    }
    (error.sqrt(), scale.sqrt())
}
