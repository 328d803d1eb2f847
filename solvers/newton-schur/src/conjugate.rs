//! Conjugate gradients on S u = g, where S is known by what it does: in each iteration a solve inside each subdomain, and one more
//! of the preconditioner.
//!
//! Each direction is made conjugate to all before, and those of earlier solves with the same S are the first of the next: soft modes
//! of subdomains spread the spectrum so far that without that round-off takes several times as many iterations as there are
//! unknowns. C. Farhat, L. Crivelli, F.-X. Roux, Extending substructure based iterative solvers to multiple load and repeated
//! analyses, Comput. Methods Appl. Mech. Engrg. 117 (1994) 195-209.

use crate::interface::Subdomains;
use nalgebra::SVector;

/// Work of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Taken {
    /// Iterations, and so solves with the preconditioner.
    pub(crate) iterations: u64,
    /// Products with S: those of the iterations, and of coarse directions.
    pub(crate) products: u64,
}

/// Velocities or impulses of the boundary grains.
type Boundary<const D: usize> = Vec<SVector<f64, D>>;

/// The conjugate gradients, with the directions p of S so far, pᵗSp = 1.
pub(crate) struct Conjugate<const D: usize> {
    /// True where z is Σ Dᵗ S_E⁻¹ D r, else r.
    pub(crate) neumann: bool,
    /// True where the first directions of each S are the translations of subdomains.
    pub(crate) coarse: bool,
    /// ‖S u − g‖/‖g‖ at which they end (–).
    accuracy: f64,
    /// p and S p of each direction, and memory for more.
    directions: Vec<[Boundary<D>; 2]>,
    /// Number of them that are of S.
    count: usize,
    residual: Boundary<D>,
    z: Boundary<D>,
}

impl<const D: usize> Conjugate<D> {
    pub(crate) fn new(boundary: usize, (neumann, coarse): (bool, bool), accuracy: f64) -> Self {
        let zeros = vec![SVector::zeros(); boundary];
        Self {
            neumann,
            coarse,
            accuracy,
            directions: Vec::new(),
            count: 0,
            residual: zeros.clone(),
            z: zeros,
        }
    }

    /// S is another one now.
    pub(crate) fn renew(&mut self) {
        self.count = 0;
    }

    /// u ← S⁻¹ u to the accuracy, or until directions span all; says what that took.
    pub(crate) fn solve(&mut self, subdomains: &mut Subdomains<D>, u: &mut [SVector<f64, D>]) -> Taken {
        let mut taken = Taken::default();
        if self.coarse && self.count == 0 {
            taken.products += self.translations(subdomains);
        }
        self.residual.copy_from_slice(u);
        u.fill(SVector::zeros());
        let end = self.accuracy * dot(&self.residual, &self.residual).sqrt();
        for [p, s_p] in &self.directions[..self.count] {
            go(p, s_p, u, &mut self.residual);
        }
        while dot(&self.residual, &self.residual).sqrt() > end && self.count < D * u.len() {
            self.precondition(subdomains);
            taken.iterations += 1;
            taken.products += 1;
            if !self.turn(subdomains) {
                break;
            }
            let [p, s_p] = &self.directions[self.count - 1];
            go(p, s_p, u, &mut self.residual);
        }
        taken
    }

    /// Begins with the translations of each subdomain, of which a boundary grain has D_E; says how many products that took.
    fn translations(&mut self, subdomains: &mut Subdomains<D>) -> u64 {
        let mut products = 0;
        for e in 0..subdomains.own.len() {
            for axis in 0..D {
                let subdomain = &subdomains.own[e];
                if subdomain.boundary.is_empty() || self.count == D * self.z.len() {
                    continue;
                }
                self.z.fill(SVector::zeros());
                for (k, weight) in subdomain.boundary.iter().zip(&subdomain.weight) {
                    self.z[*k as usize] = weight.column(axis).into_owned();
                }
                products += 1;
                self.turn(subdomains);
            }
        }
        products
    }

    /// z from the residual.
    fn precondition(&mut self, subdomains: &mut Subdomains<D>) {
        let Self { residual, z, neumann, .. } = self;
        if *neumann {
            z.fill(SVector::zeros());
            subdomains.add(z, |subdomain| subdomain.neumann(residual));
        } else {
            z.copy_from_slice(residual);
        }
    }

    /// The next direction, p = z − Σ (zᵗSp_j) p_j, over √(pᵗSp); says whether there is one.
    fn turn(&mut self, subdomains: &mut Subdomains<D>) -> bool {
        let Self { directions, count, z, .. } = self;
        let given = dot(z, z);
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
        // Of a z among those before round-off is left.
        let is_new = dot(z, z) > (64.0 * f64::EPSILON).powi(2) * given && scale.is_finite();
        *count += usize::from(is_new);
        is_new
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
