//! Conjugate gradients on S u = g, where S is known by what it does: in each iteration a solve inside each subdomain, and one more
//! of the preconditioner.

use crate::interface::Subdomains;
use nalgebra::SVector;

/// How conjugate gradients are preconditioned.
pub(crate) struct Conjugate<const D: usize> {
    /// Σ 1/m S_E⁻¹ 1/m, or nothing.
    pub(crate) neumann: bool,
    /// ‖S u − g‖/‖g‖ at which they end (–).
    pub(crate) accuracy: f64,
    residual: Vec<SVector<f64, D>>,
    z: Vec<SVector<f64, D>>,
    p: Vec<SVector<f64, D>>,
    s_p: Vec<SVector<f64, D>>,
}

/// Iterations per unknown after which they end all the same (–): in exact arithmetic one is enough.
const MOST: usize = 4;

impl<const D: usize> Conjugate<D> {
    pub(crate) fn new(boundary: usize, neumann: bool, accuracy: f64) -> Self {
        let zeros = vec![SVector::zeros(); boundary];
        Self { neumann, accuracy, residual: zeros.clone(), z: zeros.clone(), p: zeros.clone(), s_p: zeros }
    }

    /// u ← S⁻¹ u, to the accuracy; says how many iterations that took.
    ///
    /// z = Σ 1/m S_E⁻¹ 1/m r,   p ← z + (rᵗz/r₋ᵗz₋) p,   α = rᵗz/pᵗSp,   u ← u + α p,   r ← r − α S p
    pub(crate) fn solve(&mut self, subdomains: &mut Subdomains<D>, u: &mut [SVector<f64, D>]) -> u64 {
        self.residual.copy_from_slice(u);
        u.fill(SVector::zeros());
        self.p.fill(SVector::zeros());
        let end = self.accuracy * dot(&self.residual, &self.residual).sqrt();
        let (mut iterations, mut before) = (0, f64::INFINITY);
        while dot(&self.residual, &self.residual).sqrt() > end && iterations < (MOST * D * u.len()) as u64 {
            let Self { residual, z, p, s_p, .. } = self;
            if self.neumann {
                z.fill(SVector::zeros());
                subdomains.add(z, |subdomain| subdomain.neumann(residual));
            } else {
                z.copy_from_slice(residual);
            }
            let along = dot(residual, z);
            for (p, z) in p.iter_mut().zip(&*z) {
                *p = z + *p * (along / before);
            }
            before = along;
            s_p.fill(SVector::zeros());
            subdomains.add(s_p, |subdomain| subdomain.schur(p));
            let length = along / dot(p, s_p);
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            for (((u, residual), p), s_p) in u.iter_mut().zip(residual).zip(&*p).zip(&*s_p) {
                *u += p * length;
                *residual -= s_p * length;
            }
            iterations += 1;
        }
        iterations
    }
}

fn dot<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
