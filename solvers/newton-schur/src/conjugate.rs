//! Conjugate gradients on S u = g, where S is known by what it does: in each iteration a solve inside each subdomain, and one more
//! of the preconditioner.
//!
//! Each direction is made conjugate to all before, and those of earlier solves with the same S are the first of the next: soft modes
//! of subdomains spread the spectrum so far that without that round-off takes several times as many iterations as there are
//! unknowns. C. Farhat, L. Crivelli, F.-X. Roux, Extending substructure based iterative solvers to multiple load and repeated
//! analyses, Comput. Methods Appl. Mech. Engrg. 117 (1994) 195-209.

use crate::interface::Subdomains;
use nalgebra::SVector;

/// Velocities or impulses of the boundary grains.
type Boundary<const D: usize> = Vec<SVector<f64, D>>;

/// The conjugate gradients, with the directions p of S so far, pᵗSp = 1.
pub(crate) struct Conjugate<const D: usize> {
    /// Whether z is Σ Dᵗ S_E⁻¹ D r, else r.
    pub(crate) neumann: bool,
    /// ‖S u − g‖/‖g‖ at which they end (–).
    accuracy: f64,
    /// p and S p of each direction, and memory for more.
    directions: Vec<[Boundary<D>; 2]>,
    /// How many of them are of S.
    count: usize,
    residual: Boundary<D>,
    z: Boundary<D>,
}

impl<const D: usize> Conjugate<D> {
    pub(crate) fn new(boundary: usize, neumann: bool, accuracy: f64) -> Self {
        let zeros = vec![SVector::zeros(); boundary];
        Self { neumann, accuracy, directions: Vec::new(), count: 0, residual: zeros.clone(), z: zeros }
    }

    /// S is another one now.
    pub(crate) fn renew(&mut self) {
        self.count = 0;
    }

    /// u ← S⁻¹ u to the accuracy, or until directions span all; says how many iterations that took.
    pub(crate) fn solve(&mut self, subdomains: &mut Subdomains<D>, u: &mut [SVector<f64, D>]) -> u64 {
        let (unknowns, before, mut iterations) = (D * u.len(), self.count, 0);
        self.residual.copy_from_slice(u);
        u.fill(SVector::zeros());
        let end = self.accuracy * dot(&self.residual, &self.residual).sqrt();
        for [p, s_p] in &self.directions[..before] {
            go(p, s_p, u, &mut self.residual);
        }
        while dot(&self.residual, &self.residual).sqrt() > end && self.count < unknowns {
            iterations += 1;
            if !self.turn(subdomains) {
                break;
            }
            let [p, s_p] = &self.directions[self.count];
            go(p, s_p, u, &mut self.residual);
            self.count += 1;
        }
        iterations
    }

    /// The next direction, p = z − Σ (zᵗSp_j) p_j, over √(pᵗSp); says whether there is one.
    fn turn(&mut self, subdomains: &mut Subdomains<D>) -> bool {
        let Self { directions, count, residual, z, neumann, .. } = self;
        if *neumann {
            z.fill(SVector::zeros());
            subdomains.add(z, |subdomain| subdomain.neumann(residual));
        } else {
            z.copy_from_slice(residual);
        }
        for [p, s_p] in &directions[..*count] {
            let along = dot(s_p, z);
            z.iter_mut().zip(p).for_each(|(z, p)| *z -= p * along);
        }
        if directions.len() == *count {
            directions.push([z.clone(), z.clone()]);
        }
        let [p, s_p] = &mut directions[*count];
        p.copy_from_slice(z);
        s_p.fill(SVector::zeros());
        subdomains.add(s_p, |subdomain| subdomain.schur(p));
        let scale = 1.0 / dot(p, s_p).sqrt();
        p.iter_mut().chain(s_p).for_each(|x| *x *= scale);
        scale > 0.0 && scale.is_finite()
    }
}

/// u ← u + α p and r ← r − α S p, with α = rᵗp.
fn go<const D: usize>(
    p: &[SVector<f64, D>],
    s_p: &[SVector<f64, D>],
    u: &mut [SVector<f64, D>],
    residual: &mut [SVector<f64, D>],
) {
    let length = dot(p, residual);
    u.iter_mut().zip(p).for_each(|(u, p)| *u += p * length);
    residual.iter_mut().zip(s_p).for_each(|(residual, s_p)| *residual -= s_p * length);
}

fn dot<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
