//! The spectrum of W_D⁻¹ W, on which the rates and the limits of most methods hang. W_D is the diagonal of W.

use crate::problem::{Contact, ContactProblem};
use nalgebra::{DMatrix, Vector2};

/// Products W p of a power iteration: on packings the quotient then stands to some four digits.
const PRODUCTS: u32 = 300;

/// Up to this many contacts all eigenvalues are computed, in the order of n³ operations.
const DENSE: usize = 400;

/// Eigenvalues below this share of the greatest are those of redundant contacts, 0 but for round-off (–).
const ZERO: f64 = 1e-13;

/// What is computed of the spectrum of a problem.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// λmax(W_D⁻¹ W) over all contacts (–).
    pub greatest: f64,
    /// The same over the closed contacts; only where these are few enough.
    pub closed: Option<Closed>,
}

/// Eigenvalues of W_D⁻¹ W over the contacts that stay closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closed {
    /// λ̃max (–).
    pub greatest: f64,
    /// λ̃min, the least that is not 0 (–).
    pub least: f64,
    /// How many are 0: contacts more than equilibrium needs.
    pub redundant: usize,
}

impl Spectrum {
    /// The spectrum of `problem`, of which `closed` says which contacts stay closed, where that is known.
    pub fn of(problem: &ContactProblem, closed: Option<&[bool]>) -> Self {
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
fn eigenvalues(problem: &ContactProblem, contacts: &[usize]) -> Option<Vec<f64>> {
    (contacts.len() <= DENSE).then(|| rising(&scaled(problem, contacts)))
}

/// λmax(W_D⁻¹ W_off), where W_off is what of W couples contacts of different subdomains (–); `None` if there are too many.
///
/// All subdomains sweep at once, with whole masses: r ← r − N⁻¹ (W r + b) on closed contacts, N the lower triangles of the blocks
/// of W. Then N + Nᵗ − W = W_D − W_off, and q(r) decreases wherever this is positive: below 1.
pub fn coupling(problem: &ContactProblem, subdomain: &[u32]) -> Option<f64> {
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
fn scaled(problem: &ContactProblem, contacts: &[usize]) -> DMatrix<f64> {
    let diagonal = problem.delassus_diagonal();
    let (mut p, mut w_p) = (vec![0.0; diagonal.len()], vec![0.0; diagonal.len()]);
    let mut scratch = vec![Vector2::zeros(); problem.grain_count()];
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
pub fn greatest_eigenvalue(problem: &ContactProblem) -> f64 {
    let diagonal = problem.delassus_diagonal();
    let n = problem.contact_count();
    // Without any symmetry, so that it is orthogonal to no eigenvector.
    let mut p: Vec<f64> = (0..n).map(|k| 0.5 - (k as f64 * 0.618_034).fract()).collect();
    let (mut w_p, mut scratch) = (vec![0.0; n], vec![Vector2::zeros(); problem.grain_count()]);
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

/// Λ ≥ λmax(W_D⁻¹ W), in one pass over the contacts (–).
///
/// Both matrices are sums over grains: rᵗ W r = `Σ_i` |`Σ_α` n_α r_α|²/`m_i` and rᵗ W_D r = `Σ_i` `Σ_α` r_α²/`m_i`, α over
/// the contacts of grain i. Grain by grain the first is at most μ_i times the second, with μ_i the greatest eigenvalue of the
/// 2×2 matrix `Σ_α` n nᵗ; so Λ = `max_i` μ_i. On a triangular crystal both are 3.
pub fn eigenvalue_bound(problem: &ContactProblem) -> f64 {
    // Σ n nᵗ as its trace k and its deviator (Σ cos 2φ, Σ sin 2φ): μ = (k + |deviator|)/2.
    let mut sums = vec![(0.0, Vector2::zeros()); problem.grain_count()];
    for contact in problem.contacts() {
        let n = contact.normal;
        let deviator = Vector2::new(n.x * n.x - n.y * n.y, 2.0 * n.x * n.y);
        for grain in contact.grains() {
            let (trace, sum) = &mut sums[grain as usize];
            *trace += n.norm_squared();
            *sum += deviator;
        }
    }
    sums.iter().map(|(trace, deviator)| 0.5 * (trace + deviator.norm())).fold(0.0, f64::max)
}

/// Λ = `max_α` (`k_i/m_i` + `k_j/m_j`) ≥ λmax(W), where `k_i` contacts hold grain i: Gershgorin's circles, with
/// |`W_αβ`| ≤ 1/m for contacts that share a grain of mass m (1/kg).
pub fn delassus_bound(problem: &ContactProblem) -> f64 {
    let mut row = vec![0.0; problem.grain_count()];
    for contact in problem.contacts() {
        for grain in contact.grains() {
            row[grain as usize] += 1.0 / problem.mass()[grain as usize];
        }
    }
    let of_contact = |contact: &Contact| {
        row[contact.candidate as usize] + contact.antagonist.map_or(0.0, |j| row[j as usize])
    };
    problem.contacts().iter().map(of_contact).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n discs of mass 1 on a floor, one on top of the other.
    fn column(n: u32) -> ContactProblem {
        let up = Vector2::y();
        let contact =
            |k: u32| Contact { candidate: k, antagonist: k.checked_sub(1), normal: up, offset: 0.0 };
        let grains = n as usize;
        let position = (0..n).map(|k| up * f64::from(k)).collect();
        ContactProblem::new(vec![1.0; grains], position, vec![-up; grains], (0..n).map(contact).collect())
            .unwrap()
    }

    /// W_D^-½ W W_D^-½ of a column is tridiagonal: 1 − cos((2j − 1)π/2n) are its eigenvalues.
    #[test]
    fn eigenvalues_of_a_column_are_those_of_a_chain() {
        let n = 12;
        let values = eigenvalues(&column(n), &(0..n as usize).collect::<Vec<_>>()).unwrap();
        for (j, value) in values.iter().enumerate() {
            let expected = 1.0 - ((2 * j + 1) as f64 * std::f64::consts::PI / f64::from(2 * n)).cos();
            assert!((value - expected).abs() < 1e-13, "{value}, {expected} expected");
        }
    }

    #[test]
    fn copies_of_a_contact_multiply_the_greatest_eigenvalue_and_are_redundant() {
        let once = column(5);
        let twice: Vec<Contact> = once.contacts().iter().flat_map(|contact| [*contact; 2]).collect();
        let (mass, position) = (once.mass().to_vec(), once.position().to_vec());
        let twice = ContactProblem::new(mass, position, once.free_velocity().to_vec(), twice).unwrap();
        let spectrum = |problem: &ContactProblem| {
            Spectrum::of(problem, Some(&vec![true; problem.contact_count()])).closed.unwrap()
        };
        let (once, twice) = (spectrum(&once), spectrum(&twice));
        assert_eq!((once.redundant, twice.redundant), (0, 5));
        assert!((twice.greatest / once.greatest - 2.0).abs() < 1e-12);
        assert!((twice.least / once.least - 2.0).abs() < 1e-10);
    }

    #[test]
    fn bound_is_above_the_greatest_eigenvalue_and_the_power_iteration_below() {
        for n in [1, 2, 7, 40] {
            let problem = column(n);
            let exact = Spectrum::of(&problem, None).greatest;
            assert!(greatest_eigenvalue(&problem) <= exact * (1.0 + 1e-14));
            assert!(exact <= eigenvalue_bound(&problem) * (1.0 + 1e-14), "n = {n}");
        }
    }

    #[test]
    fn no_contact_has_no_spectrum() {
        let problem =
            ContactProblem::new(vec![1.0], vec![Vector2::zeros()], vec![Vector2::zeros()], vec![]).unwrap();
        assert_eq!(Spectrum::of(&problem, Some(&[])), Spectrum::default());
        assert_eq!(eigenvalue_bound(&problem), 0.0);
    }
}
