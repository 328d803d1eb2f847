//! That impulses near a ray balance exactly, without these impulses: where contacts hold each other in more ways than grains can
//! move, a small change makes up for any round-off.
//!
//! With D the sizes of d > 0, H D² Hᵗ y = −H d has a solution if the matrix is regular, and d̂ = d + D² Hᵗ y balances, H d̂ = 0. No d̂
//! is farther from its d than d ‖H d‖/σ, with σ² ≤ λmin(H D² Hᵗ): d̂ > 0 for ‖H d‖ < σ, and cᵗ d̂ ≤ cᵗ d + Σ |c| d ‖H d‖/σ. That σ is
//! none too great, a factor of H D² Hᵗ − σ² in double precision proves (S. M. Rump, Verification of positive definiteness, BIT 46
//! (2006) 433-452).

use super::exact::{Entries, Thrust};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::collections::BTreeMap;

/// Translations of a dense factor.
const MOST: usize = 800;

/// Times that the ray is balanced in double precision.
const SOLVES: u32 = 3;

/// Some `thrusts` that grains join, with the place of each translation in y.
struct Ray<'t> {
    thrusts: &'t [Thrust],
    columns: Vec<Vec<(usize, f64)>>,
    d: Vec<f64>,
    places: usize,
}

/// Decides whether impulses d̂ ≥ 0 near these `thrusts`, all above 0, balance exactly while contacts approach; `false` says nothing.
pub(super) fn balances(thrusts: &[Thrust], entries: &Entries) -> bool {
    let Some(mut ray) = Ray::new(thrusts, entries) else { return false };
    ray.balance() && ray.proves().unwrap_or(false)
}

impl<'t> Ray<'t> {
    fn new(thrusts: &'t [Thrust], entries: &Entries) -> Option<Self> {
        // Where no wall has a normal along an axis, the sum of H d over the grains is 0 along it, and one grain's part says nothing.
        let walls = || thrusts.iter().filter(|thrust| thrust.ends.1.is_none());
        let is_free = |axis: usize| walls().all(|wall| wall.normal[axis] == 0.0);
        let mut held: Vec<(u32, usize)> = Vec::new();
        for at in entries.places.keys() {
            if is_free(at.1) && held.iter().all(|(_, axis)| *axis != at.1) {
                held.push(*at);
            }
        }
        let kept = entries.places.keys().filter(|at| !held.contains(at));
        let places: BTreeMap<(u32, usize), usize> = kept.copied().zip(0..).collect();
        let column = |thrust: &Thrust| -> Vec<(usize, f64)> {
            thrust.entries().filter_map(|(at, a)| Some((*places.get(&at)?, a))).collect()
        };
        (places.len() <= MOST).then(|| Self {
            thrusts,
            columns: thrusts.iter().map(column).collect(),
            d: thrusts.iter().map(|thrust| thrust.impulse).collect(),
            places: places.len(),
        })
    }

    /// H d, and the sizes of its terms.
    fn pushed(&self) -> (DVector<f64>, DVector<f64>) {
        let (mut sums, mut sizes) = (DVector::zeros(self.places), DVector::zeros(self.places));
        for (column, d) in self.columns.iter().zip(&self.d) {
            for (place, a) in column {
                sums[*place] += a * d;
                sizes[*place] += (a * d).abs();
            }
        }
        (sums, sizes)
    }

    /// H D² Hᵗ.
    fn matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.places, self.places);
        for (column, d) in self.columns.iter().zip(&self.d) {
            for (p, a) in column {
                for (q, b) in column {
                    matrix[(*p, *q)] += (a * d) * (b * d);
                }
            }
        }
        matrix
    }

    /// d ← d − D² Hᵗ (H D² Hᵗ)⁻¹ H d; says whether it could, and left all above 0.
    fn balance(&mut self) -> bool {
        let Some(factor): Option<Cholesky<f64, Dyn>> = self.matrix().cholesky() else { return false };
        for _ in 0..SOLVES {
            let y = factor.solve(&self.pushed().0);
            for (column, d) in self.columns.iter().zip(&mut self.d) {
                let moved: f64 = column.iter().map(|(place, a)| a * y[*place]).sum();
                *d -= *d * *d * moved;
            }
        }
        self.d.iter().all(|d| *d > 0.0)
    }

    /// Decides whether it is proved; `None` where the matrix may be singular.
    fn proves(&self) -> Option<bool> {
        // Sums have no more terms than this, and each of them no greater error than this share of the sizes of its terms; of numbers
        // too small for that, what is lost is added.
        let terms = (self.places + self.d.len() + 16) as f64;
        let (share, lost) = (2.0 * terms * f64::EPSILON, terms * f64::MIN_POSITIVE);
        let (sums, sizes) = self.pushed();
        let squared: f64 =
            sums.iter().zip(&sizes).map(|(sum, size)| (sum.abs() + share * size + lost).powi(2)).sum();
        let unbalanced = (1.0 + share) * squared;
        let mut matrix = self.matrix();
        // No eigenvalue is off by more: neither of the matrix as it is made, nor of the product of its factors.
        let error = share * matrix.trace() + lost;
        let shift = 4.0 * error + 4.0 * unbalanced;
        for place in 0..self.places {
            matrix[(place, place)] -= shift;
        }
        matrix.cholesky()?;
        let change = (1.0 + share) * (unbalanced / (shift - 3.0 * error)).sqrt();
        let (mut work, mut size) = (0.0, 0.0);
        for (thrust, d) in self.thrusts.iter().zip(&self.d) {
            work -= thrust.offset * d;
            size += (thrust.offset * d).abs();
        }
        Some(change < 1.0 && work > (1.0 + share) * (share + change) * size + lost)
    }
}
