//! Matrices that ought to be symmetric: those that hold one triangle only, and those that are not.

use anyhow::{Result, bail};
use lineup::Triplets;
use local::LocalProblem;
use std::collections::BTreeMap;

/// ‖W − Wᵗ‖/‖W‖ (–) of the round-off of single precision, or of eight digits where mirror images were computed each on its own. Few
/// digits alone leave W symmetric, for equal numbers round alike: dumps of Siconos' tests with six or seven have 4e-16 at most.
const ROUND_OFF: f64 = 1e-6;

/// ‖W − Wᵗ‖/‖W‖ (–) of time steps that take gyroscopic terms implicitly, as Siconos does: 1e-5 to 5e-4 in 23 of its 50 dumps, all of
/// 25 digits, and 1.4e-3 in one. Beyond lie mistakes, such as half a matrix.
const OF_SPIN: f64 = 1e-2;

/// The triangle that holds all entries off the diagonal, where there are some.
fn triangle(entries: impl Iterator<Item = (usize, usize, f64)>) -> Option<&'static str> {
    let (mut upper, mut lower) = (false, false);
    for (row, column, _) in entries.filter(|(_, _, x)| *x != 0.0) {
        upper |= row < column;
        lower |= row > column;
    }
    (upper != lower).then_some(if upper { "upper" } else { "lower" })
}

/// Adds the other triangle of the mass matrix `M` if it holds one only, and says so.
pub(super) fn mirror(mass: &mut Triplets) -> Option<String> {
    let side = triangle(mass.entries.iter().copied())?;
    let other: Vec<_> = mass.entries.iter().filter(|(row, column, _)| row != column).copied().collect();
    mass.entries.extend(other.into_iter().map(|(row, column, x)| (column, row, x)));
    Some(format!("`M` holds its {side} triangle only: it is mirrored, as a mass matrix is symmetric"))
}

/// Checks that `W` holds both triangles; says so where they differ.
///
/// # Errors
/// Names the triangle that is there, if there is one.
pub(super) fn check(problem: &LocalProblem) -> Result<Option<String>> {
    if let Some(side) = triangle(problem.entries()) {
        bail!(
            "`W` holds its {side} triangle only, which may be half of a symmetric matrix or all of another one: write both \
             triangles"
        );
    }
    let entries: BTreeMap<_, _> = problem.entries().map(|(row, column, x)| ((row, column), x)).collect();
    let (mut apart, mut all) = (0.0, 0.0);
    for ((row, column), x) in &entries {
        let other = entries.get(&(*column, *row)).copied().unwrap_or(0.0);
        // An entry without its mirror image stands for both.
        let both = if entries.contains_key(&(*column, *row)) { 1.0 } else { 2.0 };
        apart += both * (x - other) * (x - other);
        all += x * x;
    }
    let asymmetry = if apart == 0.0 { 0.0 } else { (apart / all).sqrt() };
    Ok((asymmetry > ROUND_OFF).then(|| {
        let from = if asymmetry > OF_SPIN {
            "check what wrote it"
        } else {
            "codes that take gyroscopic terms implicitly write such a W"
        };
        format!(
            "`W` is not symmetric, ‖W − Wᵗ‖ is {asymmetry:.1e} of ‖W‖, as no Hᵗ M⁻¹ H of a symmetric M is: {from}; it is solved as it \
             stands, and so are residuals"
        )
    }))
}
