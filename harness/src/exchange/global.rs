//! Global problems: M V = H r + f, v = Hᵗ V + w, with M and H as they stand in a file.

use anyhow::{Context, Result, bail};
use lineup::{Global, Triplets};
use local::LocalProblem;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// A mass matrix that is not diagonal is factorised as a dense one, up to this size.
const MOST_DENSE: usize = 4000;

/// W = Hᵗ M⁻¹ H and q = Hᵗ M⁻¹ f + w.
///
/// # Errors
/// Names the matrix or the list that does not fit, or cannot be inverted.
pub(super) fn local(global: Global, dimension: usize) -> Result<LocalProblem> {
    let (unknowns, rows) = (global.f.len(), global.w.len());
    let fits = |name: &str, matrix: &Triplets, size: [usize; 2]| {
        if [matrix.rows, matrix.columns] == size {
            return Ok(());
        }
        let (rows, columns) = (matrix.rows, matrix.columns);
        bail!(
            "`{name}` has {rows} x {columns} entries: `vectors/f` and `vectors/w` ask for {} x {}",
            size[0],
            size[1]
        )
    };
    fits("M", &global.mass, [unknowns; 2])?;
    fits("H", &global.h, [unknowns, rows])?;
    let mut q = global.w;
    if let Some(mass) = diagonal(&global.mass) {
        // Row by row of H: contacts that touch the same body.
        let mut of_rows: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
        for (row, column, x) in global.h.entries {
            of_rows.entry(row).or_default().push((column, x));
        }
        let mut w: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        for (row, list) in of_rows {
            if !(mass[row] > 0.0) {
                bail!("`M` has {:?} in row {row}: it must be positive", mass[row]);
            }
            for (a, x) in &list {
                q[*a] += x * global.f[row] / mass[row];
                for (b, y) in &list {
                    *w.entry((*a, *b)).or_default() += x * y / mass[row];
                }
            }
        }
        let entries = w.into_iter().map(|((a, b), value)| (a, b, value));
        return Ok(LocalProblem::new(dimension, entries, q, global.friction)?);
    }
    if unknowns > MOST_DENSE {
        bail!(
            "`M` has {unknowns} rows and is not diagonal: such a one is read with at most {MOST_DENSE} rows"
        );
    }
    let (mass, h) = (dense(&global.mass), dense(&global.h));
    let factors = mass.lu();
    let divided = factors.solve(&h).context("`M` is singular")?;
    let free = factors.solve(&DVector::from_vec(global.f)).context("`M` is singular")?;
    for (q, more) in q.iter_mut().zip((h.transpose() * free).iter()) {
        *q += more;
    }
    let w = h.transpose() * divided;
    let entries = (0..rows).flat_map(|a| (0..rows).map(move |b| (a, b)));
    let entries = entries.map(|(a, b)| (a, b, w[(a, b)])).filter(|(a, b, value)| a == b || *value != 0.0);
    Ok(LocalProblem::new(dimension, entries, q, global.friction)?)
}

/// The entries of a diagonal matrix, of which those of one place are added up.
fn diagonal(matrix: &Triplets) -> Option<Vec<f64>> {
    let mut diagonal = vec![0.0; matrix.rows];
    for (row, column, x) in &matrix.entries {
        if row != column && *x != 0.0 {
            return None;
        }
        diagonal[*row] += x;
    }
    Some(diagonal)
}

fn dense(matrix: &Triplets) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(matrix.rows, matrix.columns);
    for (row, column, x) in &matrix.entries {
        dense[(*row, *column)] += x;
    }
    dense
}
