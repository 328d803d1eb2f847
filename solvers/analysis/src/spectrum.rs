//! The spectrum of W_D⁻¹ W, on which the rates and the limits of most methods hang. W_D is the diagonal of W.

use contact::{ContactProblem, Smooth};
use nalgebra::{DMatrix, SVector};

/// Products W p of a power iteration: on packings the quotient then stands to some four digits.
const PRODUCTS: u32 = 300;

/// Up to this many contacts all eigenvalues are computed, in the order of n³ operations.
const DENSE: usize = 400;

/// Eigenvalues below this share of the greatest are those of redundant contacts, 0 but for round-off (–).
const ZERO: f64 = 1e-13;

/// Quantities computed from the spectrum of a problem.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// λmax(W_D⁻¹ W) over all contacts (–).
    pub greatest: f64,
    /// Spectrum over the closed contacts; only where these are few enough.
    pub closed: Option<Closed>,
}

/// Eigenvalues of W_D⁻¹ W over the contacts that stay closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closed {
    /// λ̃max (–).
    pub greatest: f64,
    /// λ̃min, the least that is not 0 (–).
    pub least: f64,
    /// Number of zero eigenvalues: contacts more than equilibrium needs.
    pub redundant: usize,
}

impl Spectrum {
    /// The spectrum of `problem`, of which `closed` says which contacts stay closed, where that is known.
    pub fn of<const D: usize>(problem: &ContactProblem<Smooth<D>>, closed: Option<&[bool]>) -> Self {
        let all: Vec<usize> = (0..problem.contact_count()).collect();
        let closed = closed.and_then(|closed| {
            let few: Vec<usize> = all.iter().copied().filter(|contact| closed[*contact]).collect();
            Closed::of(&eigenvalues(problem, &few)?)
        });
        let whole = eigenvalues(problem, &all).and_then(|values| values.last().copied());
        Self { greatest: whole.unwrap_or_else(|| greatest_eigenvalue(problem)), closed }
    }
}

impl Closed {
    /// From rising eigenvalues; `None` without contact.
    fn of(values: &[f64]) -> Option<Self> {
        let greatest = *values.last()?;
        let redundant = values.iter().take_while(|value| **value <= ZERO * greatest).count();
        Some(Self { greatest, least: values[redundant.min(values.len() - 1)], redundant })
    }

    /// κ_opt = 1/√(λ̃min λ̃max), the best conjugate direction of LATIN (–).
    pub fn best_direction(&self) -> f64 {
        1.0 / (self.least * self.greatest).sqrt()
    }
}

/// The eigenvalues, rising, of W_D^-½ W W_D^-½ over `contacts`; `None` if these are too many.
fn eigenvalues<const D: usize>(problem: &ContactProblem<Smooth<D>>, contacts: &[usize]) -> Option<Vec<f64>> {
    (contacts.len() <= DENSE).then(|| rising(&scaled(problem, contacts)))
}

/// λmax(W_D⁻¹ W_off), where W_off is what of W couples contacts of different subdomains (–); `None` if there are too many.
///
/// All subdomains sweep at once, with whole masses: r ← r − N⁻¹ (W r + b) on closed contacts, N the lower triangles of the blocks
/// of W. Then N + Nᵗ − W = W_D − W_off, and q(r) decreases wherever this is positive: below 1.
pub fn coupling<const D: usize>(problem: &ContactProblem<Smooth<D>>, subdomain: &[u32]) -> Option<f64> {
    if subdomain.len() > DENSE {
        return None;
    }
    let mut matrix = scaled(problem, &(0..subdomain.len()).collect::<Vec<_>>());
    for (row, e) in subdomain.iter().enumerate() {
        for (column, f) in subdomain.iter().enumerate() {
            if e == f {
                matrix[(row, column)] = 0.0;
            }
        }
    }
    Some(rising(&matrix).last().copied().unwrap_or(0.0))
}

/// W_D^-½ W W_D^-½ over `contacts`.
fn scaled<const D: usize>(problem: &ContactProblem<Smooth<D>>, contacts: &[usize]) -> DMatrix<f64> {
    let diagonal = problem.delassus_diagonal();
    let (mut p, mut w_p) = (vec![0.0; diagonal.len()], vec![0.0; diagonal.len()]);
    let mut scratch = vec![SVector::zeros(); problem.grain_count()];
    let mut matrix = DMatrix::zeros(contacts.len(), contacts.len());
    for (column, beta) in contacts.iter().enumerate() {
        p[*beta] = 1.0;
        problem.delassus_product(&p, &mut w_p, &mut scratch);
        p[*beta] = 0.0;
        for (row, alpha) in contacts.iter().enumerate() {
            matrix[(row, column)] = w_p[*alpha] / (diagonal[*alpha] * diagonal[*beta]).sqrt();
        }
    }
    matrix
}

fn rising(matrix: &DMatrix<f64>) -> Vec<f64> {
    // The library takes no empty matrix.
    if matrix.is_empty() {
        return Vec::new();
    }
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// λmax(W_D⁻¹ W) by power iteration: a lower bound, close where the eigenvalues below it are apart (–). 0 without contact.
pub fn greatest_eigenvalue<const D: usize>(problem: &ContactProblem<Smooth<D>>) -> f64 {
    let diagonal = problem.delassus_diagonal();
    let n = problem.contact_count();
    // Without any symmetry, so that it is orthogonal to no eigenvector.
    let mut p: Vec<f64> = (0..n).map(|k| 0.5 - (k as f64 * 0.618_034).fract()).collect();
    let (mut w_p, mut scratch) = (vec![0.0; n], vec![SVector::zeros(); problem.grain_count()]);
    let mut eigenvalue: f64 = 0.0;
    for _ in 0..PRODUCTS {
        problem.delassus_product(&p, &mut w_p, &mut scratch);
        // Rayleigh quotient in the scalar product of W_D, in which W_D⁻¹ W is symmetric.
        let energy: f64 = p.iter().zip(&w_p).map(|(p, w)| p * w).sum();
        let norm: f64 = p.iter().zip(&diagonal).map(|(p, w)| p * p * w).sum();
        if !(norm > 0.0) {
            break;
        }
        eigenvalue = eigenvalue.max(energy / norm);
        p.iter_mut().zip(w_p.iter().zip(&diagonal)).for_each(|(p, (w, d))| *p = w / d / norm.sqrt());
    }
    eigenvalue
}

#[cfg(test)]
mod tests;
