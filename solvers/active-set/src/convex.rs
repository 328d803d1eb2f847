//! The convex neighbour of Coulomb's law, and the fixed point over it: with σ = μ|`v_t`| of each contact frozen,
//!
//! (μ `r_n`, `r_t`) ∈ C,   ((`v_n` + σ)/μ, `v_t`) ∈ C,   their product 0,   C = {x₀ ≥ |x₁|}
//!
//! is a convex programme, for a primal-dual interior point in the velocities of grains. Where it leaves σ as it was, the law holds.
//! Nothing moves along its tangent in a packing at rest: there σ = 0 does it at once.
//!
//! V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb friction problem via convex
//! optimization, Z. Angew. Math. Mech. 91 (2011) 155-175; S. Mehrotra, On the implementation of a primal-dual interior point method,
//! SIAM J. Optim. 2 (1992) 575-601.

use crate::cone::{Scaling, product, quotient, reach};
use crate::inner::ordered;
use crate::interior::{FROM, MOST_STEPS, NO_WAY, SHORT_OF_IT};
use crate::layout::Layout;
use cholesky::{Coupling, Factor, Structure};
use contact::law::tangential;
use contact::status::unit;
use contact::{Cone, Frictional, Mechanics, Packing, Rough, SetupError, Visited, Work};
use nalgebra::{SMatrix, SVector};
use std::sync::Arc;

/// The programme for some σ, and the interior point's iterate: x = T⁻¹ s and z in the place of T (v + σ n) in the cones of all contacts,
/// with T = diag(1/μ, 1, …) and, where there is no friction, diag(1, 0, …). Grains are in the order of the factor.
pub struct Convex<const D: usize, const N: usize>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    structure: Arc<Structure<N>>,
    factor: Option<Factor<N>>,
    layout: Layout<D, N>,
    /// Diagonal of each T (–).
    shape: Vec<SVector<f64, D>>,
    /// σ/√`w_n` (√J).
    sigma: Vec<f64>,
    /// √J.
    x: Vec<SVector<f64, D>>,
    z: Vec<SVector<f64, D>>,
    /// T (v + σ n) − z (√J).
    apart: Vec<SVector<f64, D>>,
    steps: u32,
    /// The least residual (√J), its x, and after how many steps.
    best: (f64, Vec<SVector<f64, D>>, u32),
    /// √(Σ max(0, −`b_n`)²/`w_n`) (√J).
    scale: f64,
    work: Work,
}

/// Steps that leave no less than one before, after which round-off leads nowhere.
const PATIENCE: u32 = 8;

/// Residual over the problem's scale where it has come near enough; and where it has come too far to be called nearly solved (–). Where
/// contacts depend on each other round-off ends it between the two.
const NEAR: f64 = 1e-13;
const NEARLY: f64 = 1e-3;

/// Direction of x and z.
type Direction<const D: usize> = (Vec<SVector<f64, D>>, Vec<SVector<f64, D>>);

impl<const D: usize, const N: usize> Convex<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Lays the problem out, for σ = 0, the relaxation.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub fn new(problem: &Packing<Rough<D>>) -> Result<Self, SetupError> {
        let (ends, order) = ordered(problem)?;
        let structure = Structure::new(&ends, &order)?;
        let layout = Layout::placed(problem, |grain| structure.position()[grain as usize]);
        let shape = |friction: f64| {
            let mut shape = SVector::repeat(if friction > 0.0 { 1.0 } else { 0.0 });
            shape[0] = if friction > 0.0 { friction.recip() } else { 1.0 };
            shape
        };
        let contacts = layout.columns.len();
        let mut convex = Self {
            shape: layout.columns.iter().map(|column| shape(column.friction())).collect(),
            sigma: vec![0.0; contacts],
            x: vec![SVector::zeros(); contacts],
            z: vec![SVector::zeros(); contacts],
            apart: Vec::new(),
            steps: 0,
            best: (f64::INFINITY, Vec::new(), 0),
            scale: problem.scale().sqrt(),
            factor: None,
            work: Work::default(),
            structure,
            layout,
        };
        convex.begin();
        Ok(convex)
    }

    /// Begins away from all bounds.
    fn begin(&mut self) {
        let away = FROM * self.scale / (self.x.len().max(1) as f64).sqrt();
        self.x = self.shape.iter().map(|shape| unit(0) * (away / shape[0])).collect();
        // With z = 0.
        self.z.fill(SVector::zeros());
        self.measure();
        for (z, apart) in self.z.iter_mut().zip(&mut self.apart) {
            *z = *apart;
            z[0] = z[0].max(tangential(*z).1 + away);
            *apart -= *z;
        }
        (self.steps, self.best) = (0, (self.left(), self.x.clone(), 0));
    }

    /// Asks of the next programme that `v_n` be above μ|`v_t`| by a margin at each contact (m/s).
    pub fn ask_for(&mut self, margin: f64) {
        for (sigma, unit) in self.sigma.iter_mut().zip(&self.layout.unit) {
            *sigma = -margin / unit[0];
        }
    }

    /// s = T x (√J).
    fn impulse(&self) -> Vec<SVector<f64, D>> {
        self.x.iter().zip(&self.shape).map(|(x, shape)| x.component_mul(shape)).collect()
    }

    /// Measures how far z is from T (v + σ n) of the impulses.
    fn measure(&mut self) {
        self.work.delassus_products += 1;
        self.apart = self.layout.velocity(&self.impulse());
        let contacts = self.sigma.iter().zip(&self.shape).zip(&self.z);
        for (apart, ((sigma, shape), z)) in self.apart.iter_mut().zip(contacts) {
            apart[0] += sigma;
            apart.component_mul_assign(shape);
            *apart -= z;
        }
    }

    /// √(Σ x · z + |T (v + σ n) − z|²): the residual of the programme (√J).
    fn left(&self) -> f64 {
        let products = self.x.iter().zip(&self.z).map(|(x, z)| x.dot(z));
        products.zip(&self.apart).map(|(product, apart)| product + apart.norm_squared()).sum::<f64>().sqrt()
    }

    /// One step of the interior point, with one factorisation of 1 + Σ H̃ T W² T H̃ᵗ and two solves: towards x ∘ z = 0, and then towards
    /// what the way there allows. `false` if there is no way on, or no need: then the iterate is the best so far.
    pub fn step(&mut self) -> bool {
        self.steps += 1;
        let goes_on = self.best.0 > NEAR * self.scale && self.steps <= MOST_STEPS && self.advance_by_newton();
        let left = if goes_on { self.left() } else { f64::INFINITY };
        if left < self.best.0 {
            self.best = (left, self.x.clone(), self.steps);
        }
        let goes_on = goes_on && self.steps < self.best.2 + PATIENCE;
        if !goes_on {
            self.x.clone_from(&self.best.1);
        }
        goes_on
    }

    fn advance_by_newton(&mut self) -> bool {
        let scaling: Vec<_> = self.x.iter().zip(&self.z).map(|(x, z)| Scaling::new(x, z)).collect();
        let square: Vec<_> = scaling.iter().map(Scaling::square).collect();
        if !self.factorise(&square) {
            return false;
        }
        let (dx, dz) = self.towards(&square, &self.x.iter().map(|x| -x).collect::<Vec<_>>());
        let lengths = self.reach(&dx, &dz).map(|reach| reach.min(1.0));
        let mean = self.mean(&dx, &dz, [0.0; 2]);
        let centring = (self.mean(&dx, &dz, lengths) / mean).clamp(0.0, 1.0).powi(3);
        let goal = |k: usize| {
            let (scaling, lambda) = (&scaling[k], scaling[k].times(&self.z[k]));
            let mut goal = -product(&lambda, &lambda);
            goal -= product(&scaling.inverse_times(&dx[k]), &scaling.times(&dz[k]));
            goal[0] += centring * mean;
            scaling.times(&quotient(&goal, &lambda))
        };
        let goals: Vec<_> = (0..self.x.len()).map(goal).collect();
        let (dx, dz) = self.towards(&square, &goals);
        let [of_x, of_z] = self.reach(&dx, &dz).map(|reach| (SHORT_OF_IT * reach).min(1.0));
        if !(of_x.max(of_z) > NO_WAY) {
            return false;
        }
        self.x.iter_mut().zip(&dx).for_each(|(x, dx)| *x += of_x * dx);
        self.z.iter_mut().zip(&dz).for_each(|(z, dz)| *z += of_z * dz);
        self.measure();
        true
    }

    fn factorise(&mut self, square: &[SMatrix<f64, D, D>]) -> bool {
        self.work.factorisations += 1;
        self.work.factorisation_multiply_adds += self.structure.work();
        let Self { layout, shape, structure, factor, .. } = self;
        let coupling = |contact: usize| {
            let pushes: [_; D] =
                std::array::from_fn(|c| layout.columns[contact].pushes(unit(c) * shape[contact][c]));
            let rows = [0, 1].map(|end| SMatrix::<f64, N, D>::from_columns(&pushes.map(|of| of[end])));
            Some(Coupling::product(rows, square[contact]))
        };
        let done = Factor::replace(factor, structure, |_| SVector::repeat(1.0), coupling);
        // Two solves, each with the factor and its transpose.
        self.work.triangular_solve_entries += if done { 4 * self.structure.entries() as u64 } else { 0 };
        done
    }

    /// Newton's direction towards dx + W² dz = `goal`:
    ///
    /// (1 + Σ H̃ T W² T H̃ᵗ) dy = Σ H̃ T (goal − W² apart),   dz = T H̃ᵗ dy + apart,   dx = goal − W² dz
    fn towards(&self, square: &[SMatrix<f64, D, D>], goal: &[SVector<f64, D>]) -> Direction<D> {
        let apart = &self.apart;
        let contacts = || self.layout.columns.iter().zip(&self.shape).enumerate();
        let mut y = vec![SVector::zeros(); self.layout.free.len()];
        for (k, (column, shape)) in contacts() {
            column.push((goal[k] - square[k] * apart[k]).component_mul(shape), &mut y);
        }
        if let Some(factor) = &self.factor {
            factor.solve(&mut y);
        }
        let of = |(k, (column, shape)): (usize, (&<Rough<D> as Mechanics>::Column, &SVector<f64, D>))| {
            let dz = column.relative(&y).component_mul(shape) + apart[k];
            (goal[k] - square[k] * dz, dz)
        };
        contacts().map(of).unzip()
    }

    /// Returns the longest steps that keep x and z in their cones.
    fn reach(&self, dx: &[SVector<f64, D>], dz: &[SVector<f64, D>]) -> [f64; 2] {
        let least = |x: &[SVector<f64, D>], dx: &[SVector<f64, D>]| {
            x.iter().zip(dx).map(|(x, dx)| reach(x, dx)).fold(f64::INFINITY, f64::min)
        };
        [least(&self.x, dx), least(&self.z, dz)]
    }

    /// The mean of x · z after steps of these lengths.
    fn mean(&self, dx: &[SVector<f64, D>], dz: &[SVector<f64, D>], [of_x, of_z]: [f64; 2]) -> f64 {
        let of = |k: usize| (self.x[k] + of_x * dx[k]).dot(&(self.z[k] + of_z * dz[k]));
        (0..self.x.len()).map(of).sum::<f64>() / self.x.len() as f64
    }

    /// Solves the programme for the present σ; then takes σ = μ|`v_t`|. Returns whether it was solved, or nearly.
    pub fn advance(&mut self) -> bool {
        self.begin();
        while self.step() {}
        let solved = self.best.0 <= NEARLY * self.scale;
        for (v, (sigma, column)) in
            self.layout.velocity(&self.impulse()).iter().zip(self.sigma.iter_mut().zip(&self.layout.columns))
        {
            *sigma = column.friction() * tangential(*v).1;
        }
        solved
    }

    /// Work so far.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Impulses in the problem's order (N·s), within the cones.
    pub fn impulses(&self, r: &mut [f64]) {
        self.layout.impulses(&self.impulse(), r);
    }
}

#[cfg(test)]
mod tests;
