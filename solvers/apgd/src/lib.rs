//! Accelerated projected gradient descent on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r.
//!
//! H. Mazhar, T. Heyn, D. Negrut, A. Tasora, Using Nesterov's method to accelerate multibody dynamics with friction and
//! contact, ACM Trans. Graph. 34 (2015) 32. Their cone is here r ≥ 0; their fall-back to the best iterate so far is left to
//! whoever measures. Cost of an iteration: one product with W for the gradient, and one dᵗ W d for each step length tried,
//! most often one, which counts as a product though it takes half of it.

pub use product::Preconditioner;

use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work, law};
use product::Product;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the accelerated gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Apgd {
    /// Nesterov's extrapolation; without it q(r) never increases.
    pub acceleration: bool,
    /// The metric D in which steps are taken: r ≥ 0 acts on each component alone, so any diagonal one keeps the method.
    pub preconditioner: Preconditioner,
}

/// The reference's method.
impl Default for Apgd {
    fn default() -> Self {
        Self { acceleration: true, preconditioner: Preconditioner::None }
    }
}

/// From one iteration to the next the step length may grow by 1/0.9, as in the reference.
const SHRINK: f64 = 0.9;

/// Doublings of L in one iteration, at most: from its least value it takes 52 to the greatest entry of the diagonal of W, and no more
/// from there than the number of contacts has digits.
const DOUBLINGS: u32 = 128;

/// State of a contact. D is 1: with the preconditioner, the unknowns are scaled by it.
struct Contact {
    r: f64,
    /// r⁺ of the step tried.
    r_plus: f64,
    /// y, the extrapolated impulse.
    y: f64,
    /// g = W y + b.
    g: f64,
}

struct Run<const D: usize> {
    /// The constant of a contact is b.
    product: Product<Contact, f64, Smooth<D>>,
    acceleration: bool,
    /// β of y = r⁺ + β (r⁺ − r), with r⁺ and r of the iteration before.
    beta: f64,
    /// L, the estimate of the greatest eigenvalue of D⁻¹ W, and the least that it may become.
    lipschitz: f64,
    least_lipschitz: f64,
    theta: f64,
    products: u64,
}

impl<const D: usize> Run<D> {
    /// y = r⁺ + β (r⁺ − r), then r = r⁺;  g = W y + b.
    fn extrapolate(&mut self) {
        let beta = self.beta;
        self.product.push(|at| {
            at.y = at.r_plus + beta * (at.r_plus - at.r);
            at.r = at.r_plus;
            at.y
        });
        self.product.pull(|at, b, of_y| at.g = of_y + b);
        self.products += 1;
    }

    /// r⁺ = max(0, y − D⁻¹ g / L), with L doubled until dᵗ W d ≤ L dᵗ D d, d = r⁺ − y, which round-off alone prevents: then q(r⁺) is below its bound at y.
    fn projected_step(&mut self) {
        for _ in 0..DOUBLINGS {
            let lipschitz = self.lipschitz;
            let length = self.product.push(|at| {
                at.r_plus = law::non_negative(at.y - at.g / lipschitz);
                at.r_plus - at.y
            });
            let curvature = self.product.curvature();
            self.products += 1;
            // Written so that a NaN ends it too.
            if !(curvature > lipschitz * length) {
                return;
            }
            self.lipschitz *= 2.0;
        }
    }
}

impl<const D: usize> Iteration for Run<D> {
    fn advance(&mut self) {
        self.extrapolate();
        self.projected_step();

        // θ⁺ = (−θ² + θ √(θ² + 4)) / 2,  β = θ (1 − θ) / (θ² + θ⁺);
        // begun anew where the step goes uphill: gᵗ (r⁺ − r) > 0.
        let theta_squared = self.theta * self.theta;
        let theta_plus = 0.5 * (self.theta * (theta_squared + 4.0).sqrt() - theta_squared);
        let uphill = self.acceleration && self.product.sum_of(|at| at.g * (at.r_plus - at.r)) > 0.0;
        (self.beta, self.theta) = if uphill || !self.acceleration {
            (0.0, 1.0)
        } else {
            (self.theta * (1.0 - self.theta) / (theta_squared + theta_plus), theta_plus)
        };
        self.lipschitz = f64::max(SHRINK * self.lipschitz, self.least_lipschitz);
    }

    fn impulses(&self, r: &mut [f64]) {
        self.product.impulses(|at| at.r_plus, r);
    }

    fn work(&self) -> Work {
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl<const D: usize> Solver<Smooth<D>> for Apgd {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let (b, scaled) = (problem.b(), self.preconditioner == Preconditioner::Diagonal);
        // An entry of the diagonal is no more than the greatest eigenvalue, and unlike the reference's ‖W 1‖/‖1‖ never 0.
        let lipschitz =
            if scaled { 1.0 } else { problem.delassus_diagonal().into_iter().fold(0.0, f64::max) };
        let contact = |contact: usize, unit: f64| {
            let r = r0[contact] * unit;
            (Contact { r, r_plus: r, y: r, g: 0.0 }, b[contact] / unit)
        };
        Ok(Box::new(Run {
            product: Product::new(problem, scaled, contact)?,
            acceleration: self.acceleration,
            beta: 0.0,
            lipschitz,
            least_lipschitz: f64::EPSILON * lipschitz,
            theta: 1.0,
            products: 0,
        }))
    }
}
