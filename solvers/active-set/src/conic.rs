//! Interior point over the cones of all contacts, in the velocities of grains: with σ of each contact,
//!
//! (μ `r_n`, `r_t`) ∈ C,   ((`v_n` + σ)/μ, `v_t`) ∈ C,   their product 0,   C = {x₀ ≥ |x₁|}
//!
//! is a convex programme where σ is frozen, and Coulomb's law where σ = μ|`v_t`|.
//!
//! The fixed point over programmes, each with the σ of the one before, ends at the law where σ stays. At rest nearly nothing moves, so that
//! σ = 0, the relaxation, is nearly the law: what is left is due to the few grains that do move, faster than the others by orders of
//! magnitude. Sweeps of non-linear Gauss-Seidel over their contacts alone settle them, and the next programme has their σ.
//!
//! V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb friction problem via convex
//! optimization, Z. Angew. Math. Mech. 91 (2011) 155-175; S. Mehrotra, On the implementation of a primal-dual interior point method,
//! SIAM J. Optim. 2 (1992) 575-601.

mod direction;

use crate::cone::{Scaling, product, quotient};
use crate::inner::ordered;
use crate::interior::{FROM, MOST_STEPS, NO_WAY, SHORT_OF_IT};
use crate::layout::Layout;
use cholesky::{Factor, Structure};
use contact::law::tangential;
use contact::status::unit;
use contact::{Cone, Frictional, Packing, Rough, SetupError, Visited, Work};
use nalgebra::SVector;
use std::sync::Arc;

/// The cones with some σ, and the interior point's iterate: x = T⁻¹ s and z in the place of T (v + σ n) in the cones of all contacts,
/// with T = diag(1/μ, 1, …) and, where there is no friction, diag(1, 0, …). Grains are in the order of the factor.
pub struct Conic<const D: usize, const N: usize>
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
    /// The least residual (√J), its x, and after how many steps it was left.
    best: (f64, Vec<SVector<f64, D>>, u32),
    /// √(Σ max(0, −`b_n`)²/`w_n`) (√J).
    scale: f64,
    work: Work,
}

/// Steps without a residual below all before, after which nothing leads on. Without this limit as many of 18 packings of 1,000 spheres at
/// rest come to 1e-6, two of them in 1.7 and 2.6 times as long.
const PATIENCE: u32 = 12;

/// Quantile of the speeds of grains below which they are still: what moves is faster than its geometric mean with the greatest (–). Where
/// most of 1,000 spheres are at rest there is a gap of four to six decades between, and any from 0.5 to 0.97 gives the same grains.
const STILL: f64 = 0.9;

/// Sweeps over the contacts of grains that move. With twenty times as many no more of 72 packings of 250 grains come to 1e-8.
const SWEEPS: u32 = 1000;

/// Residual over the problem's scale where it has come near enough; and where it has come too far to be called nearly solved (–). Where
/// contacts depend on each other round-off ends it between the two.
const NEAR: f64 = 1e-13;
const NEARLY: f64 = 1e-3;

impl<const D: usize, const N: usize> Conic<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Lays the problem out, for σ = 0, the relaxation.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub fn relaxation(problem: &Packing<Rough<D>>) -> Result<Self, SetupError> {
        let (ends, order) = ordered(problem)?;
        let structure = Structure::new(&ends, &order)?;
        let layout = Layout::placed(problem, |grain| structure.position()[grain as usize]);
        let shape = |friction: f64| {
            let mut shape = SVector::repeat(if friction > 0.0 { 1.0 } else { 0.0 });
            shape[0] = if friction > 0.0 { friction.recip() } else { 1.0 };
            shape
        };
        let contacts = layout.columns.len();
        let mut conic = Self {
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
        conic.begin();
        Ok(conic)
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

    /// Measures how far z is from T (v + σ n).
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

    /// √(Σ x · z + |T (v + σ n) − z|²): the residual (√J).
    fn left(&self) -> f64 {
        let products = self.x.iter().zip(&self.z).map(|(x, z)| x.dot(z));
        products.zip(&self.apart).map(|(product, apart)| product + apart.norm_squared()).sum::<f64>().sqrt()
    }

    /// One step, with one factorisation of 1 + Σ H̃ T W² T H̃ᵗ and two solves: towards x ∘ z = 0, and then
    /// towards what the way there allows. `false` if there is no way on, or no need: then the iterate is the best so far.
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
        let mut way = self.towards(&square, &self.x.iter().map(|x| -x).collect::<Vec<_>>());
        let lengths = self.lengths(&way, 1.0);
        let mean = self.mean(&way, [0.0; 2]);
        let centring = (self.mean(&way, lengths) / mean).clamp(0.0, 1.0).powi(3);
        let goal = |k: usize| {
            let (scaling, lambda) = (&scaling[k], scaling[k].times(&self.z[k]));
            let mut goal = -product(&lambda, &lambda);
            goal -= product(&scaling.inverse_times(&way.x[k]), &scaling.times(&way.z[k]));
            goal[0] += centring * mean;
            scaling.times(&quotient(&goal, &lambda))
        };
        let goals: Vec<_> = (0..self.x.len()).map(goal).collect();
        way = self.towards(&square, &goals);
        let [of_x, of_z] = self.lengths(&way, SHORT_OF_IT);
        if !(of_x.max(of_z) > NO_WAY) {
            return false;
        }
        self.x.iter_mut().zip(&way.x).for_each(|(x, dx)| *x += of_x * dx);
        self.z.iter_mut().zip(&way.z).for_each(|(z, dz)| *z += of_z * dz);
        self.measure();
        true
    }

    /// Solves the programme for the present σ; then takes σ = μ|`v_t`|. Returns whether it was solved, or nearly.
    pub fn advance(&mut self) -> bool {
        self.begin();
        while self.step() {}
        let solved = self.best.0 <= NEARLY * self.scale;
        let v = self.layout.velocity(&self.impulse());
        for (k, v) in v.into_iter().enumerate() {
            self.take_sigma(k, v);
        }
        solved
    }

    /// Takes σ = μ|`v_t`| of a contact with the velocity v (√J), with which the programme is Coulomb's law.
    fn take_sigma(&mut self, contact: usize, v: SVector<f64, D>) {
        self.sigma[contact] = self.layout.columns[contact].friction() * tangential(v).1;
    }

    /// Begins the next programme with the σ of the grains that move, once sweeps over their contacts have settled them while the others
    /// are held.
    pub(crate) fn settle(&mut self) {
        let mut s = self.layout.admitted(&self.impulse());
        let mut y = self.layout.pushed(self.layout.free.clone(), &s);
        let mut speeds: Vec<f64> = y.iter().map(SVector::norm).collect();
        speeds.sort_by(f64::total_cmp);
        let quantile = (STILL * speeds.len() as f64) as usize;
        let least =
            speeds.get(quantile).zip(speeds.last()).map_or(0.0, |(still, fastest)| (still * fastest).sqrt());
        let held: Vec<_> = y.iter().map(|y| (y.norm() < least).then_some(*y)).collect();
        let columns = &self.layout.columns;
        let moves = |k: &usize| columns[*k].places().iter().any(|place| held[*place as usize].is_none());
        let moving: Vec<usize> = (0..s.len()).filter(moves).collect();
        self.work.contact_updates += u64::from(SWEEPS) * moving.len() as u64;
        self.layout.sweep_held(&moving.iter().copied(), |grain| held[grain], &mut s, &mut y, SWEEPS);
        self.sigma.fill(0.0);
        for k in moving {
            let v = self.layout.columns[k].relative(&y) + self.layout.offset[k];
            self.take_sigma(k, v);
        }
        self.begin();
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
