//! The conjugate gradient with friction, in the unknowns of [`Product`]: contacts are open, stick or slide, and the gradient is
//! projected by these statuses.
//!
//! Nothing is minimised: Coulomb's law is not the optimality of any q(r). The step is that of the quadratic form all the same, and
//! what makes it work is that a contact leaves the boundary of its cone by a direction only, never because the cone grew around it;
//! and, in space, that what slides takes of the gradient around its cone only what the projection would.

use crate::{Cg, Products, State};
use analysis::Bounded;
use contact::{Frictional, Iteration, Packing, Rough, SetupError, Solver, Vector, Work};
use nalgebra::SVector;
use partition::{Distributed, Refused, Share, Team};
use product::{Layout, Product};

/// A run on one problem of grains with friction.
pub type RoughRun<const D: usize = 2> = ConeRun<Product<State<D>, Rough<D>>, D>;

/// A run on one problem whose law is a cone at each contact.
pub struct ConeRun<P, const D: usize> {
    contacts: P,
    /// Λ ≥ λmax.
    greatest: f64,
    /// uᵗ p and pᵗ p.
    descent: f64,
    squared: f64,
    iterations: u64,
    products: u64,
}

/// After so many iterations u is made from r, as without friction.
const WHOLE: u64 = 16;

/// Round-off, with a margin, of M^-½ H p relative to √Λ |p| (–): pᵗ W p says nothing below its square.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

impl<P: Products<D>, const D: usize> ConeRun<P, D> {
    /// Begins from the impulses that the contacts have; `greatest` is at least λmax of W in their units.
    pub fn new(contacts: P, greatest: f64) -> Self {
        let mut run = Self { contacts, greatest, descent: 0.0, squared: 0.0, iterations: 0, products: 0 };
        run.renew();
        run.turn(0.0);
        run
    }

    /// √(Σ `W_αα` |r − r⁺|²) of the iterate, from its gradient (√J): what the measure `natural_map` is a share of, with the diagonal
    /// as preconditioner.
    pub fn left(&mut self) -> f64 {
        let [squared] = self.contacts.sums_of(|at| [at.left()]);
        squared.sqrt()
    }

    /// u = −(W r + b); returns wᵗ W p.
    fn renew(&mut self) -> f64 {
        self.products += 1;
        self.contacts.push(|at| at.r);
        let [product] = self.contacts.pull_sums(|at, of_r| {
            at.u = -(of_r + at.b);
            [at.w().dot(&at.of_p)]
        });
        product
    }

    /// u − W d; returns wᵗ W p.
    fn correct(&mut self) -> f64 {
        self.products += 1;
        self.contacts.push(|at| at.d);
        let [product] = self.contacts.pull_sums(|at, of_d| {
            at.u -= of_d;
            [at.w().dot(&at.of_p)]
        });
        product
    }

    /// p = w + β z.
    fn turn(&mut self, beta: f64) {
        self.contacts.each(|at| at.turn(beta));
        [self.descent, self.squared] = self.contacts.sums_of(|at| [at.u.dot(&at.p), at.p.norm_squared()]);
    }

    /// r + α p, what the law makes of it, and u and W p there; returns wᵗ W p.
    fn step(&mut self, length: f64) -> f64 {
        let [] = self.contacts.pull_sums(|at, of_p| {
            at.of_p = of_p;
            at.u -= length * of_p;
            at.step(length);
            []
        });
        if self.iterations.is_multiple_of(WHOLE) { self.renew() } else { self.correct() }
    }

    /// A conjugate step and the next direction; `false` and no step if W hardly feels p, or p leads nowhere.
    fn conjugate_step(&mut self) -> bool {
        self.products += 1;
        self.contacts.push(|at| at.p);
        let curvature = self.contacts.curvature();
        let is_felt = curvature > ROUND_OFF * ROUND_OFF * self.greatest * self.squared;
        if !(is_felt && self.descent > 0.0) {
            return false;
        }
        // α = uᵗ p / pᵗ W p,  β = −wᵗ W p / pᵗ W p
        let product = self.step(self.descent / curvature);
        self.turn(-product / curvature);
        true
    }
}

impl<P: Products<D>, const D: usize> Iteration for ConeRun<P, D> {
    fn advance(&mut self) {
        self.iterations += 1;
        if !self.conjugate_step() {
            self.turn(0.0);
            if !self.conjugate_step() {
                // The projected gradient's.
                self.step(1.0 / self.greatest);
                self.turn(0.0);
            }
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        self.contacts.impulses(r);
    }

    fn work(&self) -> Work {
        // W p in each iteration, and for each direction begun anew; W d, or W r, after each step, and W r before the first.
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl<const D: usize> Solver<Rough<D>> for Cg
where
    Rough<D>: Frictional<D> + Bounded,
{
    fn start<'p>(
        &self,
        problem: &'p Packing<Rough<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Ok(Box::new(self.rough_run(problem, r0)?))
    }
}

impl Cg {
    /// A run on `problem` from the impulses `r0` (N·s), for those who look into it.
    ///
    /// # Errors
    /// Those of [`Product::new`].
    pub fn rough_run<const D: usize>(
        &self,
        problem: &Packing<Rough<D>>,
        r0: &[f64],
    ) -> Result<RoughRun<D>, SetupError>
    where
        Rough<D>: Frictional<D> + Bounded,
    {
        let (bound, w) = (Rough::scaled_delassus_bound(problem), problem.delassus_diagonal());
        let greatest = if self.is_scaled() { bound } else { bound * w.iter().copied().fold(0.0, f64::max) };
        Ok(self.rough_over(Layout::new(problem)?, problem, greatest, r0))
    }

    /// A run on the blocks of a layout of `problem`, with Λ.
    fn rough_over<const D: usize>(
        self,
        layout: Layout<Rough<D>>,
        problem: &Packing<Rough<D>>,
        greatest: f64,
        r0: &[f64],
    ) -> RoughRun<D>
    where
        Rough<D>: Frictional<D>,
    {
        let (b, w) = (problem.b(), problem.delassus_diagonal());
        let state = |contact: usize, unit: SVector<f64, D>| {
            State::new(
                SVector::<f64, D>::at(&b, contact).component_div(&unit),
                SVector::<f64, D>::at(r0, contact).component_mul(&unit),
                problem.contacts()[contact].friction * (unit[1] / unit[0]),
                SVector::<f64, D>::at(&w, contact)[1] / (unit[1] * unit[1]),
            )
        };
        ConeRun::new(Product::over(layout, problem, self.is_scaled(), state), greatest)
    }
}

impl<const D: usize> Distributed<Rough<D>> for Cg
where
    Rough<D>: Frictional<D> + Bounded,
{
    fn start_in<'p>(
        &self,
        share: &'p Share<Rough<D>>,
        r0: &[f64],
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused> {
        let layout = Layout::of_share(share, team);
        let greatest = self.greatest_of(share, &layout);
        Ok(Box::new(self.rough_over(layout, &share.problem, greatest, r0)))
    }
}
